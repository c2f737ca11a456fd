// The plugins of a Mitsuba scene file that photonlab knows, with Mitsuba's semantics. Whatever is not in these lists is
// an error that says what would have been accepted.

#include "scene/loader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cstdint>
#include <limits>

#include "core/error.h"
#include "core/hash.h"
#include "scene/material_reader.h"
#include "scene/properties.h"
#include "scene/transform.h"
#include "scene/xml_reader.h"

namespace photonlab {

namespace {

class Loader {
public:
    explicit Loader(SceneDescription& scene, std::string& bytes_read) : scene_(scene), bytes_read_(bytes_read) {}

    void load(const XmlElement& root) {
        collect_ids(root);
        bool has_sensor = false;
        for (const XmlElement& element : root.children) {
            if (element.tag == "bsdf") {
                material_index(element);
            } else if (element.tag == "shape") {
                add_shape(element);
            } else if (element.tag == "emitter") {
                add_point_light(element);
            } else if (element.tag == "integrator") {
                read_integrator(element);
            } else if (element.tag == "texture") {
                continue;  // read where a material names it
            } else if (element.tag == "sensor") {
                if (has_sensor) {
                    note("more than one sensor: the first is used");
                    continue;
                }
                read_sensor(element);
                has_sensor = true;
            } else {
                throw InputError(element.place,
                                 fmt::format("unknown element <{}> in <scene>; known here: bsdf, default, "
                                             "emitter, include, integrator, sensor, shape, texture",
                                             element.tag));
            }
        }
        if (!has_sensor) throw InputError(root.place, "expected a <sensor type=\"perspective\"> in the scene");
    }

private:
    [[noreturn]] static void fail_unknown(const XmlElement& element, std::string_view known) {
        throw InputError(element.place, fmt::format("unknown {} \"{}\"; known here: {}", element.tag,
                                                    element.attribute("type"), known));
    }

    void note(const std::string& sentence) {
        if (std::find(scene_.notes.begin(), scene_.notes.end(), sentence) == scene_.notes.end())
            scene_.notes.push_back(sentence);
    }

    void collect_ids(const XmlElement& element) {
        const std::string id = element.attribute("id");
        if (!id.empty() && element.tag != "ref") {
            const auto [earlier, is_new] = by_id_.emplace(id, &element);
            if (!is_new)
                throw InputError(element.place,
                                 fmt::format("id \"{}\" stands already at {}", id, earlier->second->place));
        }
        for (const XmlElement& child : element.children) collect_ids(child);
    }

    /// The plugin itself, or the one that a <ref> names.
    const XmlElement& resolve(const XmlElement& element) const {
        if (element.tag != "ref") return element;
        const std::string& id = element.require("id");
        const auto found = by_id_.find(id);
        if (found == by_id_.end())
            throw InputError(element.place, fmt::format("nothing in this scene has the id \"{}\"", id));
        return *found->second;
    }

    // -----------------------------------------------------------------------------------------------------------------
    // Materials

    std::size_t material_index(const XmlElement& element) {
        const auto found = materials_.find(&element);
        if (found != materials_.end()) return found->second;
        if (scene_.materials.size() >
            std::numeric_limits<std::uint16_t>::max())  // which is what a hit point has for it
            throw InputError(element.place, "expected at most 65536 materials");
        Material material = read_material(
            element, {.resolve = [this](const XmlElement& other) -> const XmlElement& { return resolve(other); },
                      .bytes_read = bytes_read_,
                      .texture_pixels = texture_pixels_,
                      .note = [this](const std::string& sentence) { note(sentence); }});
        const std::string id = element.attribute("id");
        material.id = id.empty() ? element.attribute("type") : id;
        scene_.materials.push_back(std::move(material));
        return materials_[&element] = scene_.materials.size() - 1;
    }

    // -----------------------------------------------------------------------------------------------------------------
    // Shapes

