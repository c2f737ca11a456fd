// From a description to a Scene: everything checked, moved and scaled to the unit box, lights listed with their shares
// of the power, and the shapes handed to Embree. Then what a ray finds there, completed to a Hit more accurately than
// the ray's own float32 distance could.

#include "scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <set>
#include <tuple>

#include "core/error.h"
#include "scene/embree_scene.h"

namespace photonlab {

namespace {

struct Bounds {
    VectorD lower = VectorD(std::numeric_limits<double>::infinity());
    VectorD upper = VectorD(-std::numeric_limits<double>::infinity());

    void include(const VectorD& point) {
        for (int axis = 0; axis < 3; ++axis) {
            lower[axis] = std::min(lower[axis], point[axis]);
            upper[axis] = std::max(upper[axis], point[axis]);
        }
    }
    bool is_empty() const { return lower.x > upper.x; }
};

void include_shape(Bounds& bounds, const ShapeDescription& shape) {
    if (const auto* mesh = std::get_if<MeshDescription>(&shape.geometry)) {
        for (const VectorD& position : mesh->positions) bounds.include(position);
    } else if (const auto* sphere = std::get_if<SphereDescription>(&shape.geometry)) {
        bounds.include(sphere->centre - VectorD(sphere->radius));
        bounds.include(sphere->centre + VectorD(sphere->radius));
    } else {
        const auto& disk = std::get<DiskDescription>(shape.geometry);
        VectorD reach;
        for (int axis = 0; axis < 3; ++axis)
            reach[axis] = disk.radius * std::sqrt(std::max(0.0, 1.0 - disk.normal[axis] * disk.normal[axis]));
        bounds.include(disk.centre - reach);
        bounds.include(disk.centre + reach);
    }
}

// ---------------------------------------------------------------------------------------------------------------------
// What cannot be rendered is refused here, whether it came from a file or from a program.

/// Of what a program describes without a file there is no place.
[[noreturn]] void fail(const std::string& place, const std::string& message) {
    if (place.empty()) throw InputError(message);
    throw InputError(place, message);
}

void require_light(const ColorD& light, const std::string& place, std::string_view what) {
    if (!is_finite(light) || light.x < 0.0 || light.y < 0.0 || light.z < 0.0)
        throw InputError(place, fmt::format("{}: expected finite values of at least 0, got {} {} {}", what, light.x,
                                            light.y, light.z));
}

void require_mesh(const MeshDescription& mesh, const std::string& place) {
    for (std::size_t i = 0; i < mesh.positions.size(); ++i)
        if (!is_finite(mesh.positions[i])) throw InputError(place, fmt::format("vertex {} is not finite", i + 1));
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
        const auto& triangle = mesh.triangles[i];
        if (std::max({triangle.x, triangle.y, triangle.z}) >= mesh.positions.size())
            throw InputError(place, fmt::format("triangle {}: expected vertices below {}, got {} {} {}", i + 1,
                                                mesh.positions.size(), triangle.x, triangle.y, triangle.z));
    }
    if (!mesh.normals.empty() && mesh.normals.size() != mesh.positions.size())
        throw InputError(place, fmt::format("expected a normal for each of {} vertices, got {}", mesh.positions.size(),
                                            mesh.normals.size()));
    if (!mesh.texture_coordinates.empty() && mesh.texture_coordinates.size() != mesh.positions.size())
        throw InputError(place, fmt::format("expected texture coordinates for each of {} vertices, got {}",
                                            mesh.positions.size(), mesh.texture_coordinates.size()));
    for (std::size_t i = 0; i < mesh.normals.size(); ++i)
        if (!is_finite(mesh.normals[i])) throw InputError(place, fmt::format("normal {} is not finite", i + 1));
    for (std::size_t i = 0; i < mesh.texture_coordinates.size(); ++i)
        if (!std::isfinite(mesh.texture_coordinates[i].x) || !std::isfinite(mesh.texture_coordinates[i].y))
            throw InputError(place, fmt::format("texture coordinates {} are not finite", i + 1));
}

void require_valid(const SceneDescription& description) {
    for (const Material& material : description.materials) require_valid(material);
    for (const ShapeDescription& shape : description.shapes) {
        if (shape.material >= description.materials.size())
            throw InputError(shape.place,
                             fmt::format("material {} of {}", shape.material, description.materials.size()));
        if (shape.radiance) require_light(*shape.radiance, shape.place, "radiance");
        if (const auto* mesh = std::get_if<MeshDescription>(&shape.geometry)) require_mesh(*mesh, shape.place);
        const auto require_round = [&](const VectorD& centre, double radius) {
            if (!is_finite(centre) || !std::isfinite(radius) || !(radius > 0.0))
                throw InputError(shape.place,
                                 fmt::format("expected a finite centre and a radius above 0, got radius {}", radius));
        };
        if (const auto* sphere = std::get_if<SphereDescription>(&shape.geometry))
            require_round(sphere->centre, sphere->radius);
        if (const auto* disk = std::get_if<DiskDescription>(&shape.geometry)) {
            require_round(disk->centre, disk->radius);
            if (!is_finite(disk->normal) || disk->normal.length2() == 0.0)
                throw InputError(shape.place, "expected a disk's normal of unit length");
        }
    }
    for (const PointLightDescription& light : description.point_lights) {
        require_light(light.intensity, light.place, "intensity");
        if (!is_finite(light.position)) throw InputError(light.place, "position is not finite");
    }
}

// ---------------------------------------------------------------------------------------------------------------------

/// From scene units to the unit box, in double.
struct ToUnitBox {
    VectorD centre;
    double unit_length;

