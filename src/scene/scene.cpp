// From a description to a Scene: everything checked, moved and scaled to the unit box, lights listed with their shares
// of the power, and the shapes handed to Embree. Then what a ray finds there, completed to a Hit more accurately than
// the ray's own float32 distance could.

#include "scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <numeric>
#include <set>
#include <tuple>

#include "core/error.h"
#include "scene/embree_scene.h"

namespace photonlab {

namespace {

// ---------------------------------------------------------------------------------------------------------------------
// What cannot be rendered is refused here, whether it came from a file or from a program.

/// Of what a program describes without a file there is no place.
[[noreturn]] void fail(const std::string& place, const std::string& message) {
    if (place.empty()) throw InputError(message);
    throw InputError(place, message);
}

void require_valid(const SceneDescription& description) {
    for (const Material& material : description.materials) require_valid(material);
    for (const ShapeDescription& shape : description.shapes) {
        if (shape.material >= description.materials.size())
            throw InputError(shape.place,
                             fmt::format("material {} of {}", shape.material, description.materials.size()));
        if (shape.radiance) AreaLight::check(*shape.radiance, shape.place);
        if (shape.radiance_texture) require_factor_on_light(*shape.radiance_texture, shape.place, "radiance");
        require_valid(shape.geometry, shape.place);
    }
    for (const LightDescription& light : description.lights) require_valid(light);
    require_one_environment(description.lights);
}

void include(Bounds& bounds, const Bounds& other) {
    if (other.is_empty()) return;
    bounds.include(other.lower);
    bounds.include(other.upper);
}

// ---------------------------------------------------------------------------------------------------------------------

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

/// Where the shape stands that reaches farthest from the origin, or the first light where there is no shape.
std::string place_of_farthest(const SceneDescription& description) {
    std::string place = description.lights.empty() ? description.name : place_of(description.lights.front());
    double farthest = -1.0;
    for (const ShapeDescription& shape : description.shapes) {
        const Bounds bounds = bounds_of(shape.geometry);
        const double reach = std::max(bounds.lower.length(), bounds.upper.length());
        if (!(reach > farthest)) continue;
        farthest = reach;
        place = shape.place;
    }
    return place;
}

/// The box that becomes the unit box. A point light's intensity is divided by the square of its size, which must
/// therefore be a double too.
ToUnitBox make_unit_box(const Bounds& box, const SceneDescription& description) {
    if (box.is_empty()) return {VectorD(0.0), 1.0};
    const VectorD extent = box.upper - box.lower;
    const double largest = std::max({extent.x, extent.y, extent.z});
    const VectorD centre = (box.lower + box.upper) * 0.5;
    const double unit_length = largest > 0.0 ? largest : 1.0;
    if (!is_finite(centre) || !std::isnormal(unit_length * unit_length))
        throw InputError(place_of_farthest(description),
                         fmt::format("the scene is {} scene units large around ({} {} {}): beyond double precision",
                                     largest, centre.x, centre.y, centre.z));
    if (coarseness_of(box, unit_length) > worst_coarseness)
        throw InputError(
            place_of_farthest(description),
            fmt::format("the scene is {:g} scene units large around ({:g} {:g} {:g}), where neighbouring doubles "
                        "are {:.2g} of its size apart; expected at most {:g}: move it closer to the origin",
                        largest, centre.x, centre.y, centre.z, coarseness_of(box, unit_length), worst_coarseness));
    return {centre, unit_length};
}

Camera make_camera(const CameraDescription& description, std::optional<Resolution> resolution,
                   const ToUnitBox& to_unit_box) {
    const FilmCrop film = description.crop.value_or(FilmCrop{0, 0, description.width, description.height});
    const int width = resolution ? resolution->width : film.width;
    const int height = resolution ? resolution->height : film.height;
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
             fmt::format("camera: expected a position nearer to the scene, which is {} scene units large, got {} {} {}",
                         to_unit_box.unit_length, position.x, position.y, position.z));
    const auto require_length = [&](double length, double least, const char* name) {
        if (!(length >= least && to_unit_box.length(length) <= largest_length))
            fail(description.place, fmt::format("camera: {}: expected a length above 0, got {}", name, length));
    };
    if (description.aperture_radius != 0.0) {
        require_length(description.aperture_radius, 0.0, "aperture_radius");
        require_length(description.focus_distance, std::numeric_limits<double>::min(), "focus_distance");
    }
    const double film_width = 2.0 * std::tan(description.fov_x * pi / 360.0);  // at distance 1
    const double film_pixel = film_width / description.width;
    const double image_width = film_width * (static_cast<double>(film.width) / description.width);
    const double image_height = image_width * height / width;  // square pixels
    VectorD middle = forward;
    if (description.crop)
        middle -= left * (film_pixel * (film.x + 0.5 * film.width - 0.5 * description.width)) +
                  up * (film_pixel * (film.y + 0.5 * film.height - 0.5 * description.height));
    return {.position = to_unit_box(position),
            .forward = middle,
            .right = -left * image_width,
            .down = -up * image_height,
            .width = width,
            .height = height,
            .pixel_angle = image_width / width,
            .aperture_radius = description.aperture_radius / to_unit_box.unit_length,
            .focus_distance = description.focus_distance / to_unit_box.unit_length};
}

constexpr const char* power_overflows = "the emitted power overflows double precision; scale the lights down";

/// The light of a shape that has one; `index` is that of the shape.
Light area_light(const ShapeDescription& described, std::size_t index, const Shape& shape) {
    const auto here = static_cast<std::uint32_t>(index);
    if (!described.radiance_texture) return AreaLight{*described.radiance, here};
    return TexturedAreaLight{.texture = described.radiance_texture,
                             .factor = *described.radiance,
                             .shape = here,
                             .parts = std::make_shared<const BrightParts>(shape, *described.radiance_texture)};
}

/// Lists the lights that have power, and with which probability each is chosen. Ratios of power, not power, so that
/// light times a constant changes no choice.
void add_emitters(Scene& scene, const SceneDescription& description, const SceneExtent& extent) {
    std::vector<std::string> places;
    std::vector<double> weights;  // power as often as it is chosen for it
    const auto add = [&](const Light& light, const std::string& place, double sampling_weight) {
        const ColorD power = std::visit([&](const auto& kind) { return kind.power(scene.shapes); }, light);
        if (!std::isfinite(mean_channel(power))) fail(place, power_overflows);
        if (!(mean_channel(power) > 0.0)) return false;
        scene.emitters.push_back({light, power, 0.0, 0.0});
        places.push_back(place);
        weights.push_back(mean_channel(power) * sampling_weight);
        return true;
    };
    for (std::size_t i = 0; i < description.shapes.size(); ++i) {
        const ShapeDescription& shape = description.shapes[i];
        const auto next = static_cast<std::uint32_t>(scene.emitters.size());
        if (shape.radiance && add(area_light(shape, i, scene.shapes[i]), shape.place, shape.sampling_weight))
            scene.shapes[i].emitter = next;
    }
    for (const LightDescription& light : description.lights) {
        const Light placed = place_light(light, extent);
        const auto next = static_cast<std::uint32_t>(scene.emitters.size());
        if (add(placed, place_of(light), sampling_weight_of(light)) && is_environment(placed)) scene.environment = next;
    }
    for (const Emitter& emitter : scene.emitters) scene.total_power += mean_channel(emitter.power);
    const double total_weight = std::accumulate(weights.begin(), weights.end(), 0.0);
    if (!std::isfinite(scene.total_power) || !std::isfinite(total_weight)) {
        const auto brightest = std::max_element(
            scene.emitters.begin(), scene.emitters.end(),
            [](const Emitter& a, const Emitter& b) { return mean_channel(a.power) < mean_channel(b.power); });
        throw InputError(places[static_cast<std::size_t>(brightest - scene.emitters.begin())], power_overflows);
    }
    double running = 0.0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
        Emitter& emitter = scene.emitters[i];
        emitter.choice_probability = weights[i] / total_weight;
        running += emitter.choice_probability;
        emitter.choice_cdf = running;
        emitter.photon_power = Color(emitter.power / (emitter.choice_probability * scene.total_power));
    }
    if (!scene.emitters.empty()) scene.emitters.back().choice_cdf = 1.0;
}