    void add_shape(const XmlElement& element) {
        const std::string& type = element.require("type");
        Properties properties(element);
        const Matrix to_world = properties.transform("to_world").value_or(Matrix());
        const bool flip_normals = properties.boolean("flip_normals").value_or(false);

        ShapeDescription shape;
        shape.place = element.place;
        if (type == "obj")
            shape.geometry = place_mesh(read_obj(element, properties), to_world, flip_normals);
        else if (type == "rectangle")
            shape.geometry = place_mesh(rectangle(), to_world, flip_normals);
        else if (type == "cube")
            shape.geometry = place_mesh(cube(), to_world, flip_normals);
        else if (type == "sphere")
            shape.geometry = read_sphere(element, properties, to_world, flip_normals);
        else if (type == "disk")
            shape.geometry =
                DiskDescription{.centre = transform_point(to_world, VectorD(0.0)),
                                .normal = transform_normal(to_world, {0.0, 0.0, flip_normals ? -1.0 : 1.0}),
                                .radius = uniform_scale(to_world, 2, element.place)};
        else
            fail_unknown(element, "cube, disk, obj, rectangle, sphere");
        properties.require_all_known();

        const XmlElement* bsdf = nullptr;
        for (const XmlElement* object : properties.objects()) {
            const XmlElement& plugin = resolve(*object);
            if (plugin.tag == "bsdf") {
                if (bsdf) throw InputError(object->place, "expected one bsdf in a shape, got a second");
                bsdf = &plugin;
            } else if (plugin.tag == "emitter") {
                if (shape.radiance) throw InputError(object->place, "expected one emitter in a shape, got a second");
                shape.radiance = read_area_light(plugin);
            } else {
                throw InputError(object->place,
                                 fmt::format("unexpected <{}> in a shape; known here: bsdf, emitter", plugin.tag));
            }
        }
        shape.material = bsdf ? material_index(*bsdf) : default_material();
        scene_.shapes.push_back(std::move(shape));
    }

    /// What Mitsuba gives a shape without a bsdf.
    std::size_t default_material() {
        if (!default_material_) {
            scene_.materials.push_back({.id = "default", .bsdf = Diffuse{}, .two_sided = false});
            default_material_ = scene_.materials.size() - 1;
        }
        return *default_material_;
    }

    MeshDescription read_obj(const XmlElement& element, Properties& properties) {
        const auto filename = properties.text("filename");
        if (!filename) throw InputError(element.place, "obj: expected a <string name=\"filename\">");
        const bool face_normals = properties.boolean("face_normals").value_or(false);
        const bool flip_texture = properties.boolean("flip_tex_coords").value_or(true);
        const std::filesystem::path file = element.file_called(*filename);
        read_part(file, properties.place_of("filename"), bytes_read_);
        MeshDescription mesh = load_obj_mesh(file, face_normals);
        if (flip_texture)
            for (Imath::V2d& uv : mesh.texture_coordinates) uv.y = 1.0 - uv.y;
        return mesh;
    }

    static SphereDescription read_sphere(const XmlElement& element, Properties& properties, const Matrix& to_world,
                                         bool flip_normals) {
        const VectorD centre = properties.vector("center").value_or(VectorD(0.0));
        const double radius = properties.number("radius").value_or(1.0);
        if (!(radius > 0.0))
            throw InputError(properties.place_of("radius"),
                             fmt::format("radius: expected a number above 0, got {}", radius));
        return {.centre = transform_point(to_world, centre),
                .radius = radius * uniform_scale(to_world, 3, element.place),
                .flip_normals = flip_normals};
    }

    /// [-1, 1]^2 at z = 0, facing +z.
    static MeshDescription rectangle() {
        MeshDescription mesh;
        mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
        mesh.texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
        mesh.triangles.emplace_back(0, 1, 2);
        mesh.triangles.emplace_back(0, 2, 3);
        return mesh;
    }

    /// [-1, 1]^3, facing outwards; corners apart on each face, so that texture coordinates run over each.
    static MeshDescription cube() {
        MeshDescription mesh;
        const MeshDescription face = rectangle();
        for (int axis = 0; axis < 3; ++axis)
            for (const double side : {-1.0, 1.0}) {
                const auto first = static_cast<std::uint32_t>(mesh.positions.size());
                for (const VectorD& corner : face.positions) {
                    VectorD position;
                    position[axis] = side;
                    position[(axis + 1) % 3] = side * corner.x;
                    position[(axis + 2) % 3] = corner.y;
                    mesh.positions.push_back(position);
                }
                mesh.texture_coordinates.insert(mesh.texture_coordinates.end(), face.texture_coordinates.begin(),
                                                face.texture_coordinates.end());
                for (const auto& triangle : face.triangles)
                    mesh.triangles.push_back({first + triangle.x, first + triangle.y, first + triangle.z});
            }
        return mesh;
    }

