// photonlab reference: adds samples to the two halves of a reference.

#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "app/commands/commands.h"
#include "app/interruption.h"
#include "app/limits.h"
#include "app/options.h"
#include "app/summary.h"
#include "core/files/files.h"
#include "core/machine/processors.h"
#include "core/text/messages.h"
#include "core/text/progress.h"
#include "experiment/file/experiment_file.h"
#include "record/run/part.h"
#include "reference/reference_store.h"
#include "scene/loader.h"

namespace photonlab {

namespace {

struct ReferenceOptions {
    ReferenceSettings settings;
    std::filesystem::path output;
    std::string resolution;
    SceneParameters parameters;
    std::optional<int> max_depth;
    std::string passes;
};

/// Of the range of samples that is asked for, in a file of its own in the folder.
void make_part(const ReferenceOptions& options, const Scene& scene) {
    const ReferenceSettings& settings = options.settings;
    const auto [passes, is_part] = parse_passes(options.passes);
    if (!is_part)
        throw InputError("--passes: expected a range of samples such as 17..32; --samples says how many to add");
    if (settings.picture_only) throw InputError("--picture-only: is of no use with --passes, whose sums are joined");
    const std::filesystem::path file = options.output / fmt::format("passes-{}-{}.ck", passes.first, passes.last);
    const RunPart part{.command = "reference",
                       .scene_file = std::filesystem::absolute(settings.scene_file),
                       .parameters = options.parameters.values(),
                       .scene_hash = scene.hash,
                       .width = scene.camera.width,
                       .height = scene.camera.height,
                       .samples_per_pixel = settings.samples_per_pixel,
                       .settings = reference_method(settings),
                       .seed = settings.seed,
                       .passes = passes};
    Progress progress(2 * passes.count());
    const bool is_whole = make_reference_part(scene, settings, passes, checkpoint_of(part, file),
                                              [&](std::uint64_t done, std::uint64_t total) {
                                                  progress.show(done, fmt::format("sample {} of {}", done, total));
                                              });
    progress.clear();
    if (!is_whole) throw Interrupted("interrupted, and saved; the same command makes the other samples");
    print_output("{}: samples {} of both halves, for photonlab join\n", file.string(), describe(passes));
}

void make_reference(ReferenceOptions options) {
    std::optional<Resolution> resolution;
    if (!options.resolution.empty()) resolution = parse_resolution(options.resolution);
    start_threads(options.settings.threads);
    const Scene scene =
        build_scene(load_scene_file(options.settings.scene_file, options.parameters.values()), resolution);
    options.settings.max_depth = options.max_depth.value_or(scene.max_depth);

    listen_for_interruptions();
    options.settings.is_interrupted = is_interrupted;
    if (!options.passes.empty()) return make_part(options, scene);

    const bool adds = options.settings.samples > 0;
    if (adds && is_there(options.output / "reference.json"))
        print_message(
            "{}: adds to the {} samples a half that are there; runs that were judged by them will be made again\n",
            options.output.string(), read_reference_json(options.output).at("samples_per_half").get<std::uint64_t>());
    std::uint64_t samples_left = 0;
    Progress progress(2 * options.settings.samples);
    const auto show = [&](std::uint64_t done, std::uint64_t total) {
        samples_left = (total - done) / 2;
        progress.show(done, fmt::format("sample {} of {}, both halves; saved about every {:.0f} s", done, total,
                                        options.settings.seconds_between_saves));
    };
    const Json json = adds ? add_reference_samples(scene, options.settings, options.output, show)
                           : compare_reference_with_photons(scene, options.settings, options.output);
    progress.clear();
    if (!adds && is_interrupted()) throw Interrupted("interrupted; nothing was compared");
    print_reference(options.output, json);
    print_output("wrote {}\n", (options.output / "reference.json").string());
    if (samples_left > 0)
        throw Interrupted(fmt::format("interrupted, and saved; --samples {} adds the rest", samples_left));
}

}  // namespace

void add_reference_command(CLI::App& app) {
    auto options = std::make_shared<ReferenceOptions>();
    ReferenceSettings& settings = options->settings;
    settings.threads = usable_processors();
    CLI::App* command = app.add_subcommand("reference", "Add samples to a reference of two halves");
    command->add_option("SCENE", settings.scene_file, "scene file (Mitsuba XML)")->required();
    command->add_option("-o", options->output, "folder of the reference")->required()->check(require_folder_name);
    command->add_option(
        "--integrator", settings.integrator,
        fmt::format("path, or ppm where paths from the camera do not find the light [{}]", settings.integrator));
    command->add_option("--photons", settings.photons_per_pass,
                        fmt::format("ppm: paths emitted a pass [{}]", settings.photons_per_pass));
    command->add_option("--alpha", settings.alpha, "ppm: of the schedule of Knaus and Zwicker [2/3]");
    command
        ->add_option(
            "--samples", settings.samples,
            fmt::format(
                "to add to each half: paths a sample position, or passes of ppm; 0 only compares what is there with "
                "the light that photons find [{}]",
                settings.samples))
        ->check(CLI::Range(0u, 0x7fffffffu));
    command
        ->add_option("--passes", options->passes,
                     "A..B: makes these samples of both halves alone, into a file of its own in the folder, for "
                     "photonlab join; others make the rest")
        ->excludes("--samples");
    options->parameters.add_to(*command);
    command->add_option("--resolution", options->resolution, "WIDTHxHEIGHT in place of the scene file's");
    command->add_option("--samples-per-pixel", settings.samples_per_pixel,
                        fmt::format("sample positions, a perfect square [{}]", settings.samples_per_pixel));
    command->add_option_function<std::string>(
        "--positions",
        [options](const std::string& name) {
            options->settings.positions = parse_choice<Positions>("--positions", name);
        },
        "grid: of the sample positions; box: of the pixels' areas, with a lens of all of it [grid]");
    command->add_option("--max-depth", options->max_depth,
                        "edges from camera to light, -1 is unlimited [the scene file's]");
    command->add_option("--seed", settings.seed, fmt::format("of all random numbers [{}]", settings.seed))
        ->check(require_whole_number);
    command
        ->add_option("--threads", settings.threads,
                     "threads to use [what the job may use: SLURM_CPUS_PER_TASK, else the affinity mask]; the image "
                     "does not depend on it")
        ->check(CLI::Range(1, 1024));
    command->add_flag("--picture-only", settings.picture_only,
                      "store the picture without its layers, a third of the size; nothing can be added to it");
    command->footer(
        "Calling it again adds to what is there. Example:\n  photonlab reference scenes/cornell-box/scene.xml -o "
        "results/reference/cornell-box --resolution 128x128 --samples 4096");
    command->callback([options] { make_reference(*options); });
}

}  // namespace photonlab
