// The program: one subcommand a task. Bad input and bad usage end with one line and exit code 2, an error of the
// program's own with 1.

#include <fmt/format.h>

#include <exception>
#include <filesystem>
#include <string>

#include "app/commands.h"
#include "core/error.h"
#include "experiment/version.h"

namespace {

constexpr int bad_input = 2;
constexpr int internal_error = 1;

int report(const std::string& message, int code) {
    fmt::print(stderr, "photonlab: {}\n", message);
    return code;
}

int run_program(int argc, char** argv) {
    using namespace photonlab;
    CLI::App app("photonlab: a research harness for photon mapping", "photonlab");
    const ProgramVersion program = program_version();
    app.set_version_flag(
        "--version", fmt::format("photonlab {} (commit {}; {})", program.version, program.commit, program.compiler));
    app.require_subcommand(1);
    app.get_formatter()->column_width(34);
    app.footer("photonlab COMMAND --help says more, with an example.");
    add_render_command(app);
    add_run_command(app);
    add_reference_command(app);
    add_compare_command(app);
    add_info_command(app);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() == 0) return app.exit(error);  // --help, --version
        return report(error.what(), bad_input);
    }
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    try {
        return run_program(argc, argv);
    } catch (const photonlab::InputError& error) {
        return report(error.what(), bad_input);
    } catch (const std::filesystem::filesystem_error& error) {
        return report(error.what(), bad_input);
    } catch (const std::exception& error) {
        return report(std::string("internal error: ") + error.what(), internal_error);
    }
}