    /// Moves a mesh to the world. A mirroring turns triangles inside out, so it turns them back: outside stays outside.
    static MeshDescription place_mesh(MeshDescription mesh, const Matrix& to_world, bool flip_normals) {
        for (VectorD& position : mesh.positions) position = transform_point(to_world, position);
        for (VectorD& normal : mesh.normals) normal = transform_normal(to_world, flip_normals ? -normal : normal);
        if ((handedness(to_world) < 0.0) != flip_normals)
            for (auto& triangle : mesh.triangles) std::swap(triangle.y, triangle.z);
        return mesh;
    }

    // -----------------------------------------------------------------------------------------------------------------
    // Lights

    static ColorD read_light(Properties& properties, const std::string& name, const ColorD& missing) {
        const ColorD light = properties.emission(name).value_or(missing);
        if (std::min({light.x, light.y, light.z}) < 0.0)
            throw InputError(properties.place_of(name), fmt::format("{}: expected values of at least 0, got {} {} {}",
                                                                    name, light.x, light.y, light.z));
        return light;
    }

    static ColorD read_area_light(const XmlElement& element) {
        if (element.require("type") != "area") fail_unknown(element, "area (in a shape), point (in the scene)");
        Properties properties(element);
        const ColorD radiance = read_light(properties, "radiance", ColorD(1.0));
        properties.require_all_known();
        return radiance;
    }

    void add_point_light(const XmlElement& element) {
        if (element.require("type") != "point") fail_unknown(element, "area (in a shape), point (in the scene)");
        Properties properties(element);
        PointLightDescription light;
        light.place = element.place;
        const auto position = properties.vector("position");
        const auto to_world = properties.transform("to_world");
        if (position && to_world) throw InputError(element.place, "point: expected position or to_world, got both");
        light.position = position ? *position : transform_point(to_world.value_or(Matrix()), VectorD(0.0));
        light.intensity = read_light(properties, "intensity", ColorD(1.0));
        properties.require_all_known();
        scene_.point_lights.push_back(light);
    }

    // -----------------------------------------------------------------------------------------------------------------
    // Camera, and what speaks to other programs

    void read_integrator(const XmlElement& element) {
        Properties properties(element);
        if (const auto max_depth = properties.integer("max_depth")) {
            if (*max_depth != -1 && (*max_depth < 1 || *max_depth > 1'000'000))
                throw InputError(properties.place_of("max_depth"),
                                 fmt::format("max_depth: expected -1 or 1 to 1000000, got {}", *max_depth));
            scene_.max_depth = static_cast<int>(*max_depth);
        }
        for (const XmlElement* nested : properties.objects())
            if (nested->tag == "integrator") read_integrator(*nested);
        note(fmt::format("of integrator \"{}\" only max_depth is read", element.attribute("type")));
    }

    /// Notes a plugin that tells another program how to render, and the properties that are not read.
    void note_unread(const XmlElement& element, const Properties& properties) {
        const std::vector<std::string> unread = properties.unknown();
        if (!unread.empty())
            note(fmt::format("{} \"{}\": not read: {}", element.tag, element.attribute("type"),
                             fmt::join(unread, ", ")));
    }

    void read_film(const XmlElement& element) {
        const std::string& type = element.require("type");
        if (type != "hdrfilm" && type != "ldrfilm" && type != "mfilm") fail_unknown(element, "hdrfilm, ldrfilm, mfilm");
        Properties properties(element);
        const auto size = [&](const std::string& name, int missing) {
            const long value = properties.integer(name).value_or(missing);
            if (value < 1 || value > 16384)
                throw InputError(properties.place_of(name),
                                 fmt::format("{}: expected 1 to 16384 pixels, got {}", name, value));
            return static_cast<int>(value);
        };
        scene_.camera.width = size("width", 768);
        scene_.camera.height = size("height", 576);
        const std::pair<const char*, long> whole_film[] = {{"crop_offset_x", 0},
                                                           {"crop_offset_y", 0},
                                                           {"crop_width", scene_.camera.width},
                                                           {"crop_height", scene_.camera.height}};
        for (const auto& [name, whole] : whole_film) {
            const long value = properties.integer(name).value_or(whole);
            if (value != whole)
                throw InputError(
                    properties.place_of(name),
                    fmt::format("{}: expected {}, cropped films are not known here, got {}", name, whole, value));
        }
        for (const XmlElement* object : properties.objects())
            note(fmt::format("{} \"{}\": not read; every pixel is the mean of its samples", object->tag,
                             object->attribute("type")));
        note_unread(element, properties);
    }