    VectorD exact(const VectorD& point) const { return (point - centre) / unit_length; }
    Vector operator()(const VectorD& point) const { return Vector(exact(point)); }
    float length(double scene_units) const { return static_cast<float>(scene_units / unit_length); }
};

/// How far apart neighbouring doubles are at the farthest coordinate of the box, as a share of its size: where things
/// are in the scene cannot be said any better.
double coarseness_of(const Bounds& box, double size) {
    double farthest = 0.0;
    for (int axis = 0; axis < 3; ++axis)
        farthest = std::max({farthest, std::abs(box.lower[axis]), std::abs(box.upper[axis])});
    return std::numeric_limits<double>::epsilon() * farthest / size;
}

constexpr double noted_coarseness = 1e-6;  // tens of times that of the floats in the unit box
constexpr double worst_coarseness = 1e-4;  // light a thirtieth of the scene above a floor is then off by 0.1%

/// The box that becomes the unit box. A point light's intensity is divided by the square of its size, which must
/// therefore be a double too.
ToUnitBox make_unit_box(const Bounds& box, const std::string& place) {
    if (box.is_empty()) return {VectorD(0.0), 1.0};
    const VectorD extent = box.upper - box.lower;
    const double largest = std::max({extent.x, extent.y, extent.z});
    const VectorD centre = (box.lower + box.upper) * 0.5;
    const double unit_length = largest > 0.0 ? largest : 1.0;
    if (!is_finite(centre) || !std::isnormal(unit_length * unit_length))
        throw InputError(
            place, fmt::format("the scene is {} scene units large around ({} {} {}): beyond double precision", largest,
                               centre.x, centre.y, centre.z));
    if (coarseness_of(box, unit_length) > worst_coarseness)
        throw InputError(
            place,
            fmt::format("the scene is {:g} scene units large around ({:g} {:g} {:g}), where neighbouring doubles "
                        "are {:.2g} of its size apart; expected at most {:g}: move it closer to the origin",
                        largest, centre.x, centre.y, centre.z, coarseness_of(box, unit_length), worst_coarseness));
    return {centre, unit_length};
}

/// Where the shape stands that reaches farthest from the origin, or the first light where there is no shape.
std::string place_of_farthest(const SceneDescription& description) {
    std::string place = description.point_lights.empty() ? description.name : description.point_lights.front().place;
    double farthest = -1.0;
    for (const ShapeDescription& shape : description.shapes) {
        Bounds bounds;
        include_shape(bounds, shape);
        const double reach = std::max(bounds.lower.length(), bounds.upper.length());
        if (!(reach > farthest)) continue;
        farthest = reach;
        place = shape.place;
    }
    return place;
}

/// Corners of a triangle, unit box, before they are rounded to float: rounding turns the plane of a sliver.
std::array<VectorD, 3> corners(const MeshDescription& mesh, std::size_t triangle, const ToUnitBox& to_unit_box) {
    const auto& vertices = mesh.triangles[triangle];
    return {to_unit_box.exact(mesh.positions[vertices.x]), to_unit_box.exact(mesh.positions[vertices.y]),
            to_unit_box.exact(mesh.positions[vertices.z])};
}

/// Nine numbers that tell two triangles apart, whichever corner they begin with.
std::array<double, 9> identity_of(std::array<VectorD, 3> triangle) {
    const auto is_before = [](const VectorD& a, const VectorD& b) {
        return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
    };
    std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end(), is_before), triangle.end());
    std::array<double, 9> numbers{};
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = triangle[i / 3][static_cast<int>(i % 3)];
    return numbers;
}