double size_of(const Bounds& bounds) {
    const VectorD extent = bounds.upper - bounds.lower;
    return bounds.is_empty() ? 0.0 : std::max({extent.x, extent.y, extent.z});
}

/// Whether the camera sees them large: under an angle of at least a fortieth of its field of view, as a usual lens sees
/// them from up to fifty of their sizes away.
bool is_looked_at(const Bounds& bounds, const CameraDescription& camera) {
    constexpr double least_share = 1.0 / 40.0;
    const double size = size_of(bounds);
    const VectorD eye(camera.to_world[3][0], camera.to_world[3][1], camera.to_world[3][2]);
    const double distance = ((bounds.lower + bounds.upper) * 0.5 - eye).length();
    return size > 0.0 && 2.0 * std::atan2(0.5 * size, distance) > least_share * camera.fov_x * pi / 180.0;
}

/// The surfaces that the unit box is made for: all, or all but outsized ones such as a ground that goes on to the
/// horizon, which are that many times as large as all that are smaller together, where the camera looks at the smaller
/// ones. Light from infinity would hardly hit what is a hundredth of everything, which matters for all but lights.
/// Floats would not resolve the picture of what is a ten thousandth. Of several such gaps the innermost counts.
Bounds bounds_without_outsized(const SceneDescription& description) {
    constexpr double outsized_for_light = 1e2;
    constexpr double outsized_for_floats = 1e4;
    constexpr double farthest = 1e9;  // sizes that floats around the smaller ones still tell apart from infinity
    const bool has_light_from_infinity =
        std::any_of(description.lights.begin(), description.lights.end(),
                    [](const LightDescription& light) { return bounds_of(light).is_empty(); });
    struct Sized {
        Bounds bounds;
        bool emits;
    };
    std::vector<Sized> shapes;
    Bounds all;
    for (const ShapeDescription& shape : description.shapes) {
        shapes.push_back({bounds_of(shape.geometry), shape.radiance.has_value()});
        include(all, shapes.back().bounds);
    }
    std::stable_sort(shapes.begin(), shapes.end(),
                     [](const Sized& a, const Sized& b) { return size_of(a.bounds) < size_of(b.bounds); });
    Bounds smaller, smaller_without_lights;
    for (const Sized& shape : shapes) {
        const auto is_outsized_for = [&](const Bounds& inside, double times) {
            return size_of(shape.bounds) > times * size_of(inside) && size_of(all) <= farthest * size_of(inside) &&
                   is_looked_at(inside, description.camera);
        };
        if (has_light_from_infinity && is_outsized_for(smaller_without_lights, outsized_for_light))
            return smaller_without_lights;
        if (is_outsized_for(smaller, outsized_for_floats)) return smaller;
        include(smaller, shape.bounds);
        if (!shape.emits) include(smaller_without_lights, shape.bounds);
    }
    return all;
}

