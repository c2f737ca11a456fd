// photonlab run: every run of an experiment that is not finished.

#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "app/commands.h"
#include "app/interruption.h"
#include "app/limits.h"
#include "app/options.h"
#include "core/text/messages.h"
#include "experiment/experiment_file.h"
#include "experiment/experiment_runs.h"

namespace photonlab {

namespace {

struct RunOptions {
    std::filesystem::path experiment;
    std::filesystem::path output;
    std::string only;
    bool list = false;
    bool smoke = false;
    ContinuationOptions continuation;
};

/// Throws InputError where what was left out is damaged.
void say_what_was_left_out(const MergedRecords& merged, const std::filesystem::path& records) {
    const std::string others = describe_left_out(merged);
    if (!others.empty()) print_message("photonlab: {}: {}\n", records.string(), others);
    if (!merged.faults.empty())
        throw InputError(
            fmt::format("{}; {} finished runs like this one are not in {}, and are made again by the same command "
                        "without --only",
                        merged.faults[0], merged.faults.size(), records.string()));
}

void run(const RunOptions& options) {
    const Experiment experiment =
        read_experiment(options.experiment, options.smoke ? std::optional(SmokeLimits{}) : std::nullopt);
    const std::filesystem::path results =
        options.output.empty() ? std::filesystem::path("results") / experiment.name : options.output;
    start_threads(experiment.threads);
    const auto only = options.only.empty() ? std::nullopt : std::optional(options.only);
    const PreparedExperiment prepared =
        prepare_experiment(experiment, results, only, options.list ? Check::Sizes : Check::Records);
    for (const std::string& fault : prepared.faults)
        print_message("photonlab: {}; what is damaged is made again\n", fault);
    if (options.list) {
        print_output("{}", list_runs(experiment, prepared));
        return;
    }
    listen_for_interruptions();
    const ExperimentOutcome outcome = run_experiment(experiment, prepared, results, options.continuation);
    print_output("{} runs made, {} were finished already\n", outcome.ran, outcome.skipped);
    if (outcome.merged)
        print_output("wrote {}: {} of {} runs\n", outcome.records.string(), outcome.merged->runs,
                     experiment.runs.size());
    print_output("wrote {}: run.json, iterations.csv and snapshots of each\n", (results / "runs").string());
    if (!outcome.why_not_merged.empty())
        print_message("photonlab: {}: stays as it was, since not all runs can be told: {}\n", outcome.records.string(),
                      outcome.why_not_merged);
    if (outcome.merged) say_what_was_left_out(*outcome.merged, outcome.records);
    if (outcome.is_interrupted) throw Interrupted("interrupted, and saved; the same command goes on from there");
}

}  // namespace

void add_run_command(CLI::App& app) {
    auto options = std::make_shared<RunOptions>();
    options->continuation.is_interrupted = is_interrupted;
    CLI::App* command =
        app.add_subcommand("run", "Run an experiment; finished runs are skipped, interrupted ones continued");
    command->add_option("EXPERIMENT", options->experiment, "experiment file (TOML)")->required();
    command->add_option("-o", options->output, "folder for results [results/EXPERIMENT]")->check(require_folder_name);
    command->add_flag("--list", options->list, "print the runs with an estimate of time and memory, and run nothing");
    command->add_option("--only", options->only, "only runs of this name, or that match this shell pattern");
    const SmokeLimits smoke;
    command->add_flag(
        "--smoke", options->smoke,
        fmt::format("everything in small: at most {} passes, {} photons a pass, {} seeds; into a folder of its own",
                    smoke.passes, smoke.photons_per_pass, smoke.seeds));
    command
        ->add_option("--checkpoint-seconds", options->continuation.seconds_between_saves,
                     fmt::format("work that a kill may cost, or one pass if that takes longer [{:g}]",
                                 options->continuation.seconds_between_saves))
        ->check(require_seconds);
    command->add_flag("--fresh", options->continuation.fresh,
                      "begin unfinished runs anew; their checkpoints are set aside as checkpoint.old");
    command->footer("Example:\n  photonlab run experiments/demo.toml --only '*_ppm_alpha-0.7_*'");
    command->callback([options] { run(*options); });
}

}  // namespace photonlab