Shape make_shape(const ShapeDescription& description, const ToUnitBox& to_unit_box, bool has_texture) {
    Shape shape;
    const auto axes = [&](const TextureAxes& all) { return has_texture ? std::optional(all) : std::nullopt; };
    shape.material = static_cast<std::uint32_t>(description.material);
    if (const auto* source = std::get_if<MeshDescription>(&description.geometry)) {
        TriangleMesh mesh;
        mesh.triangles = source->triangles;
        for (const VectorD& position : source->positions) mesh.positions.push_back(to_unit_box(position));
        for (const VectorD& normal : source->normals) mesh.normals.push_back(Vector(normal));
        for (const Imath::V2d& uv : source->texture_coordinates)
            mesh.texture_coordinates.emplace_back(static_cast<float>(uv.x), static_cast<float>(uv.y));
        shape.area = 0.0;
        std::set<std::array<double, 9>> shining;  // a triangle that is there twice shines once
        for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
            const std::array<VectorD, 3> triangle = corners(*source, i, to_unit_box);
            const VectorD normal = (triangle[1] - triangle[0]).cross(triangle[2] - triangle[0]);
            mesh.geometric_normals.emplace_back(normal.normalized());
            if (!description.radiance || shining.insert(identity_of(triangle)).second)
                shape.area += 0.5 * normal.length();
            if (description.radiance) shape.triangle_cdf.push_back(shape.area);
        }
        if (shape.area > 0.0)
            for (double& share : shape.triangle_cdf) share /= shape.area;
        shape.geometry = std::move(mesh);
    } else if (const auto* sphere = std::get_if<SphereDescription>(&description.geometry)) {
        const float radius = to_unit_box.length(sphere->radius);
        shape.geometry = Sphere{to_unit_box(sphere->centre), radius, sphere->flip_normals ? -1.0f : 1.0f,
                                axes(sphere->texture_axes)};
        shape.area = 4.0 * pi * radius * radius;
    } else {
        const auto& disk = std::get<DiskDescription>(description.geometry);
        const float radius = to_unit_box.length(disk.radius);
        shape.geometry =
            Disk{make_frame(Vector(disk.normal)), to_unit_box(disk.centre), radius, axes(disk.texture_axes)};
        shape.area = pi * radius * radius;
    }
    return shape;
}