/// Balls around both, in the unit box.
SceneExtent extent_of(const ToUnitBox& to_unit_box, const Bounds& box, const Bounds& all) {
    SceneExtent extent{.to_unit_box = to_unit_box};
    if (box.is_empty()) return extent;
    const auto ball = [&](const Bounds& bounds, VectorD& centre, double& radius) {
        centre = to_unit_box.exact((bounds.lower + bounds.upper) * 0.5);
        radius = 0.5 * (bounds.upper - bounds.lower).length() / to_unit_box.unit_length;
    };
    ball(box, extent.centre, extent.radius);
    ball(all, extent.outer_centre, extent.outer_radius);
    return extent;
}

}  // namespace

bool has_specular_surfaces(const Scene& scene) {
    return std::any_of(scene.shapes.begin(), scene.shapes.end(),
                       [&](const Shape& shape) { return may_be_specular(scene.materials[shape.material]); });
}

namespace {

/// Heights are lengths, so they are taken to the unit box as positions are.
void scale_heights(Material& material, double unit_length) {
    for (auto* normals : {&material.normals, &material.normals_behind})
        if (*normals) (*normals)->scale /= unit_length;
}

}  // namespace

namespace {

/// The opposite of a normal that is mirrored in the surface: what leans to the left from the front still does from
/// behind.
Vector mirrored_opposite(const Vector& turned, const Vector& normal) {
    return normal * (2.0f * turned.dot(normal)) - turned;
}

}  // namespace

