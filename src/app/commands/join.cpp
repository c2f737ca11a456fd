// photonlab join: puts together what several processes or machines made of one run, each a range of its passes. Sums
// are exact, so the image has the bits of a run that took all of them.

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "app/commands/commands.h"
#include "app/limits.h"
#include "app/options.h"
#include "app/summary.h"
#include "app/written_files.h"
#include "core/files/files.h"
#include "core/machine/processors.h"
#include "core/text/messages.h"
#include "core/text/text.h"
#include "experiment/experiment_plan.h"
#include "image/exr.h"
#include "image/png.h"
#include "record/recorder.h"
#include "record/run/part.h"
#include "record/run/run_record.h"
#include "reference/reference_store.h"
#include "render/estimates/memory.h"
#include "scene/loader.h"
#include "transport/camera/camera_pass.h"

namespace photonlab {

namespace {

struct JoinOptions {
    std::vector<std::filesystem::path> parts;
    std::filesystem::path output;
    std::filesystem::path scene;  ///< where it is by now; empty: where the parts had it
    std::string reference;
    std::string csv;
    std::string png;
    int threads = usable_processors();
};

std::filesystem::path scene_file_of(const JoinOptions& options, const RunPart& part) {
    return options.scene.empty() ? part.scene_file : options.scene;
}

/// The scene as it was when the parts were made.
Scene scene_of(const JoinOptions& options, const PartFile& file) {
    const RunPart& part = file.part;
    const std::filesystem::path scene_file = scene_file_of(options, part);
    if (options.scene.empty() && !is_there(scene_file))
        throw InputError(scene_file.string(), "is not there any more; --scene names a scene that is elsewhere by now");
    Scene scene = build_scene(load_scene_file(scene_file, part.parameters), Resolution{part.width, part.height});
    if (scene.hash != part.scene_hash)
        throw InputError(scene_file.string(), "is not the scene that " + file.checkpoint.file.string() +
                                                  " was made of; --scene names one that is elsewhere by now");
    return scene;
}

/// Before hours are spent: everything that is to be written can be.
void require_room_for(const JoinOptions& options, const std::vector<PartFile>& parts) {
    std::vector<std::filesystem::path> inputs = files_of_reference(options.reference);
    inputs.push_back(scene_file_of(options, parts[0].part));
    for (const PartFile& part : parts) inputs.push_back(part.checkpoint.file);
    const auto& [exr, png, csv, ply] = file_kinds;
    std::vector<WrittenFile> written{{"-o", options.output, &exr}};
    if (!options.png.empty()) written.push_back({"--png", options.png, &png});
    if (!options.csv.empty()) {
        written.push_back({"--csv", options.csv, &csv});
        written.push_back({"--csv", columns_file(options.csv), nullptr});
    }
    require_sound_outputs(inputs, written);
}

/// Which passes there are.
void print_parts(const std::vector<PartFile>& parts) {
    for (const auto& [checkpoint, part] : parts)
        print_output("{:<11} {}\n", describe(part.passes), checkpoint.file.string());
}

std::string gaps_between(const std::vector<PartFile>& parts) {
    std::vector<PassRange> ranges;
    for (const PartFile& file : parts) ranges.push_back(file.part.passes);
    return gaps_of(ranges);
}

void join_render(const JoinOptions& options, const std::vector<PartFile>& parts) {
    require_room_for(options, parts);
    start_threads(options.threads);
    const RunPart& part = parts[0].part;
    const Scene scene = scene_of(options, parts[0]);
    const RunSettings settings{.method = part.settings,
                               .seed = part.seed,
                               .passes = parts.back().part.passes.last,
                               .threads = options.threads};
    std::optional<Reference> reference;
    if (!options.reference.empty())
        reference = load_reference(options.reference, subject_of(scene, part.samples_per_pixel, part.settings));
    require_memory(scene_file_of(options, part).string(),
                   MemoryEstimator(scene, part.samples_per_pixel).of({settings}, 0));

    const HitPoints hit_points =
        trace_hit_points(scene, part.samples_per_pixel, options.threads, part.settings.branch_cutoff);
    PassLoop loop(scene, hit_points, {settings});
    for (const PartFile& file : parts) load_part(file, loop);
    const Image image = loop.image();
    const RunState& state = loop.state(0);

    Recorder recorder({"render", "render", valid_text(scene.name), part.settings.integrator, settings,
                       scene.camera.width, scene.camera.height, part.samples_per_pixel, hit_points.points.size()},
                      reference ? &*reference : nullptr, options.csv);
    recorder.record(state, image);
    write_exr(options.output, image, image_metadata(recorder.identity(), state, scene));
    if (!options.png.empty()) write_png(options.png, image.width, image.height, total(image));
    if (!options.csv.empty()) write_columns(columns_file(options.csv));

    print_parts(parts);
    print_summary(state, settings, scene, hit_points.points.size(), recorder.last_total_errors());
    if (const std::string gaps = gaps_between(parts); !gaps.empty())
        print_output("note        passes {} are in none of these: the image is the mean of the others\n", gaps);
    for (const std::string& file : {options.output.string(), options.png, options.csv})
        if (!file.empty()) print_output("wrote       {}\n", file);
}

void join_reference(const JoinOptions& options, const std::vector<PartFile>& parts) {
    for (const std::string& file : {options.reference, options.csv, options.png})
        if (!file.empty()) throw InputError(file, "these are parts of a reference: expected its folder as -o alone");
    if (const std::string fault = require_folder_name(options.output.string()); !fault.empty()) throw InputError(fault);
    // Whoever adds to it goes on from the number of its samples.
    if (const std::string gaps = gaps_between(parts); !gaps.empty())
        throw InputError(
            fmt::format("samples {} are in none of these parts: a reference has all from the first on", gaps));
    start_threads(options.threads);
    const RunPart& part = parts[0].part;
    const Scene scene = scene_of(options, parts[0]);
    const ReferenceSettings settings{.scene_file = scene_file_of(options, part),
                                     .integrator = part.settings.integrator,
                                     .photons_per_pass = part.settings.photons_per_pass,
                                     .alpha = part.settings.alpha,
                                     .samples_per_pixel = part.samples_per_pixel,
                                     .positions = part.settings.positions,
                                     .max_depth = part.settings.max_depth,
                                     .seed = part.seed,
                                     .threads = options.threads};
    std::vector<ReferencePart> files;
    for (const PartFile& file : parts) files.push_back({file.checkpoint, file.part.passes});
    const Json json = join_reference_parts(scene, settings, files, options.output);
    print_parts(parts);
    print_reference(options.output, json);
    print_output("wrote {}\n", (options.output / "reference.json").string());
}

void join(const JoinOptions& options) {
    const std::vector<PartFile> parts = read_parts(options.parts);
    if (parts[0].part.command == "reference")
        join_reference(options, parts);
    else
        join_render(options, parts);
}

}  // namespace

void add_join_command(CLI::App& app) {
    auto options = std::make_shared<JoinOptions>();
    CLI::App* command = app.add_subcommand("join", "Put together what several processes made of one run");
    command->add_option("PARTS", options->parts, "states that render or reference left with --passes A..B")->required();
    command->add_option("-o", options->output, "image to write, OpenEXR; of a reference its folder")->required();
    command->add_option("--scene", options->scene, "the scene file, where it is not where the parts had it");
    command->add_option("--reference", options->reference,
                        "folder of a reference, or an EXR: errors are taken against it");
    command->add_option("--csv", options->csv, "records to write");
    command->add_option("--png", options->png, "tone-mapped picture to write");
    command
        ->add_option("--threads", options->threads,
                     "threads to use [what the job may use: SLURM_CPUS_PER_TASK, else the affinity mask]")
        ->check(CLI::Range(1, 1024));
    command->footer(
        "Sums are exact: however the passes were taken apart, the image has the bits of a run that took them all.\n"
        "Example:\n"
        "  photonlab render scenes/cornell-box/scene.xml --schedule knaus-zwicker --passes 1..32 --checkpoint a.ck\n"
        "  photonlab render scenes/cornell-box/scene.xml --schedule knaus-zwicker --passes 33..64 --checkpoint b.ck\n"
        "  photonlab join a.ck b.ck -o box.exr");
    command->callback([options] { join(*options); });
}

}  // namespace photonlab