    /// Horizontal field of view in degrees, from an angle about any of Mitsuba's axes or from a focal length on 35 mm
    /// film.
    static double read_fov_x(const XmlElement& element, Properties& properties, double aspect) {
        const auto fov = properties.number("fov");
        const auto focal_length = properties.text("focal_length");
        std::string axis = properties.text("fov_axis").value_or("x");
        if (fov && focal_length) throw InputError(element.place, "perspective: expected fov or focal_length, got both");
        double degrees = 0.0;
        if (fov) {
            degrees = *fov;
        } else {
            std::string length = focal_length.value_or("50mm");
            if (length.size() > 2 && length.compare(length.size() - 2, 2, "mm") == 0) length.resize(length.size() - 2);
            const double millimetres = parse_number(length, properties.place_of("focal_length"));
            degrees = 2.0 * std::atan(std::hypot(36.0, 24.0) / (2.0 * millimetres)) * 180.0 / pi;
            axis = "diagonal";
        }
        if (!(degrees > 0.0 && degrees < 180.0))
            throw InputError(properties.place_of("fov"),
                             fmt::format("fov: expected degrees in (0, 180), got {}", degrees));
        const bool is_wide = aspect > 1.0;
        const double tangent = std::tan(degrees * pi / 360.0);
        if (axis == "x" || axis == (is_wide ? "larger" : "smaller")) return degrees;
        if (axis == "y" || axis == (is_wide ? "smaller" : "larger"))
            return 2.0 * std::atan(tangent * aspect) * 180.0 / pi;
        if (axis == "diagonal") return 2.0 * std::atan(tangent * aspect / std::hypot(1.0, aspect)) * 180.0 / pi;
        throw InputError(properties.place_of("fov_axis"),
                         fmt::format("unknown fov_axis \"{}\"; known here: diagonal, larger, smaller, x, y", axis));
    }

    void read_sensor(const XmlElement& element) {
        if (element.require("type") != "perspective") fail_unknown(element, "perspective");
        Properties properties(element);
        scene_.camera.to_world = properties.transform("to_world").value_or(Matrix());
        for (const XmlElement* object : properties.objects()) {
            const XmlElement& plugin = resolve(*object);
            if (plugin.tag == "film")
                read_film(plugin);
            else if (plugin.tag == "sampler")
                note(fmt::format("sampler \"{}\": not read; sample positions are a fixed grid",
                                 plugin.attribute("type")));
            else
                throw InputError(object->place,
                                 fmt::format("unexpected <{}> in a sensor; known here: film, sampler", plugin.tag));
        }
        scene_.camera.fov_x =
            read_fov_x(element, properties, static_cast<double>(scene_.camera.width) / scene_.camera.height);
        for (const char* name : {"principal_point_offset_x", "principal_point_offset_y"})
            if (properties.number(name).value_or(0.0) != 0.0)
                throw InputError(properties.place_of(name),
                                 fmt::format("{}: expected 0, a shifted image plane is not known here", name));
        for (const char* unused : {"near_clip", "far_clip", "focus_distance", "shutter_open", "shutter_close"})
            if (properties.number(unused)) note(fmt::format("sensor \"perspective\": not read: {}", unused));
        properties.require_all_known();
    }

    SceneDescription& scene_;
    std::string& bytes_read_;
    std::size_t texture_pixels_ = 0;
    std::map<std::string, const XmlElement*> by_id_;
    std::map<const XmlElement*, std::size_t> materials_;
    std::optional<std::size_t> default_material_;
};

}  // namespace

SceneDescription load_scene_file(const std::filesystem::path& file,
                                 const std::map<std::string, std::string>& parameters) {
    SceneDescription scene;
    std::string bytes_read;
    const XmlElement root = read_scene_xml(file, parameters, bytes_read);
    for (const auto& [name, value] : parameters) bytes_read += fmt::format("\n{}={}", name, value);
    Loader(scene, bytes_read).load(root);

    scene.hash = hash_text(bytes_read);
    const std::filesystem::path absolute = std::filesystem::absolute(file);
    scene.name = file.filename() == "scene.xml" ? absolute.parent_path().filename().string() : file.stem().string();
    return scene;
}

}  // namespace photonlab
