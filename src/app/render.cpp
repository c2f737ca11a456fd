// photonlab render: one scene, one method, one image.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <optional>

#include "app/commands.h"
#include "app/interruption.h"
#include "app/limits.h"
#include "app/options.h"
#include "core/files/file_lock.h"
#include "core/files/files.h"
#include "core/machine/processors.h"
#include "core/text/messages.h"
#include "core/text/progress.h"
#include "core/text/text.h"
#include "experiment/experiment_file.h"
#include "experiment/experiment_plan.h"
#include "experiment/run_group.h"
#include "image/image_codecs.h"
#include "integrators/registry.h"
#include "record/columns.h"
#include "record/estimated_error.h"
#include "reference/reference.h"
#include "render/estimates/memory.h"
#include "scene/loader.h"
#include "transport/camera_pass.h"
#include "transport/plain_images.h"

namespace photonlab {

namespace {

struct RenderOptions {
    std::filesystem::path scene;
    std::filesystem::path output;
    MethodOptions method;
    std::uint64_t passes = 32;
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
};

/// Share of the lit pixels that --stop-at wants to be good.
constexpr double share_of_pixels = 0.95;

std::filesystem::path snapshot_file(const std::filesystem::path& output, std::uint64_t pass) {
    return output.parent_path() / fmt::format("{}-pass-{}.exr", output.stem().string(), pass);
}

void print_summary(const RunState& state, const RunSettings& settings, const Scene& scene, std::size_t hit_points,
                   const std::optional<ErrorMetrics>& errors) {
    print_output("{}: {} passes of {}, {} hit points, seed {}\n", scene.name, state.pass, settings.method.integrator,
                 hit_points, settings.seed);
    const auto time_of = [&](Stage stage) { return describe_duration(state.times.of(stage)); };
    print_output("time        {} (CPU {}): trace {}, build {}, gather {}, direct light {}{}\n",
                 describe_duration(state.times.total()), describe_duration(state.times.cpu_total()),
                 time_of(Stage::Trace), time_of(Stage::Build), time_of(Stage::Gather), time_of(Stage::Direct),
                 needs_of(settings.method).new_points ? ", hit points " + time_of(Stage::Points) : "");
    if (state.paths_emitted > 0)
        print_output("photons     {} stored of {} paths, {} gathered\n", state.photons_stored, state.paths_emitted,
                     state.report.photons_gathered);
    if (state.paths_seen)
        print_output("paths       {} traced; of the last pass's {:.3g}% were seen{}\n", state.paths_traced,
                     100.0 * *state.paths_seen,
                     state.mutations_accepted
                         ? fmt::format(", and {:.3g}% of the mutations", 100.0 * *state.mutations_accepted)
                         : "");
    if (state.report.radius_mean && state.initial_radius)
        print_output("radius      {:.6g} at first, {:.6g} at the end (mean over hit points, scene units)\n",
                     *state.initial_radius, *state.report.radius_mean);
    if (state.paths_cut > 0) print_output("cut         {} photon paths ended by the cap on edges\n", state.paths_cut);
    if (errors) {
        print_output("rmse        {}\n", describe_rmse(*errors));
        const std::optional<double> unbiased = errors->of("mse_unbiased");
        if (unbiased)
            print_output("mse         {:.6g}; without the reference's noise {:.6g}\n", *errors->of("mse"), *unbiased);
    }
}

void require_consistent(const RenderOptions& options) {
    std::error_code unknown;  // as of a name that no file can have, which is refused later
    if (options.resume && options.checkpoint.empty())
        throw InputError("--resume: expected --checkpoint FILE as well, where the state to go on from is");
    if (!options.resume && !options.checkpoint.empty() && std::filesystem::exists(options.checkpoint, unknown))
        throw InputError(options.checkpoint,
                         "is there already: --resume goes on from it; to begin anew, remove it or give another file");
}

/// A file that is to be written.
struct WrittenFile {
    std::string option;
    std::filesystem::path file;
    const FileKind* kind;  ///< nullptr: a checkpoint
};

/// What says beside a table what its columns are.
std::filesystem::path columns_file(std::filesystem::path csv) {
    return csv.replace_extension(".columns.json");
}

std::vector<WrittenFile> written_files(const RenderOptions& options, const std::vector<std::uint64_t>& snapshots) {
    const auto& [exr, png, csv] = file_kinds;
    std::vector<WrittenFile> written{{"-o", options.output, &exr}};
    for (const std::uint64_t pass : snapshots)
        written.push_back({"--snapshots", snapshot_file(options.output, pass), &exr});
    if (!options.csv.empty()) {
        written.push_back({"--csv", options.csv, &csv});
        written.push_back({"--csv", columns_file(options.csv), nullptr});
    }
    if (!options.png.empty()) written.push_back({"--png", options.png, &png});
    if (!options.checkpoint.empty()) written.push_back({"--checkpoint", options.checkpoint, nullptr});
    return written;
}

void require_possible_name(const WrittenFile& written) {
    std::error_code error;
    if (std::filesystem::status(written.file, error).type() == std::filesystem::file_type::none)
        throw InputError(written.file.string(), written.option + ": cannot be written: " + error.message());
}

/// What is written must be what its name says. A device is refused as such, later.
void require_name_of_kind(const WrittenFile& written) {
    const FileKind* named = kind_named(written.file.string());
    if (named == written.kind ||
        (std::filesystem::exists(written.file) && !std::filesystem::is_regular_file(written.file)))
        return;
    std::string message = written.kind ? fmt::format("{}: writes {}: expected a name that ends in {}", written.option,
                                                     written.kind->name, written.kind->extension)
                                       : written.option + ": writes the state of the render: expected another name";
    if (named) message += fmt::format("; {} writes {}", named->option, named->name);
    throw InputError(written.file.string(), message);
}

/// Nor must it be what is read, or written twice; nor replace a file of another kind, such as a mesh of the scene.
void require_sound_outputs(const RenderOptions& options, const std::vector<std::uint64_t>& snapshots) {
    constexpr const char* input = "";  // in place of an option
    std::map<std::filesystem::path, std::string> taken;
    const auto take = [&](const std::filesystem::path& file, const std::string& by) {
        std::error_code unknown;
        const std::filesystem::path canonical = std::filesystem::weakly_canonical(file, unknown);
        return taken.try_emplace(unknown ? file : canonical, by);
    };
    take(options.scene, input);
    if (const std::filesystem::path reference = options.reference; !reference.empty())
        for (const auto& file : {reference, reference / "half_a.exr", reference / "half_b.exr"}) take(file, input);
    for (const WrittenFile& written : written_files(options, snapshots)) {
        const auto& [option, file, kind] = written;
        require_possible_name(written);
        if (const auto [at, is_new] = take(file, option); !is_new)
            throw InputError(file.string(),
                             option + ": is " +
                                 (at->second == input ? "read from here" : "written by " + at->second + " already") +
                                 "; choose another file");
        if (kind && std::filesystem::is_regular_file(file)) {
            std::string found(kind->begins.size(), '\0');
            std::ifstream stream(file, std::ios::binary);
            stream.read(found.data(), static_cast<std::streamsize>(found.size()));
            if (stream.gcount() > 0 && found != kind->begins)
                throw InputError(file.string(), option + ": is there already, and is a file of another kind");
        }
        require_name_of_kind(written);
    }
}

/// The passes whose image is wanted, in order.
std::vector<std::uint64_t> snapshots_of(const RenderOptions& options) {
    std::vector<std::uint64_t> snapshots = options.snapshots;
    std::sort(snapshots.begin(), snapshots.end());
    snapshots.erase(std::unique(snapshots.begin(), snapshots.end()), snapshots.end());
    if (!snapshots.empty() && snapshots.back() > options.passes)
        throw InputError(fmt::format("--snapshots: pass {} is beyond the last, {}", snapshots.back(), options.passes));
    return snapshots;
}

/// The experiment of one run that a render is.
Experiment experiment_of(const RenderOptions& options, const ChosenSettings& settings, const Scene& scene,
                         const std::vector<std::uint64_t>& snapshots) {
    ExperimentRun run;
    run.name = run.point = "render";
    run.method = settings.values.integrator;
    run.settings = settings;
    run.plan = {options.passes, options.csv.empty() ? std::vector{options.passes} : powers_of_two(options.passes),
                snapshots};
    if (snapshots.empty() || snapshots.back() != options.passes) run.plan.snapshots.push_back(options.passes);
    run.seed = options.seed;

    SceneEntry entry;
    entry.file = options.scene;
    entry.name = valid_text(scene.name);
    entry.samples_per_pixel = options.samples_per_pixel;

    Experiment experiment;
    experiment.file = options.scene;
    experiment.name = experiment.title = "render";
    experiment.scenes = {std::move(entry)};
    experiment.runs = {std::move(run)};
    experiment.threads = options.threads;
    return experiment;
}

/// Before hours are spent: everything that is to be written can be.
void require_room_for(const RenderOptions& options, const std::vector<std::uint64_t>& snapshots, const Scene& scene) {
    require_sound_outputs(options, snapshots);
    for (const WrittenFile& written : written_files(options, snapshots)) require_writable(written.file);
    if (!options.png.empty()) image_codecs();  // so large that there may be no room for them in memory
    const auto pixels =
        static_cast<std::uint64_t>(scene.camera.width) * static_cast<std::uint64_t>(scene.camera.height);
    require_space(options.output.parent_path(), 4 * sizeof(Color) * pixels * (1 + snapshots.size()),
                  "what this render writes");
}

RunFiles files_of(const RenderOptions& options, const std::string& key) {
    RunFiles files;
    files.rows = options.csv;
    files.snapshot = [&options](std::uint64_t pass) {
        return pass == options.passes ? options.output : snapshot_file(options.output, pass);
    };
    files.picture = options.png;
    files.checkpoint = {options.checkpoint, key + (options.csv.empty() ? "" : ", with rows"),
                        "remove it, or begin anew beside it with another --checkpoint"};
    return files;
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
        print_message("photonlab: {} is not there: beginning at pass 1\n", options.checkpoint);
    listen_for_interruptions();
    Progress progress(options.passes);
    const GroupOutcome outcome = run_group(group,
                                           {.seconds_between_saves = options.checkpoint_seconds,
                                            .is_interrupted = is_interrupted,
                                            .is_good_enough = good_enough(options)},
                                           [&](std::uint64_t pass, bool is_new) {
                                               if (!is_new) progress.skip(pass);
                                               progress.show(pass, fmt::format("pass {} of {}", pass, options.passes));
                                           });
    progress.clear();
    if (!outcome.is_finished)
        throw Interrupted(fmt::format("interrupted after pass {} of {}; {}", outcome.passes, options.passes,
                                      options.checkpoint.empty()
                                          ? "nothing is saved without --checkpoint FILE"
                                          : options.checkpoint + " is saved, and --resume goes on from it"));
    return outcome.runs.at(0);
}

/// `last`: the pass that it ended with.
void print_written(const RenderOptions& options, const std::vector<std::uint64_t>& snapshots, std::uint64_t last) {
    print_output("wrote       {}\n", options.output.string());
    for (const std::string& file : {options.png, options.csv})
        if (!file.empty()) print_output("wrote       {}\n", file);
    if (!options.csv.empty()) print_output("wrote       {}\n", columns_file(options.csv).string());
    for (const std::uint64_t pass : snapshots)
        if (pass <= last) print_output("wrote       {}\n", snapshot_file(options.output, pass).string());
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
    const ExperimentRun& run = experiment.runs[0];
    PreparedRun prepared{&run, settings_of(experiment, run, scene)};
    check_options([&] { require_resolvable(prepared.settings.method, scene); });
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
        throw InputError(options.checkpoint, "another process is rendering with this checkpoint");
    const HitPoints hit_points =
        trace_hit_points(scene, options.samples_per_pixel, options.threads, prepared.settings.method.branch_cutoff);
    prepared.reference_key = reference ? reference->key : "";
    prepared.point_key = point_key(experiment, run, prepared.settings, scene, prepared.reference_key);
    prepared.key = run_key(prepared.point_key, run);
    prepared.files = files_of(options, prepared.key);
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
    if (options.stop_at)
        print_output("stop        {}\n",
                     finished.state.pass < options.passes
                         ? fmt::format("{:g}% of the lit pixels are within {:g} with confidence {:g}, as far as is "
                                       "estimated",
                                       100.0 * share_of_pixels, *options.stop_at, options.confidence)
                         : "not before the last pass");
    print_written(options, snapshots, finished.state.pass);
}

}  // namespace

void add_render_command(CLI::App& app) {
    auto options = std::make_shared<RenderOptions>();
    CLI::App* command = app.add_subcommand("render", "Render one scene with one method");
    command->add_option("SCENE", options->scene, "scene file (Mitsuba XML)")->required();
    command->add_option("-o", options->output, "image to write: linear float RGB and layers, OpenEXR")->required();
    options->method.add_to(*command);
    command->add_option("--passes", options->passes, fmt::format("number of passes [{}]", options->passes))
        ->check(CLI::Range(1u, 0xffffffffu));
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
    command->callback([options] { render(*options); });
}

}  // namespace photonlab
