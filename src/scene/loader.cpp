// The plugins of a Mitsuba scene file that photonlab knows, with Mitsuba's semantics. Whatever is not in these lists is
// an error that says what would have been accepted.

#include "scene/loader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <limits>
#include <set>

#include "core/error.h"
#include "core/text/nearest.h"
#include "core/text/text.h"
#include "scene/emitters/light_reader.h"
#include "scene/materials/material_reader.h"
#include "scene/mitsuba/properties.h"
#include "scene/mitsuba/transform.h"
#include "scene/mitsuba/xml_reader.h"
#include "scene/shapes/shape_reader.h"

namespace photonlab {

namespace {

class Loader {
public:
    Loader(SceneDescription& scene, const std::filesystem::path& folder, BytesRead& bytes_read)
        : scene_(scene), folder_(folder.string() + "/"), bytes_read_(bytes_read) {}

    void load(const XmlElement& root) {
        look_through(root);
        for (const XmlElement& element : root.children)
            if (is_for_shapes(element)) lights_without_shape_.insert(&element);
        bool has_sensor = false;
        bool has_integrator = false;
        for (const XmlElement& element : root.children) {
            if (element.tag == "bsdf") {
                material_index(element);
            } else if (element.tag == "shape") {
                add_shape(element);
            } else if (element.tag == "emitter") {
                if (!is_for_shapes(element)) add_light(element);
            } else if (element.tag == "integrator") {
                read_integrator(element);
                has_integrator = true;
            } else if (element.tag == "texture" || element.tag == "alias" || element.tag == "film" ||
                       element.tag == "rfilter" || element.tag == "sampler") {
                continue;  // read where something names it
            } else if (element.tag == "path") {
                note(fmt::format("{}: path: there is no folder \"{}\"", element.place, element.attribute("value")));
            } else if (element.tag == "sensor") {
                if (has_sensor) {
                    note("more than one sensor: the first is used");
                    continue;
                }
                read_sensor(element);
                has_sensor = true;
            } else {
                if (element.tag == "medium") fail_medium(element);
                throw InputError(element.place,
                                 unknown_element(element.tag, {"alias", "bsdf", "default", "emitter", "film", "include",
                                                               "integrator", "path", "rfilter", "sampler", "sensor",
                                                               "shape", "texture"}));
            }
        }
        if (!has_sensor) throw InputError(root.place, "expected a <sensor type=\"perspective\"> in the scene");
        note_clipping();
        if (!has_integrator && root.family() == MitsubaFamily::Version06)
            note("no integrator: Mitsuba 0.6 would render direct light alone, here max_depth is unlimited");
        if (!lights_without_shape_.empty())
            throw InputError((*lights_without_shape_.begin())->place, "area: no shape names this light by its id");
    }

private:
    [[noreturn]] static void fail_unknown(const XmlElement& element, std::string_view known) {
        throw InputError(element.place, fmt::format("unknown {} \"{}\"; known here: {}", element.tag,
                                                    element.attribute("type"), known));
    }

    [[noreturn]] static void fail_medium(const XmlElement& element) {
        throw InputError(element.place, "participating media are not rendered here: light crosses space unchanged");
    }

    static std::string unknown_element(const std::string& tag, const std::vector<std::string_view>& known) {
        const std::string guess = did_you_mean(tag, known);
        return fmt::format("unknown element <{}> in <scene>{}{}{}", tag, guess,
                           guess.empty() ? "; known here: " : " Known here: ", fmt::join(known, ", "));
    }

    /// Notes are recorded with every run: as text, of bounded length, each once, with files named as from the scene's
    /// folder.
    void note(const std::string& sentence) {
        constexpr std::size_t longest = 500;
        std::string text = valid_text(sentence);
        for (std::size_t at = 0; (at = text.find(folder_, at)) != text.npos;) text.erase(at, folder_.size());
        if (const std::string_view beginning = first_columns(text, longest); beginning.size() < text.size())
            text = std::string(beginning) + "...";
        if (noted_.insert(text).second) scene_.notes.push_back(text);
    }

