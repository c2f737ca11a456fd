#include "app/commands/commands.h"

#include <fmt/format.h>

#include "core/machine/version.h"

namespace photonlab {

void add_commands(CLI::App& app) {
    const ProgramVersion program = program_version();
    app.set_version_flag(
        "--version", fmt::format("photonlab {} (commit {}; {})", program.version, program.commit, program.compiler));
    app.require_subcommand(1);
    app.get_formatter()->column_width(34);
    app.footer(
        "photonlab help COMMAND says more, with an example.\n\n"
        "Exit codes: 0 done; 1 an error of the program's own; 2 input that cannot be used, or files that cannot be\n"
        "written; 3 ended by SIGINT or SIGTERM after the pass it was at, and saved, to be continued by the same "
        "command\n(a second signal ends at once); 4 left to another process, which is making what was asked for.");
    add_new_command(app);
    add_render_command(app);
    add_run_command(app);
    add_join_command(app);
    add_analysis_commands(app);
    add_reference_command(app);
    add_compare_command(app);
    add_info_command(app);
    add_merge_command(app);
    add_verify_command(app);
}

}  // namespace photonlab
