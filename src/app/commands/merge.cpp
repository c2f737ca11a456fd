// photonlab merge: the records of a results folder from those of its runs, once many jobs have made them.

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <optional>

#include "app/commands/commands.h"
#include "app/interruption.h"
#include "app/options.h"
#include "core/text/messages.h"
#include "experiment/experiment_plan.h"
#include "experiment/experiment_runs.h"
#include "experiment/results_folder.h"

namespace photonlab {

void say_what_was_left_out(const MergedRecords& merged, const std::filesystem::path& records) {
    const std::string others = describe_left_out(merged);
    if (!others.empty()) print_message("photonlab: {}: {}\n", records.string(), others);
    if (!merged.faults.empty())
        throw InputError(
            fmt::format("{}; {} finished runs like this one are not in {}, and are made again by `photonlab run` "
                        "without --only",
                        merged.faults[0], merged.faults.size(), records.string()));
}

namespace {

struct MergeOptions {
    std::filesystem::path results;
    std::filesystem::path experiment;
};

void merge(const MergeOptions& options) {
    const std::filesystem::path& results = options.results;
    const Experiment experiment = read_experiment_of_results(
        results, options.experiment.empty() ? std::nullopt : std::optional(options.experiment));
    const PreparedExperiment all = prepare_all_keys(experiment, results);
    listen_for_interruptions();
    const std::optional<MergedRecords> merged = merge_experiment(experiment, all, results, is_interrupted);
    if (!merged) throw Interrupted("interrupted while another process was merging; nothing is changed");
    const std::filesystem::path records = results / "iterations.csv";
    print_output("wrote {}: {} of {} runs\n", records.string(), merged->runs, experiment.run_count());
    say_what_was_left_out(*merged, records);
}

}  // namespace

void add_merge_command(CLI::App& app) {
    auto options = std::make_shared<MergeOptions>();
    CLI::App* command = app.add_subcommand(
        "merge", "Merge the records of all finished runs of a results folder, as `run` does at its end");
    command->add_option("RESULTS", options->results, "folder of an experiment's results")->required();
    command->add_option("--experiment", options->experiment,
                        "experiment file, where it is not where RESULTS/experiment.json says");
    command->footer("Example:\n  photonlab merge results/demo");
    command->callback([options] { merge(*options); });
}

}  // namespace photonlab