    /// Collects what has an id. An alias is another id of what stands before it.
    void look_through(const XmlElement& element) {
        if (element.tag == "alias") {
            const auto found = by_id_.find(element.require("id"));
            if (found == by_id_.end())
                throw InputError(element.place, fmt::format("alias: expected the id of something before it, got \"{}\"",
                                                            element.attribute("id")));
            add_id(element, element.require("as"), *found->second);
        } else if (element.tag != "ref" && !element.attribute("id").empty()) {
            add_id(element, element.attribute("id"), element);
        } else if (lacks_up(element)) {
            note(fmt::format("{}: lookat without an up: turned about the view as Mitsuba {} does", element.place,
                             element.family() == MitsubaFamily::Version06 ? "0.6" : "3"));
        }
        for (const XmlElement& child : element.children) look_through(child);
    }

    void add_id(const XmlElement& where, const std::string& id, const XmlElement& element) {
        const auto [earlier, is_new] = by_id_.emplace(id, &element);
        if (!is_new)
            throw InputError(where.place,
                             fmt::format("expected an id of its own, got \"{}\", which stands already at {}", id,
                                         earlier->second->place));
    }

    /// The plugin itself, or the one that a <ref> names.
    const XmlElement& resolve(const XmlElement& element) const {
        if (element.tag != "ref") return element;
        const std::string& id = element.require("id");
        const auto found = by_id_.find(id);
        if (found == by_id_.end())
            throw InputError(element.place, fmt::format("expected the id of something in this scene, got \"{}\"", id));
        return *found->second;
    }

    SceneSource source() {
        return {.resolve = [this](const XmlElement& other) -> const XmlElement& { return resolve(other); },
                .bytes_read = bytes_read_,
                .image_pixels = image_pixels_,
                .note = [this](const std::string& sentence) { note(sentence); },
                .images = images_,
                .rough_coats = rough_coats_};
    }

    // -----------------------------------------------------------------------------------------------------------------
    // Materials

    std::size_t material_index(const XmlElement& element) {
        const auto found = materials_.find(&element);
        if (found != materials_.end()) return found->second;
        if (scene_.materials.size() >
            std::numeric_limits<std::uint16_t>::max())  // which is what a hit point has for it
            throw InputError(element.place, "expected at most 65536 materials");
        Material material = read_material(element, source());
        const std::string id = element.attribute("id");
        material.id = id.empty() ? element.attribute("type") : id;
        material.place = element.place;
        scene_.materials.push_back(std::move(material));
        return materials_[&element] = scene_.materials.size() - 1;
    }

    // -----------------------------------------------------------------------------------------------------------------
    // Shapes

    void add_shape(const XmlElement& element) {
        const SceneSource around = source();
        ShapeReader reader(element, around);
        ShapeDescription shape;
        shape.place = element.place;
        const XmlElement* bsdf = nullptr;
        for (const XmlElement* object : reader.properties.objects()) {
            const XmlElement& plugin = resolve(*object);
            if (plugin.tag == "bsdf") {
                require_for_whole_shape(element, *object);
                if (bsdf) throw InputError(object->place, "expected one bsdf in a shape, got a second");
                bsdf = &plugin;
            } else if (plugin.tag == "emitter") {
                if (shape.radiance) throw InputError(object->place, "expected one emitter in a shape, got a second");
                const AreaLight::Description light = read_area_light(plugin, around);
                shape.radiance = light.radiance;
                shape.radiance_texture = light.texture;
                shape.sampling_weight = light.sampling_weight;
                lights_without_shape_.erase(&plugin);
            } else {
                if (plugin.tag == "medium") fail_medium(*object);
                throw InputError(object->place,
                                 fmt::format("unexpected <{}> in a shape; known here: bsdf, emitter", plugin.tag));
            }
        }
        shape.material = bsdf ? material_index(*bsdf) : default_material(shape.radiance.has_value());
        reader.has_bsdf = bsdf != nullptr;
        reader.has_texture = needs_texture_coordinates(scene_.materials[shape.material]) || shape.radiance_texture;
        shape.geometry = read_geometry(reader);
        if (scene_.materials[shape.material].is_anisotropic) require_directions(shape.geometry, reader);
        scene_.shapes.push_back(std::move(shape));
    }

    /// Of a shape whose material's roughness depends on the direction.
    void require_directions(const Geometry& geometry, const ShapeReader& reader) {
        const auto* mesh = std::get_if<MeshDescription>(&geometry);
        if (!mesh || !mesh->texture_coordinates.empty()) return;
        const std::string what = fmt::format(
            "{}: its material's roughness depends on the direction, and a mesh without texture coordinates has none",
            reader.element.attribute("type"));
        if (reader.is_version_06()) throw InputError(reader.element.place, what);
        reader.source.note(
            fmt::format("{}: {}: as in Mitsuba 3 any is taken, triangle by triangle", reader.element.place, what));
    }