Camera make_camera(const CameraDescription& description, std::optional<Resolution> resolution,
                   const ToUnitBox& to_unit_box) {
    const int width = resolution ? resolution->width : description.width;
    const int height = resolution ? resolution->height : description.height;
    if (width < 1 || height < 1)
        throw InputError(fmt::format("resolution: expected at least 1 x 1, got {} x {}", width, height));
    if (!(description.fov_x > 0.0 && description.fov_x < 180.0))
        fail(description.place,
             fmt::format("camera: expected a field of view in (0, 180) degrees, got {}", description.fov_x));
    const Matrix& m = description.to_world;
    const auto row = [&](int i) { return VectorD(m[i][0], m[i][1], m[i][2]); };
    const VectorD left = row(0).normalized();
    const VectorD up = row(1).normalized();
    const VectorD forward = row(2).normalized();
    const VectorD position = row(3);
    // Written so that NaN fails as well.
    if (!is_finite(position) || !(std::abs(left.cross(up).dot(forward)) > 0.0))
        fail(description.place, "camera: to_world: expected an invertible transform with finite values");
    if (!is_squarable(to_unit_box(position)))  // Embree takes no ray from there
        fail(description.place,
             fmt::format("camera: position {} {} {} is too far from the scene, which is {} scene units large",
                         position.x, position.y, position.z, to_unit_box.unit_length));
    const double image_width = 2.0 * std::tan(description.fov_x * pi / 360.0);  // at distance 1
    const double image_height = image_width * height / width;                   // square pixels
    return {.position = to_unit_box(position),
            .forward = forward,
            .right = -left * image_width,
            .down = -up * image_height,
            .width = width,
            .height = height,
            .pixel_angle = image_width / width};
}

/// Lists the lights that have power, and with which probability each is chosen. Ratios of power, not power, so that
/// light times a constant changes no choice.
void add_emitters(Scene& scene, const SceneDescription& description, const ToUnitBox& to_unit_box) {
    std::vector<std::string> places;
    for (std::size_t i = 0; i < description.shapes.size(); ++i) {
        const std::optional<ColorD>& radiance = description.shapes[i].radiance;
        Shape& shape = scene.shapes[i];
        if (!radiance) continue;
        const ColorD power = *radiance * (pi * shape.area);
        if (!(mean_channel(power) > 0.0)) continue;
        shape.emitter = static_cast<std::uint32_t>(scene.emitters.size());
        scene.emitters.push_back({AreaLight{*radiance, static_cast<std::uint32_t>(i)}, power, 0.0, 0.0});
        places.push_back(description.shapes[i].place);
    }
    const double unit_area = to_unit_box.unit_length * to_unit_box.unit_length;
    for (const PointLightDescription& light : description.point_lights) {
        const ColorD intensity = light.intensity / unit_area;
        const Vector position = to_unit_box(light.position);
        if (!is_squarable(position))
            throw InputError(
                light.place,
                fmt::format("position {} {} {} is too far from the scene, which is {} scene units large",
                            light.position.x, light.position.y, light.position.z, to_unit_box.unit_length));
        const ColorD power = intensity * (4.0 * pi);
        if (!(mean_channel(power) > 0.0)) continue;
        scene.emitters.push_back({PointLight{intensity, position}, power, 0.0, 0.0});
        places.push_back(light.place);
    }
    for (const Emitter& emitter : scene.emitters) scene.total_power += mean_channel(emitter.power);
    if (!std::isfinite(scene.total_power)) {
        const auto brightest = std::max_element(
            scene.emitters.begin(), scene.emitters.end(),
            [](const Emitter& a, const Emitter& b) { return mean_channel(a.power) < mean_channel(b.power); });
        throw InputError(places[static_cast<std::size_t>(brightest - scene.emitters.begin())],
                         "the emitted power overflows double precision; scale the lights down");
    }
    double running = 0.0;
    for (Emitter& emitter : scene.emitters) {
        emitter.choice_probability = mean_channel(emitter.power) / scene.total_power;
        running += emitter.choice_probability;
        emitter.choice_cdf = running;
        emitter.photon_power = Color(emitter.power / (emitter.choice_probability * scene.total_power));
    }
    if (!scene.emitters.empty()) scene.emitters.back().choice_cdf = 1.0;
}

}  // namespace

bool has_specular_surfaces(const Scene& scene) {
    return std::any_of(scene.shapes.begin(), scene.shapes.end(),
                       [&](const Shape& shape) { return is_specular(scene.materials[shape.material].bsdf); });
}

