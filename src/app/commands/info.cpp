// photonlab info: what a scene holds and requires.

#include <fmt/format.h>

#include <array>
#include <filesystem>
#include <map>
#include <memory>
#include <type_traits>

#include "app/commands/commands.h"
#include "app/limits.h"
#include "app/options.h"
#include "core/machine/processors.h"
#include "core/text/messages.h"
#include "experiment/file/experiment_file.h"
#include "integrators/density_estimate.h"
#include "integrators/registry.h"
#include "render/estimates/memory.h"
#include "scene/loader.h"
#include "scene/narrow_gaps.h"
#include "transport/camera/camera_pass.h"
#include "transport/camera/left_out.h"
#include "transport/camera/plain_images.h"
#include "transport/light/photons.h"

namespace photonlab {

namespace {

struct InfoOptions {
    std::filesystem::path scene;
    std::string resolution;
    SceneParameters parameters;
};

void print_shapes(const Scene& scene) {
    std::size_t triangles = 0;
    std::map<std::string_view, std::size_t> count;
    for (const Shape& shape : scene.shapes) {
        ++count[shape_kind(shape)];
        if (const auto* mesh = std::get_if<TriangleMesh>(&shape.geometry)) triangles += mesh->triangles.size();
    }
    std::string others;
    for (const std::string_view kind : analytic_shape_kinds()) others += fmt::format(", {} {}s", count[kind], kind);
    print_output("shapes      {}: {} meshes of {} triangles in all{}\n", scene.shapes.size(), count[TriangleMesh::name],
                 triangles, others);
}

void print_materials(const Scene& scene) {
    std::map<std::string, std::size_t> kinds;
    for (const Material& material : scene.materials) {
        const std::string kind(material_kind(material));
        ++kinds[kind + (material.two_sided ? ", two-sided" : "")];
    }
    print_output("materials   {}\n", scene.materials.size());
    for (const auto& [kind, count] : kinds) print_output("            {} {}\n", count, kind);
}

/// What methods do where light meets a material.
std::string treatment_of(const Material& material) {
    const bool branches = may_be_specular(material);
    if (!branches && !may_scatter(material)) return "black: paths end there";
    if (!may_scatter(material)) return "followed into every single direction; nothing is gathered there";
    const char* gathered = may_scatter_through(material) ? "gathered at, from both sides" : "gathered at";
    if (branches) return fmt::format("{}, and followed into every single direction", gathered);
    if (const std::optional<float> alpha = roughness(material.bsdf))
        return fmt::format("{}; roughness {:.3g}: gone on from where sppm has glossy continue and gathers above that",
                           gathered, *alpha);
    return gathered;
}

/// How many shapes are treated in each way. `path` begins where the others gather, and goes on from there by chance.
void print_treatments(const Scene& scene) {
    std::map<std::string, std::size_t> shapes;
    for (const Shape& shape : scene.shapes) {
        const Material& material = scene.materials[shape.material];
        ++shapes[treatment_of(material)];
    }
    print_output("methods     of {} shapes\n", scene.shapes.size());
    for (const auto& [treatment, count] : shapes) print_output("            {} {}\n", count, treatment);
}

/// Lights that a path from the camera cannot find by a mirror or through glass, or will hardly.
void print_hidden_lights(const Scene& scene) {
    constexpr double hardly = 1e-4;  // of all directions, as seen from across the scene
    if (!has_specular_surfaces(scene)) return;
    std::size_t without_size = 0, small = 0;
    const double around = 4.0 * pi * scene.bounding_radius * scene.bounding_radius;
    for (const Emitter& emitter : scene.emitters) {
        if (!is_met_by_rays(emitter)) ++without_size;
        if (const auto shape = shape_of(emitter.kind)) small += scene.shapes[*shape].area < hardly * around;
    }
    if (without_size > 0)
        print_output(
            "warning     {} lights have no size: no path from the camera finds them by a mirror or through "
            "glass, so path refuses the scene, and sppm to go on from glossy surfaces, where ppm and photonmapper "
            "render their caustics\n",
            without_size);
    if (small > 0)
        print_output(
            "warning     {} lights are less than {:g} of what is seen from across the scene: path will hardly "
            "find them by a mirror or through glass, and be noisy in their caustics\n",
            small, hardly);
}

void print_emitters(const Scene& scene) {
    print_output("emitters    {}\n", scene.emitters.size());
    const double area_unit = scene.unit_length * scene.unit_length;
    for (const Emitter& emitter : scene.emitters) {
        const ColorD power = emitter.power * area_unit;
        print_output("            {} light, power {:.6g} {:.6g} {:.6g}, chosen with probability {:.4g}\n",
                     emitter_kind(emitter), power.x, power.y, power.z, emitter.choice_probability);
    }
}

/// Mean over hit points of the radius that a method begins with where none is given, in scene units.
double mean_automatic_radius(const Scene& scene, const HitPoints& hit_points) {
    const IntegratorContext context{.scene = scene, .hit_points = hit_points};
    double sum = 0.0;
    for (std::size_t i = 0; i < hit_points.points.size(); ++i) sum += initial_radius(MethodSettings{}, context, i);
    return sum / static_cast<double>(hit_points.points.size()) * scene.unit_length;
}

void print_narrow_gaps(const Scene& scene) {
    const NarrowGaps gaps = find_narrow_gaps(scene);
    if (!gaps.first) return;
    const VectorD position = VectorD(gaps.first->position) * scene.unit_length + scene.centre;
    print_output(
        "warning     surfaces are less than {:g} of the scene apart at {} of {} points tried, the first between shapes "
        "{} "
        "and {} at {:.6g} {:.6g} {:.6g}: light can pass between them or meet the wrong one\n",
        narrowest_gap, gaps.found, gaps.tried, gaps.first->shape + 1, gaps.first->other + 1, position.x, position.y,
        position.z);
}

void info(const InfoOptions& options) {
    std::optional<Resolution> resolution;
    if (!options.resolution.empty()) resolution = parse_resolution(options.resolution);
    const int threads = start_threads_up_to(usable_processors());
    const Scene scene = build_scene(load_scene_file(options.scene, options.parameters.values()), resolution);
    const Camera& camera = scene.camera;
    const VectorD position = VectorD(camera.position) * scene.unit_length + scene.centre;

    print_output("scene       {}\n", scene.name);
    print_output("hash        {}\n", scene.hash);
    print_shapes(scene);
    print_materials(scene);
    print_treatments(scene);
    print_emitters(scene);
    print_output("camera      at {:.6g} {:.6g} {:.6g}, {}x{} pixels, {:.4g} degrees wide\n", position.x, position.y,
                 position.z, camera.width, camera.height, 2.0 * std::atan(camera.right.length() / 2.0) * 180.0 / pi);
    print_output("max depth   {}\n", scene.max_depth < 0 ? "unlimited" : std::to_string(scene.max_depth));
    print_output("size        bounding radius {:.6g}, around {:.6g} {:.6g} {:.6g} (scene units)\n",
                 scene.bounding_radius * scene.unit_length, scene.centre.x, scene.centre.y, scene.centre.z);

    RunSettings paths;
    paths.method.integrator = "path";
    require_memory(options.scene.string(), MemoryEstimator(scene, 1).of({paths}, 0));
    const HitPoints hit_points = trace_hit_points(scene, 1, threads);
    const std::size_t count = hit_points.points.size();
    print_output("hit points  {} at one sample a pixel\n", count);
    if (count > 0)
        print_output("auto radius {:.6g} in the mean (scene units)\n", mean_automatic_radius(scene, hit_points));
    print_output("photons     {} bytes each, one kind\n", sizeof(Photon));
    for (const std::string& what : what_is_left_out(scene, hit_points)) print_output("left out    {}\n", what);
    for (const std::string& note : scene.notes) print_output("note        {}\n", note);
    if (const auto note = note_of_raised_radii(MethodSettings{}, scene, hit_points))
        print_output("note        {}\n", *note);
    print_narrow_gaps(scene);
    print_hidden_lights(scene);
    for (const std::string& reason : why_images_are_plain(scene, hit_points)) print_output("warning     {}\n", reason);
}

}  // namespace

void add_info_command(CLI::App& app) {
    auto options = std::make_shared<InfoOptions>();
    CLI::App* command = app.add_subcommand("info", "Say what a scene holds and requires");
    command->add_option("SCENE", options->scene, "scene file (Mitsuba XML)")->required();
    options->parameters.add_to(*command);
    command->add_option("--resolution", options->resolution, "WIDTHxHEIGHT in place of the scene file's");
    command->footer("Example:\n  photonlab info scenes/cornell-box/scene.xml");
    command->callback([options] { info(*options); });
}

}  // namespace photonlab