    /// 0.6 gives an OBJ file's parts the bsdfs that bear the names of their materials there.
    static void require_for_whole_shape(const XmlElement& shape, const XmlElement& object) {
        const std::string name = object.attribute("name");
        if (!name.empty() && shape.family() == MitsubaFamily::Version06 && shape.attribute("type") == "obj")
            throw InputError(object.place,
                             fmt::format("obj: in version 0.6 a bsdf called \"{}\" is for the parts of that material "
                                         "alone, which are not told apart here; without a name it is for all",
                                         name));
    }

    /// What Mitsuba gives a shape without a bsdf: grey, or black to one that emits.
    std::size_t default_material(bool emits) {
        std::optional<std::size_t>& index = emits ? default_of_lights_ : default_material_;
        if (!index) {
            index = scene_.materials.size();
            scene_.materials.push_back({.id = emits ? "default of lights" : "default",
                                        .bsdf = Diffuse{Color(emits ? 0.0f : 0.5f)},
                                        .two_sided = false});
        }
        return *index;
    }

    // -----------------------------------------------------------------------------------------------------------------
    // Lights

    /// An area light in the scene itself, which shapes before it or behind it name by its id.
    static bool is_for_shapes(const XmlElement& element) {
        return element.tag == "emitter" && element.attribute("type") == AreaLight::name &&
               !element.attribute("id").empty();
    }

    /// A second light around the scene is refused at once: its image may be large, and a file can name very many.
    void add_light(const XmlElement& element) {
        scene_.lights.push_back(read_scene_light(element, source()));
        if (is_environment(scene_.lights.back())) require_one_environment(scene_.lights);
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
        } else if (element.attribute("type") == "direct") {
            scene_.max_depth = 2;
            note("integrator \"direct\": read as max_depth 2");
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
            if (value < 1 || value > largest_image_side)
                throw InputError(properties.place_of(name),
                                 fmt::format("{}: expected 1 to {} pixels, got {}", name, largest_image_side, value));
            return static_cast<int>(value);
        };
        scene_.camera.width = size("width", type == "mfilm" ? 1 : 768);
        scene_.camera.height = size("height", type == "mfilm" ? 1 : 576);
        read_crop(properties);
        for (const XmlElement* object : properties.objects())
            note(fmt::format("{} \"{}\": not read; every pixel is the mean of its samples", object->tag,
                             object->attribute("type")));
        note_unread(element, properties);
    }

    /// The part of the film that is rendered.
    void read_crop(Properties& properties) {
        CameraDescription& camera = scene_.camera;
        const auto pixels = [&](const char* name, long least, long most, long missing) {
            const long value = properties.integer(name).value_or(missing);
            if (value < least || value > most)
                throw InputError(properties.place_of(name),
                                 fmt::format("{}: expected {} to {} pixels, got {}", name, least, most, value));
            return static_cast<int>(value);
        };
        FilmCrop crop;
        crop.x = pixels("crop_offset_x", 0, camera.width - 1, 0);
        crop.y = pixels("crop_offset_y", 0, camera.height - 1, 0);
        crop.width = pixels("crop_width", 1, camera.width - crop.x, camera.width);
        crop.height = pixels("crop_height", 1, camera.height - crop.y, camera.height);
        if (crop.width != camera.width || crop.height != camera.height) camera.crop = crop;
    }

    /// Horizontal field of view in degrees, from an angle about any of Mitsuba's axes or from a focal length on 35 mm
    /// film.
    static double read_fov_x(const XmlElement& element, Properties& properties, double aspect) {
        const auto fov = properties.number("fov");
        const auto focal_length = properties.text("focal_length");
        std::string axis = properties.text("fov_axis").value_or("x");
        for (char& c : axis) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
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
        const std::string& type = element.require("type");
        if (type != "perspective" && type != "thinlens") fail_unknown(element, "perspective, thinlens");
        Properties properties(element);
        scene_.camera.place = properties.place_of("to_world");
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
        near_clip_ = properties.number("near_clip").value_or(near_clip_);
        far_clip_ = properties.number("far_clip").value_or(far_clip_);
        const auto focus_distance = properties.number("focus_distance");
        if (type == "thinlens") read_lens(properties, focus_distance);
        if (type == "perspective" && focus_distance) note("sensor \"perspective\": not read: focus_distance");
        for (const char* unused : {"shutter_open", "shutter_close"})
            if (properties.number(unused)) note(fmt::format("sensor \"{}\": not read: {}", type, unused));
        properties.require_all_known();
    }