Vector Camera::direction(double x, double y) const {
    return Vector((forward + right * (x / width - 0.5) + down * (y / height - 0.5)).normalized());
}

Scene build_scene(const SceneDescription& description, std::optional<Resolution> resolution) {
    require_valid(description);
    Bounds bounds;
    for (const ShapeDescription& shape : description.shapes) include_shape(bounds, shape);
    Bounds box = bounds;
    if (box.is_empty())
        for (const PointLightDescription& light : description.point_lights) box.include(light.position);

    const ToUnitBox to_unit_box = make_unit_box(box, place_of_farthest(description));

    Scene scene;
    scene.name = description.name;
    scene.hash = description.hash;
    scene.notes = description.notes;
    if (const double coarseness = bounds.is_empty() ? 0.0 : coarseness_of(bounds, to_unit_box.unit_length);
        coarseness > noted_coarseness)
        scene.notes.push_back(
            fmt::format("so far from the origin coordinates are rounded to {:.2g} of the scene's size: move it closer",
                        coarseness));
    scene.unit_length = to_unit_box.unit_length;
    scene.centre = to_unit_box.centre;
    scene.materials = description.materials;
    scene.max_depth = description.max_depth;
    if (!bounds.is_empty()) scene.bounding_radius = to_unit_box.length(0.5 * (bounds.upper - bounds.lower).length());
    for (const ShapeDescription& shape : description.shapes)
        scene.shapes.push_back(make_shape(shape, to_unit_box, !scene.materials[shape.material].textures.empty()));
    add_emitters(scene, description, to_unit_box);
    scene.camera = make_camera(description.camera, resolution, to_unit_box);
    scene.embree = build_embree_scene(scene.shapes);
    return scene;
}

// ---------------------------------------------------------------------------------------------------------------------

namespace {

/// Completes a hit on a triangle. The position comes from the vertices, which is more accurate than origin + t
/// direction.
void complete(Hit& hit, const TriangleMesh& mesh, const Ray& ray, float u, float v) {
    const auto& triangle = mesh.triangles[hit.primitive];
    const float w = 1.0f - u - v;
    const Vector& a = mesh.positions[triangle.x];
    const Vector& b = mesh.positions[triangle.y];
    const Vector& c = mesh.positions[triangle.z];
    hit.position = a * w + b * u + c * v;
    hit.geometric_normal = mesh.geometric_normals[hit.primitive];
    // A triangle without area has no normal of its own; facing the ray is as good as any.
    if (hit.geometric_normal == Vector(0.0f)) hit.geometric_normal = -ray.direction;
    hit.shading_normal = hit.geometric_normal;
    if (!mesh.normals.empty()) {
        const VectorD interpolated = VectorD(mesh.normals[triangle.x]) * w + VectorD(mesh.normals[triangle.y]) * u +
                                     VectorD(mesh.normals[triangle.z]) * v;
        if (interpolated.length2() > 0.0) {
            hit.shading_normal = Vector(interpolated.normalized());
            if (hit.shading_normal.dot(hit.geometric_normal) < 0.0f) hit.shading_normal = -hit.shading_normal;
        }
    }
    if (!mesh.texture_coordinates.empty())
        hit.texture_coordinate = mesh.texture_coordinates[triangle.x] * w + mesh.texture_coordinates[triangle.y] * u +
                                 mesh.texture_coordinates[triangle.z] * v;
    else
        hit.texture_coordinate = Imath::V2f(u, v);
}

/// The angle from (1, 0) to (x, y), as a share of the circle, in [0, 1].
double turn_to(double x, double y) {
    const double angle = std::atan2(y, x) / (2.0 * pi);
    return angle < 0.0 ? angle + 1.0 : angle;
}

void complete(Hit& hit, const Sphere& sphere, const Ray& ray, float, float) {
    const VectorD centre(sphere.centre);
    const VectorD outward = (VectorD(ray.origin) + VectorD(ray.direction) * hit.distance - centre).normalized();
    hit.position = Vector(centre + outward * sphere.radius);
    hit.geometric_normal = Vector(outward) * sphere.orientation;
    hit.shading_normal = hit.geometric_normal;
    if (!sphere.texture_axes) return;
    const auto& [x, y, z] = *sphere.texture_axes;
    const double from_pole = std::acos(std::clamp(outward.dot(z), -1.0, 1.0)) / pi;
    hit.texture_coordinate = Imath::V2f(Imath::V2d(turn_to(outward.dot(x), outward.dot(y)), from_pole));
}

void complete(Hit& hit, const Disk& disk, const Ray& ray, float, float) {
    const VectorD normal(disk.frame.normal);
    const VectorD centre(disk.centre);
    const VectorD position = VectorD(ray.origin) + VectorD(ray.direction) * hit.distance;
    hit.position = Vector(position - normal * (position - centre).dot(normal));
    hit.geometric_normal = disk.frame.normal;
    hit.shading_normal = disk.frame.normal;
    if (!disk.texture_axes) return;
    const double x = (position - centre).dot((*disk.texture_axes)[0]) / disk.radius;
    const double y = (position - centre).dot((*disk.texture_axes)[1]) / disk.radius;
    hit.texture_coordinate = Imath::V2f(Imath::V2d(std::hypot(x, y), turn_to(x, y)));
}

}  // namespace

