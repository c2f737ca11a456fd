// photonlab verify: whether a results folder is what was written.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>

#include "app/commands/commands.h"
#include "core/error.h"
#include "core/text/messages.h"
#include "experiment/verify_results.h"

namespace photonlab {

namespace {

/// Names of files can hold line ends.
void print_line(std::string line) {
    std::replace(line.begin(), line.end(), '\n', ' ');
    print_output("{}\n", line);
}

void verify(const std::filesystem::path& results) {
    const Verification found = verify_results(results);
    for (const std::string& fault : found.faults) print_line(fault);
    for (const std::string& note : found.notes) print_line("note: " + note);
    if (!found.faults.empty()) throw InputError(results.string(), fmt::format("{} faults", found.faults.size()));
    print_output("{}: {} finished runs and {} sums over seeds, {} files in all: as they were written\n",
                 results.string(), found.runs, found.sums, found.files);
}

}  // namespace

void add_verify_command(CLI::App& app) {
    auto results = std::make_shared<std::filesystem::path>();
    CLI::App* command = app.add_subcommand(
        "verify", "Check every file of a results folder: one line a fault, and exit code 2 when there is any");
    command->add_option("RESULTS", *results, "folder of an experiment's results")->required();
    command->footer("Example:\n  photonlab verify results/demo");
    command->callback([results] { verify(*results); });
}

}  // namespace photonlab
