// photonlab run: every run of an experiment that is not finished.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "app/commands/commands.h"
#include "app/interruption.h"
#include "app/limits.h"
#include "app/options.h"
#include "core/files/file_lock.h"
#include "core/text/messages.h"
#include "core/text/number_in.h"
#include "experiment/experiment_runs.h"
#include "experiment/file/experiment_file.h"
#include "experiment/run_list.h"

namespace photonlab {

namespace {

struct RunOptions {
    std::filesystem::path experiment;
    std::filesystem::path output;
    std::string only;
    std::string groups;
    bool list = false;
    bool as_json = false;
    bool smoke = false;
    ContinuationOptions continuation;
};

/// "3", or "3-8".
GroupRange parse_groups(const std::string& text) {
    const std::size_t dash = std::min(text.find('-'), text.size());
    const auto first = number_in<std::size_t>(std::string_view(text).substr(0, dash));
    const auto last = dash < text.size() ? number_in<std::size_t>(std::string_view(text).substr(dash + 1)) : first;
    if (!first || !last || *first < 1 || *last < *first)
        throw InputError(fmt::format("--group: expected a group, as 3, or a range of them, as 3-8, got {}", text));
    return {*first, *last};
}

RunSelection selection_of(const RunOptions& options) {
    RunSelection selection;
    if (!options.only.empty()) selection.name = options.only;
    if (!options.groups.empty()) selection.groups = parse_groups(options.groups);
    return selection;
}

void require_consistent(const RunOptions& options) {
    if (options.as_json && !options.list) throw InputError("--json: expected --list beside it");
    if (options.list && options.continuation.is_part) throw InputError("--no-merge: --list merges nothing");
}

void print_outcome(const ExperimentOutcome& outcome, const Experiment& experiment,
                   const std::filesystem::path& results) {
    print_output("{} runs made, {} were finished already\n", outcome.ran, outcome.skipped);
    if (outcome.merged)
        print_output("wrote {}: {} of {} runs\n", outcome.records.string(), outcome.merged->runs,
                     experiment.run_count());
    print_output("wrote {}: run.json, iterations.csv and snapshots of each\n", (results / "runs").string());
    if (!outcome.why_not_merged.empty())
        print_message("photonlab: {}: stays as it was, since not all runs can be told: {}\n", outcome.records.string(),
                      outcome.why_not_merged);
    if (outcome.merged) say_what_was_left_out(*outcome.merged, outcome.records);
    if (outcome.is_interrupted) throw Interrupted("interrupted, and saved; the same command goes on from there");
    if (!outcome.held.empty())
        throw HeldElsewhere(fmt::format("{} runs were left to other processes, which are making them, the first {}",
                                        outcome.held.size(), outcome.held[0]));
}

void run(const RunOptions& options) {
    require_consistent(options);
    const RunSelection selection = selection_of(options);
    const Experiment experiment =
        read_experiment(options.experiment, options.smoke ? std::optional(SmokeLimits{}) : std::nullopt);
    const std::filesystem::path results =
        options.output.empty() ? std::filesystem::path("results") / experiment.name : options.output;
    start_threads(experiment.threads);
    const PreparedExperiment prepared =
        prepare_experiment(experiment, results, selection, options.list ? Check::Sizes : Check::Records);
    for (const std::string& fault : prepared.faults)
        print_message("photonlab: {}; what is damaged is made again\n", fault);
    if (options.list) {
        print_output("{}", options.as_json ? list_runs_json(experiment, prepared) : list_runs(experiment, prepared));
        return;
    }
    listen_for_interruptions();
    print_outcome(run_experiment(experiment, prepared, results, options.continuation), experiment, results);
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
    command->add_flag("--json", options->as_json,
                      "of --list: each group and each run as a line of JSON, for what hands them out");
    command->add_option("--only", options->only, "only runs of this name, or that match this shell pattern");
    command->add_option("--group", options->groups,
                        "only a group, a scene and a seed whose runs share photons, or a range of them: 3, or 3-8");
    command->add_flag("--no-merge", options->continuation.is_part,
                      "as one job of many: opens no files but those of its runs, merges nothing, and leaves what "
                      "another process is making to it, with exit code 4");
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