/// Of heights h: the surface is moved by h along its normal n, whose own change is left out, so its derivatives become
/// p_u + n (h_u - n.p_u). [Blinn 1978, "Simulation of Wrinkled Surfaces"]
Vector turned_normal(const Shape& shape, const Hit& hit, const NormalTexture& normals) {
    auto [by_u, by_v] = tangents_at(shape, hit);
    const VectorD normal(hit.shading_normal);
    VectorD turned;
    if (normals.is_height) {
        const TextureGradient gradient = gradient_at(*normals.texture, hit.texture_coordinate);
        by_u += normal * (normals.scale * luminance(gradient.by_u) - normal.dot(by_u));
        by_v += normal * (normals.scale * luminance(gradient.by_v) - normal.dot(by_v));
        turned = by_u.cross(by_v);
    } else {
        const ColorD color(color_at(*normals.texture, hit.texture_coordinate));
        const VectorD along = (by_u - normal * normal.dot(by_u)).normalized();
        turned = along * (2.0 * color.x - 1.0) + normal.cross(along) * (2.0 * color.y - 1.0) +
                 normal * (2.0 * color.z - 1.0);
    }
    if (!is_finite(turned) || turned.length2() == 0.0) return hit.shading_normal;
    Vector unit(turned.normalized());
    if (unit.dot(hit.geometric_normal) < 0.0f) unit = -unit;
    return normals.is_mirrored ? mirrored_opposite(unit, hit.shading_normal) : unit;
}

Frame frame_along_u(const Scene& scene, const Hit& hit, const Vector& normal, bool from_back) {
    const Shape& shape = scene.shapes[hit.shape];
    const Material& material = scene.materials[shape.material];
    const std::optional<NormalTexture>& normals = from_back ? material.normals_behind : material.normals;
    const auto* mesh = std::get_if<TriangleMesh>(&shape.geometry);
    // Without texture coordinates Mitsuba 3 has any direction, made from the normal as make_frame() does.
    const VectorD by_u = mesh && mesh->texture_coordinates.empty() ? VectorD(make_frame(hit.geometric_normal).tangent)
                                                                   : tangents_at(shape, hit).by_u;
    const VectorD unturned(hit.shading_normal);
    const VectorD turned(normal);
    const VectorD along = by_u - unturned * unturned.dot(by_u);
    // A bumped surface's p_u is that of the surface, moved along its normal: it lies above `along`.
    const VectorD tangent = normals && normals->is_height
                                ? along - unturned * (along.dot(turned) / unturned.dot(turned))
                                : along - turned * turned.dot(along);
    if (!is_finite(tangent) || tangent.length2() == 0.0) return make_frame(normal);
    return frame_with_tangent(normal, Vector(tangent.normalized()));
}

std::optional<Surface> passed_straight(const Scene& scene, const Hit& hit, const Vector& outgoing) {
    const std::uint32_t material = scene.shapes[hit.shape].material;
    const float geometric = hit.geometric_normal.dot(outgoing);
    if (geometric == 0.0f || !is_transmissive(scene.materials[material].bsdf)) return std::nullopt;
    const bool from_back = geometric < 0.0f;
    const Color through = straight_through(bsdf_at(scene.materials[material], hit.texture_coordinate, from_back));
    if (is_black(through)) return std::nullopt;
    const Vector normal = from_back ? -hit.geometric_normal : hit.geometric_normal;
    // A pane that reflects nothing.
    return Surface{.bsdf = ThinDielectric{.index_outside = 1.0f, .index_inside = 1.0f, .transmittance = through},
                   .material = material,
                   .texture_coordinate = hit.texture_coordinate,
                   .frame = make_frame(normal),
                   .geometric_normal = normal,
                   .position = hit.position,
                   .from_back = from_back};
}