    /// Both lengths in scene units; a scale of to_world does not change them, as in Mitsuba.
    void read_lens(Properties& properties, std::optional<double> focus_distance) {
        const auto aperture_radius = properties.number("aperture_radius");
        const auto require = [&](const char* name, const std::optional<double>& length) {
            if (!length || !(*length > 0.0))
                throw InputError(length ? properties.place_of(name) : scene_.camera.place,
                                 fmt::format("sensor \"thinlens\": {}: expected a length above 0{}", name,
                                             length ? fmt::format(", got {}", *length) : ""));
        };
        require("aperture_radius", aperture_radius);
        require("focus_distance", focus_distance);
        scene_.camera.aperture_radius = *aperture_radius;
        scene_.camera.focus_distance = *focus_distance;
    }

    /// Mitsuba shows nothing that is nearer to the camera than near_clip or farther than far_clip, along its view.
    void note_clipping() {
        const Matrix& camera = scene_.camera.to_world;
        const VectorD position(camera[3][0], camera[3][1], camera[3][2]);
        const VectorD forward = VectorD(camera[2][0], camera[2][1], camera[2][2]).normalized();
        bool is_too_near = false;
        bool is_too_far = false;
        for (const ShapeDescription& shape : scene_.shapes) {
            if (const auto* mesh = std::get_if<MeshDescription>(&shape.geometry)) {
                for (const auto& triangle : mesh->triangles)
                    for (const std::uint32_t corner : {triangle.x, triangle.y, triangle.z}) {
                        const double depth = (mesh->positions[corner] - position).dot(forward);
                        is_too_near = is_too_near || (depth > 0.0 && depth < near_clip_);
                        is_too_far = is_too_far || depth > far_clip_;
                    }
            } else {
                const Bounds bounds = bounds_of(shape.geometry);
                const VectorD size = bounds.upper - bounds.lower;
                const double depth = ((bounds.lower + bounds.upper) * 0.5 - position).dot(forward);
                is_too_far = is_too_far || depth + 0.5 * std::max({size.x, size.y, size.z}) > far_clip_;
            }
        }
        if (is_too_near)
            note(fmt::format("near_clip {:g}: what is nearer to the camera is shown all the same", near_clip_));
        if (is_too_far)
            note(fmt::format("far_clip {:g}: what is farther from the camera is shown all the same", far_clip_));
    }

    SceneDescription& scene_;
    const std::string folder_;  // of the scene, as it stands before names of files
    BytesRead& bytes_read_;
    std::set<std::string> noted_;  // scene_.notes
    double near_clip_ = 1e-2;      // of the camera
    double far_clip_ = 1e4;
    std::size_t image_pixels_ = 0;
    std::map<std::string, std::shared_ptr<const ColorImage>> images_;
    std::map<std::array<double, 4>, std::shared_ptr<const RoughCoats>> rough_coats_;
    std::map<std::string, const XmlElement*> by_id_;
    std::map<const XmlElement*, std::size_t> materials_;
    std::optional<std::size_t> default_material_;
    std::optional<std::size_t> default_of_lights_;
    std::set<const XmlElement*> lights_without_shape_;  // of those in the scene itself that are for shapes
};

}  // namespace

SceneDescription load_scene_file(const std::filesystem::path& file,
                                 const std::map<std::string, std::string>& parameters) {
    SceneDescription scene;
    BytesRead bytes_read;
    const XmlElement root = read_scene_xml(file, parameters, bytes_read);
    for (const auto& [name, value] : parameters) {
        bytes_read.add(fmt::format("\n{}={}", name, value));
        scene.notes.push_back(valid_text(fmt::format("${} is \"{}\", as was asked for", name, value.substr(0, 200))));
    }
    Loader(scene, file.parent_path(), bytes_read).load(root);

    scene.hash = bytes_read.hash.text();
    const std::filesystem::path absolute = std::filesystem::absolute(file);
    scene.name = file.filename() == "scene.xml" ? absolute.parent_path().filename().string() : file.stem().string();
    return scene;
}

}  // namespace photonlab