std::optional<Hit> intersect(const Scene& scene, const Ray& ray) {
    RTCRayHit query{};
    query.ray.org_x = ray.origin.x;
    query.ray.org_y = ray.origin.y;
    query.ray.org_z = ray.origin.z;
    query.ray.dir_x = ray.direction.x;
    query.ray.dir_y = ray.direction.y;
    query.ray.dir_z = ray.direction.z;
    query.ray.tnear = 0.0f;
    query.ray.tfar = infinity;
    query.ray.mask = ~0u;
    query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    trace_closest(scene.embree->scene, query);
    std::optional<Hit> found;
    if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return found;

    Hit& hit = found.emplace();
    hit.distance = query.ray.tfar;
    hit.shape = query.hit.geomID;
    hit.primitive = query.hit.primID;
    std::visit([&](const auto& geometry) { complete(hit, geometry, ray, query.hit.u, query.hit.v); },
               scene.shapes[hit.shape].geometry);
    return found;
}

// Both ends of a segment were moved off their surfaces by far more than this; it only keeps the rounding of its
// direction from reaching past the far end.
constexpr float segment_end = 1.0f - 4.0f * std::numeric_limits<float>::epsilon();

bool is_occluded(const Scene& scene, const Segment& segment) {
    const Vector direction = segment.to - segment.from;
    RTCRay ray{};
    ray.org_x = segment.from.x;
    ray.org_y = segment.from.y;
    ray.org_z = segment.from.z;
    ray.dir_x = direction.x;
    ray.dir_y = direction.y;
    ray.dir_z = direction.z;
    ray.tnear = 0.0f;
    ray.tfar = segment_end;
    ray.mask = ~0u;
    trace_any(scene.embree->scene, ray);
    return ray.tfar < 0.0f;
}

unsigned occluded_of_eight(const Scene& scene, std::span<const Segment> segments) {
    assert(segments.size() <= 8);
    RTCRay8 rays{};
    alignas(32) int valid[8] = {};
    for (std::size_t i = 0; i < segments.size(); ++i) {
        const Vector direction = segments[i].to - segments[i].from;
        rays.org_x[i] = segments[i].from.x;
        rays.org_y[i] = segments[i].from.y;
        rays.org_z[i] = segments[i].from.z;
        rays.dir_x[i] = direction.x;
        rays.dir_y[i] = direction.y;
        rays.dir_z[i] = direction.z;
        rays.tfar[i] = segment_end;
        rays.mask[i] = ~0u;
        valid[i] = -1;
    }
    trace_any_of_eight(scene.embree->scene, valid, rays);
    unsigned occluded = 0;
    for (std::size_t i = 0; i < segments.size(); ++i) occluded |= static_cast<unsigned>(rays.tfar[i] < 0.0f) << i;
    return occluded;
}

}  // namespace photonlab