std::optional<Surface> orient_to_gather(const Scene& scene, const Hit& hit, const Vector& outgoing) {
    const Material& material = scene.materials[scene.shapes[hit.shape].material];
    return orient_by(scene, hit, outgoing, gather_normal(material, hit.shading_normal, hit.geometric_normal));
}

Ray Camera::ray(double x, double y, const Imath::V2f& on_lens) const {
    const VectorD through = forward + right * (x / width - 0.5) + down * (y / height - 0.5);
    if (!has_lens()) return {position, Vector(through.normalized())};
    const double radius = aperture_radius * std::sqrt(static_cast<double>(on_lens.x));
    const double angle = 2.0 * pi * static_cast<double>(on_lens.y);
    const VectorD offset =
        right.normalized() * (radius * std::cos(angle)) + down.normalized() * (radius * std::sin(angle));
    return {Vector(VectorD(position) + offset), Vector((through * focus_distance - offset).normalized())};
}

Scene build_scene(SceneDescription description, std::optional<Resolution> resolution) {
    require_valid(description);
    Bounds all;
    for (const ShapeDescription& shape : description.shapes) include(all, bounds_of(shape.geometry));
    const Bounds bounds = bounds_without_outsized(description);
    Bounds box = bounds;
    if (box.is_empty())
        for (const LightDescription& light : description.lights) include(box, bounds_of(light));

    const ToUnitBox to_unit_box = make_unit_box(box, description);

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
    for (Material& material : scene.materials) scale_heights(material, to_unit_box.unit_length);
    scene.max_depth = description.max_depth;
    if (size_of(all) > size_of(bounds))
        scene.notes.push_back(fmt::format(
            "surfaces {:.3g} scene units large are around a scene of {:.3g}: its precision and its light from "
            "infinity are made for the latter",
            size_of(all), size_of(bounds)));
    if (!bounds.is_empty()) scene.bounding_radius = to_unit_box.length(0.5 * (bounds.upper - bounds.lower).length());
    scene.shapes.reserve(description.shapes.size());
    for (ShapeDescription& shape : description.shapes) {
        scene.shapes.push_back(
            place_shape(shape.geometry, to_unit_box,
                        {.emits = shape.radiance.has_value(),
                         .has_texture = needs_texture_coordinates(scene.materials[shape.material]) ||
                                        scene.materials[shape.material].is_anisotropic || shape.radiance_texture}));
        scene.shapes.back().material = static_cast<std::uint32_t>(shape.material);
        shape.geometry = Geometry();
    }
    add_emitters(scene, description, extent_of(to_unit_box, bounds, all));
    scene.camera = make_camera(description.camera, resolution, to_unit_box);
    scene.embree = build_embree_scene(scene.shapes, scene.name);
    return scene;
}

// ---------------------------------------------------------------------------------------------------------------------

std::optional<Hit> intersect(const Scene& scene, const Ray& ray) {
    return intersect_between(scene, ray, 0.0f, infinity);
}

std::optional<Hit> intersect_between(const Scene& scene, const Ray& ray, float nearest, float farthest) {
    RTCRayHit query{};
    query.ray.org_x = ray.origin.x;
    query.ray.org_y = ray.origin.y;
    query.ray.org_z = ray.origin.z;
    query.ray.dir_x = ray.direction.x;
    query.ray.dir_y = ray.direction.y;
    query.ray.dir_z = ray.direction.z;
    query.ray.tnear = nearest;
    query.ray.tfar = farthest;
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
    complete(hit, scene.shapes[hit.shape], ray, query.hit.u, query.hit.v);
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
