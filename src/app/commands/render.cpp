// photonlab render: one scene, one method, one image.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <optional>

#include "app/commands/commands.h"
#include "app/interruption.h"
#include "app/limits.h"
#include "app/options.h"
#include "app/summary.h"
#include "app/written_files.h"
#include "core/files/file_lock.h"
#include "core/files/files.h"
#include "core/machine/processors.h"
#include "core/text/messages.h"
#include "core/text/progress.h"
#include "core/text/text.h"
#include "experiment/experiment_plan.h"
#include "experiment/file/experiment_file.h"
#include "experiment/run_group.h"
#include "integrators/registry.h"
#include "record/columns.h"
#include "record/images/estimated_error.h"
#include "record/images/point_clouds.h"
#include "record/run/part.h"
#include "reference/reference.h"
#include "render/estimates/memory.h"
#include "scene/loader.h"
#include "transport/camera/camera_pass.h"
#include "transport/camera/plain_images.h"

namespace photonlab {

namespace {

struct RenderOptions {
    std::filesystem::path scene;
    std::filesystem::path output;
    MethodOptions method;
    std::string passes_text = "32";
    PassesOption passes;
    std::string emission_from;
    std::uint64_t seed = 1;
    int threads = usable_processors();
    std::string resolution;
    SceneParameters parameters;
    int samples_per_pixel = 1;
    std::string reference;
    std::string csv;
    std::string png;
    std::vector<std::uint64_t> snapshots;
    std::string checkpoint;
    double checkpoint_seconds = default_seconds_between_saves;
    bool resume = false;
    std::optional<double> stop_at;
    double confidence = 0.9;
    bool statistics = false;
    std::string photons_out;
    std::string hit_points_out;
    std::uint64_t most_points = 100'000;  ///< in each of these files
};

/// Share of the lit pixels that --stop-at wants to be good.
constexpr double share_of_pixels = 0.95;

std::filesystem::path snapshot_file(const std::filesystem::path& output, std::uint64_t pass) {
    return output.parent_path() / fmt::format("{}-pass-{}.exr", output.stem().string(), pass);
}

void require_consistent(const RenderOptions& options) {
    std::error_code unknown;  // as of a name that no file can have, which is refused later
    if (options.resume && options.checkpoint.empty())
        throw InputError("--resume: expected --checkpoint FILE as well, where the state to go on from is");
    if (!options.resume && !options.checkpoint.empty() && std::filesystem::exists(options.checkpoint, unknown))
        throw InputError(options.checkpoint,
                         "is there already: --resume goes on from it; to begin anew, remove it or give another file");
    if (options.passes.is_part && options.checkpoint.empty())
        throw InputError(fmt::format("--passes {}: expected --checkpoint FILE as well, to be joined with other passes",
                                     describe(options.passes.range)));
    if (!options.passes.is_part && options.output.empty()) throw InputError("-o is required");
}

std::vector<WrittenFile> written_files(const RenderOptions& options, const std::vector<std::uint64_t>& snapshots) {
    const auto& [exr, png, csv, ply] = file_kinds;
    std::vector<WrittenFile> written;
    if (!options.output.empty()) written.push_back({"-o", options.output, &exr});
    for (const std::uint64_t pass : snapshots)
        written.push_back({"--snapshots", snapshot_file(options.output, pass), &exr});
    if (!options.csv.empty()) {
        written.push_back({"--csv", options.csv, &csv});
        written.push_back({"--csv", columns_file(options.csv), nullptr});
    }
    if (!options.png.empty()) written.push_back({"--png", options.png, &png});
    if (!options.photons_out.empty()) written.push_back({"--photons-out", options.photons_out, &ply});
    if (!options.hit_points_out.empty()) written.push_back({"--hit-points-out", options.hit_points_out, &ply});
    if (!options.checkpoint.empty()) written.push_back({"--checkpoint", options.checkpoint, nullptr});
    return written;
}

/// The passes whose image is wanted, in order.
std::vector<std::uint64_t> snapshots_of(const RenderOptions& options) {
    std::vector<std::uint64_t> snapshots = options.snapshots;
    std::sort(snapshots.begin(), snapshots.end());
    snapshots.erase(std::unique(snapshots.begin(), snapshots.end()), snapshots.end());
    const auto& [passes, is_part] = options.passes;
    if (!snapshots.empty() && snapshots.back() > passes.last)
        throw InputError(fmt::format("--snapshots: pass {} is beyond the last, {}", snapshots.back(), passes.last));
    if (!snapshots.empty() && is_part && snapshots.front() < passes.first)
        throw InputError(fmt::format("--snapshots: pass {} is before the first, {}", snapshots.front(), passes.first));
    if (!snapshots.empty() && options.output.empty()) throw InputError("--snapshots: expected -o OUT.exr as well");
    return snapshots;
}

/// The experiment of one run that a render is.
Experiment experiment_of(const RenderOptions& options, const ChosenSettings& settings, const Scene& scene,
                         const std::vector<std::uint64_t>& snapshots) {
    ExperimentPoint point;
    point.name = "render";
    point.method = settings.values.integrator;
    point.settings = settings;
    const std::uint64_t last = options.passes.range.last;
    const bool records_last_alone = options.csv.empty() || options.passes.is_part;
    point.plan = {last, records_last_alone ? std::vector{last} : powers_of_two(last), snapshots};
    if (!options.output.empty() && (snapshots.empty() || snapshots.back() != last))
        point.plan.snapshots.push_back(last);

    SceneEntry entry;
    entry.file = options.scene;
    entry.name = valid_text(scene.name);
    entry.samples_per_pixel = options.samples_per_pixel;

    Experiment experiment;
    experiment.file = options.scene;
    experiment.name = experiment.title = "render";
    experiment.scenes = {std::move(entry)};
    experiment.points = {std::move(point)};
    experiment.seeds = {options.seed};
    experiment.threads = options.threads;
    return experiment;
}

/// Before hours are spent: everything that is to be written can be.
void require_room_for(const RenderOptions& options, const std::vector<std::uint64_t>& snapshots, const Scene& scene) {
    std::vector<std::filesystem::path> inputs = files_of_reference(options.reference);
    inputs.push_back(options.scene);
    const std::vector<WrittenFile> written = written_files(options, snapshots);
    require_sound_outputs(inputs, written);
    const auto pixels =
        static_cast<std::uint64_t>(scene.camera.width) * static_cast<std::uint64_t>(scene.camera.height);
    require_space(options.output.parent_path(), 4 * sizeof(Color) * pixels * (1 + snapshots.size()),
                  "what this render writes");
}

RunFiles files_of(const RenderOptions& options, const std::string& key) {
    RunFiles files;
    files.rows = options.csv;
    files.snapshot = [&options](std::uint64_t pass) {
        return pass == options.passes.range.last ? options.output : snapshot_file(options.output, pass);
    };
    files.picture = options.png;
    files.checkpoint = {options.checkpoint, key + (options.csv.empty() ? "" : ", with rows"),
                        "remove it, or begin anew beside it with another --checkpoint"};
    return files;
}

RunPart part_of(const RenderOptions& options, const Scene& scene, const RunSettings& settings) {
    return {.command = "render",
            .scene_file = std::filesystem::absolute(options.scene),
            .parameters = options.parameters.values(),
            .scene_hash = scene.hash,
            .width = scene.camera.width,
            .height = scene.camera.height,
            .samples_per_pixel = options.samples_per_pixel,
            .settings = settings.method,
            .seed = settings.seed,
            .passes = options.passes.range};
}

/// The emission that the passes in `--emission-from` learnt, which those of this part go by.
void take_learnt_emission(const RenderOptions& options, const Scene& scene, const HitPoints& hit_points,
                          PreparedRun& prepared) {
    const bool is_needed = needs_of(prepared.settings.method).passes == Needs::Passes::AfterLearning &&
                           options.passes.is_part && options.passes.range.first > 1;
    if (!is_needed && !options.emission_from.empty())
        throw InputError(
            "--emission-from: expected emission adaptive, and --passes A..B after those that it learns in");
    if (!is_needed) return;
    if (options.emission_from.empty())
        throw InputError(fmt::format("--passes {}: expected --emission-from FILE as well, the --checkpoint of 1..{}",
                                     describe(options.passes.range), prepared.settings.method.learn_passes));
    const PartFile learnt = read_part(options.emission_from);
    require_same_run({prepared.files.checkpoint, part_of(options, scene, prepared.settings)}, learnt);
    PassLoop loop(scene, hit_points, {prepared.settings});
    load_part(learnt, loop);
    prepared.settings.learnt = loop.state_now(0).emission_map;
}

/// Where a range of passes is asked for, makes the run one of these, whose state stays. False when they are made
/// already.
bool take_part(const RenderOptions& options, const Scene& scene, const HitPoints& hit_points, PreparedRun& prepared) {
    const auto& [passes, is_part] = options.passes;
    if (is_part) {
        const RunPart part = part_of(options, scene, prepared.settings);
        require_separable(part.settings, passes);
        prepared.settings.first_pass = passes.first;
        prepared.files.checkpoint = checkpoint_of(part, options.checkpoint);
        prepared.files.keeps_state = true;
        if (options.resume && is_whole(prepared.files.checkpoint, passes)) {
            print_output("{} has passes {} already\n", options.checkpoint, describe(passes));
            return false;
        }
    }
    take_learnt_emission(options, scene, hit_points, prepared);
    return true;
}

std::function<bool(const Image&)> good_enough(const RenderOptions& options) {
    if (!options.stop_at) return {};
    return [&options](const Image& image) {
        return image.estimated_error && share_within(*image.estimated_error, *image.find(gathered_layer),
                                                     *options.stop_at, options.confidence) >= share_of_pixels;
    };
}

/// Makes the run with a progress line. Throws Interrupted when it was.
FinishedRunState make_run(const RenderOptions& options, const RunGroup& group) {
    if (options.resume && !std::filesystem::exists(options.checkpoint))
        print_message("photonlab: {} is not there: beginning at pass {}\n", options.checkpoint,
                      options.passes.range.first);
    listen_for_interruptions();
    const PassRange& passes = options.passes.range;
    Progress progress(passes.count());
    const GroupOutcome outcome = run_group(group,
                                           {.seconds_between_saves = options.checkpoint_seconds,
                                            .is_interrupted = is_interrupted,
                                            .is_good_enough = good_enough(options)},
                                           [&](std::uint64_t pass, bool is_new) {
                                               const std::uint64_t done = pass - passes.first + 1;
                                               if (!is_new) progress.skip(done);
                                               progress.show(done, fmt::format("pass {} of {}", pass, passes.last));
                                           });
    progress.clear();
    if (!outcome.is_finished)
        throw Interrupted(fmt::format("interrupted after pass {} of {}; {}", outcome.passes, passes.last,
                                      options.checkpoint.empty()
                                          ? "nothing is saved without --checkpoint FILE"
                                          : options.checkpoint + " is saved, and --resume goes on from it"));
    return outcome.runs.at(0);
}

/// `last`: the pass that it ended with.
void print_written(const RenderOptions& options, const std::vector<std::uint64_t>& snapshots, std::uint64_t last) {
    const std::string part = options.passes.is_part ? options.checkpoint : "";
    for (const std::string& file :
         {options.output.string(), part, options.png, options.csv, options.photons_out, options.hit_points_out})
        if (!file.empty()) print_output("wrote       {}\n", file);
    if (!options.csv.empty()) print_output("wrote       {}\n", columns_file(options.csv).string());
    for (const std::uint64_t pass : snapshots)
        if (pass <= last) print_output("wrote       {}\n", snapshot_file(options.output, pass).string());
}

/// Photons that follow from where they are gathered, or from what was learnt, are not those of any pass by itself.
void require_photons_to_show(const RenderOptions& options, const MethodSettings& method) {
    if (options.photons_out.empty()) return;
    const Needs needs = needs_of(method);
    if (needs.photons == Needs::Photons::None || needs.has_own_photons)
        throw InputError(fmt::format(
            "--photons-out: expected a method with photons of plain emission, of independent paths; got {}{}",
            method.integrator, needs.has_own_photons ? ", whose photons are its own" : ""));
}

/// The photons of the first pass, traced once more, and the hit points.
void write_point_clouds(const RenderOptions& options, const Scene& scene, const RunSettings& settings,
                        const HitPoints& hit_points) {
    const auto most = static_cast<std::size_t>(options.most_points);
    if (!options.photons_out.empty())
        write_text_file(
            options.photons_out,
            photons_as_ply(scene, trace_photons(scene, photon_settings(settings), 1, settings.threads), most));
    if (!options.hit_points_out.empty())
        write_text_file(options.hit_points_out, hit_points_as_ply(scene, hit_points, most));
}

/// `last`: the pass that it ended with.
void print_stop(const RenderOptions& options, std::uint64_t last) {
    print_output("stop        {}\n",
                 last < options.passes.range.last
                     ? fmt::format("{:g}% of the lit pixels are within {:g} with confidence {:g}, as far as is "
                                   "estimated",
                                   100.0 * share_of_pixels, *options.stop_at, options.confidence)
                     : "not before the last pass");
}

void render(const RenderOptions& options) {
    require_consistent(options);
    const ChosenSettings chosen = options.method.settings();
    if (options.stop_at &&
        (!uses_setting(chosen.values, "estimate_error") || chosen.values.estimate_error == ErrorEstimation::Off))
        throw InputError("--stop-at: expected --estimate-error on, and a method that has it");
    check_options([&] { require_perfect_square(options.samples_per_pixel); });
    const std::vector<std::uint64_t> snapshots = snapshots_of(options);
    std::optional<Resolution> resolution;
    if (!options.resolution.empty()) resolution = parse_resolution(options.resolution);

    start_threads(options.threads);
    const Scene scene = build_scene(load_scene_file(options.scene, options.parameters.values()), resolution);
    const Experiment experiment = experiment_of(options, chosen, scene, snapshots);
    const ExperimentPoint& point = experiment.points[0];
    const ExperimentRun run{point.name, &point, options.seed};
    PreparedRun prepared{run, settings_of(experiment, run, scene)};
    prepared.settings.shows_counts = options.statistics;
    check_options([&] { require_renderable(prepared.settings.method, scene); });
    require_photons_to_show(options, prepared.settings.method);
    std::optional<Reference> reference;
    if (!options.reference.empty())
        reference =
            load_reference(options.reference, subject_of(scene, options.samples_per_pixel, prepared.settings.method));
    require_room_for(options, snapshots, scene);

    const MemoryEstimate memory = MemoryEstimator(scene, options.samples_per_pixel).of({prepared.settings}, 0);
    require_memory(options.scene.string(), memory);
    print_output("memory      {}\n", describe(memory));

    const auto lock = options.checkpoint.empty() ? std::nullopt : FileLock::try_lock(options.checkpoint + ".lock");
    if (!options.checkpoint.empty() && !lock)
        throw HeldElsewhere(options.checkpoint, "another process is rendering with this checkpoint");
    const HitPoints hit_points =
        trace_hit_points(scene, options.samples_per_pixel, options.threads, prepared.settings.method.branch_cutoff);
    prepared.reference_key = reference ? reference->key : "";
    prepared.point_key = point_key(experiment, point, prepared.settings, scene, prepared.reference_key);
    prepared.key = run_key(prepared.point_key, run);
    prepared.files = files_of(options, prepared.key);
    if (!take_part(options, scene, hit_points, prepared)) return;
    write_point_clouds(options, scene, prepared.settings, hit_points);
    const FinishedRunState finished =
        make_run(options, {experiment, scene, hit_points, reference ? &*reference : nullptr, {}, {&prepared}});
    if (!options.csv.empty()) write_columns(columns_file(options.csv));
    if (std::binary_search(snapshots.begin(), snapshots.end(), finished.state.pass))
        write_text_file(snapshot_file(options.output, finished.state.pass), read_text_file(options.output));

    print_summary(finished.state, prepared.settings, scene, hit_points.points.size(), finished.errors);
    for (const std::string& reason : why_images_are_plain(scene, hit_points)) print_output("note        {}\n", reason);
    if (const auto note = note_of_raised_radii(prepared.settings.method, scene, hit_points))
        print_output("note        {}\n", *note);
    if (const auto warning = reference ? warning_about(*reference) : std::nullopt)
        print_output("note        {}\n", *warning);
    if (options.stop_at) print_stop(options, finished.state.pass);
    print_written(options, snapshots, finished.state.pass);
}

}  // namespace

void add_render_command(CLI::App& app) {
    auto options = std::make_shared<RenderOptions>();
    CLI::App* command = app.add_subcommand("render", "Render one scene with one method");
    command->add_option("SCENE", options->scene, "scene file (Mitsuba XML)")->required();
    command->add_option("-o", options->output, "image to write: linear float RGB and layers, OpenEXR");
    options->method.add_to(*command);
    command->add_option("--passes", options->passes_text,
                        fmt::format("how many; or a range of them, A..B, whose state stays in --checkpoint for "
                                    "photonlab join [{}]",
                                    options->passes_text));
    command->add_option("--emission-from", options->emission_from,
                        "with --passes A..B and emission adaptive: --checkpoint of the passes that it learnt in");
    command
        ->add_option("--stop-at", options->stop_at,
                     "ends when 95% of the lit pixels of the gathered light are within this relative error, as far as "
                     "--estimate-error on knows")
        ->check(CLI::PositiveNumber);
    command
        ->add_option("--confidence", options->confidence,
                     fmt::format("with which --stop-at asks for it, in (0, 1) [{:g}]", options->confidence))
        ->check(CLI::Range(1e-6, 1.0 - 1e-6));
    command->add_option("--seed", options->seed, fmt::format("of all random numbers [{}]", options->seed))
        ->check(require_whole_number);
    command
        ->add_option("--threads", options->threads,
                     "threads to use [what the job may use: SLURM_CPUS_PER_TASK, else the affinity mask]; the image "
                     "does not depend on it")
        ->check(CLI::Range(1, 1024));
    options->parameters.add_to(*command);
    command->add_option("--resolution", options->resolution, "WIDTHxHEIGHT in place of the scene file's");
    command->add_option("--samples-per-pixel", options->samples_per_pixel,
                        fmt::format("sample positions, a perfect square [{}]", options->samples_per_pixel));
    command->add_option("--reference", options->reference,
                        "folder of a reference, or an EXR: errors are taken against it");
    command->add_option("--csv", options->csv, "records to write, at passes 0, 1, 2, 4, ... and the last");
    command->add_option("--png", options->png, "tone-mapped picture to write");
    command->add_option("--snapshots", options->snapshots, "passes whose image is kept as OUT-pass-N.exr: 0,1,5,10")
        ->delimiter(',');
    command->add_flag(
        "--statistics", options->statistics,
        "images have what was gathered beside the radius: the channels count, and where it is known density");
    command->add_option("--photons-out", options->photons_out,
                        "photons of the first pass to write as a point cloud: place, direction, power, caustic (PLY)");
    command->add_option("--hit-points-out", options->hit_points_out, "the same of hit points: place, normal, pixel");
    command
        ->add_option("--most-points", options->most_points,
                     fmt::format("in a point cloud; of more a sample is written [{}]", options->most_points))
        ->check(require_whole_number);
    command->add_option("--checkpoint", options->checkpoint,
                        "file to keep the state in while rendering, so that a kill costs half a minute at most");
    command
        ->add_option("--checkpoint-seconds", options->checkpoint_seconds,
                     fmt::format("work that a kill may cost, or one pass if that takes longer [{:g}]",
                                 options->checkpoint_seconds))
        ->check(require_seconds);
    command->add_flag("--resume", options->resume, "go on from the checkpoint, if it is there, to the same bits");
    command->footer(
        "Example:\n  photonlab render scenes/cornell-box/scene.xml -o box.exr --integrator ppm --passes 64 "
        "--alpha 0.7 --png box.png");
    command->callback([options] {
        options->passes = parse_passes(options->passes_text);
        render(*options);
    });
}

}  // namespace photonlab
