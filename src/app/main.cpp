// The program: one subcommand a task. Bad input and bad usage end with one line and exit code 2, an error of the
// program's own with 1, an interruption with 3.

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <string>

#include "app/commands.h"
#include "app/interruption.h"
#include "core/error.h"
#include "core/files.h"
#include "experiment/version.h"

namespace {

constexpr int bad_input = 2;
constexpr int internal_error = 1;

/// One line that any terminal can show, however hostile the file that a message quotes: control characters become
/// spaces, what is no UTF-8 question marks, and of more than 2000 bytes the middle is left out.
std::string one_line(std::string text) {
    constexpr std::size_t longest = 2000;
    if (text.size() > longest) text.replace(longest / 2, text.size() - longest, " ... ");
    std::replace_if(
        text.begin(), text.end(), [](unsigned char c) { return c < 0x20 || c == 0x7f; }, ' ');
    // Control characters of two bytes, U+0080 to U+009F.
    for (std::size_t i = 0; i + 1 < text.size(); ++i)
        if (text[i] == '\xc2' && static_cast<unsigned char>(text[i + 1]) < 0xa0) text.replace(i, 2, "  ");
    for (std::size_t at = 0; (at = photonlab::find_no_text(text)) != std::string::npos;) text[at] = '?';
    return text;
}

/// OpenMP's threads spin while they wait, which takes processor time from those that work and from other programs (two
/// threads: 1.6 times as fast as one with it, 1.8 without). The environment says otherwise, but is read before main():
/// so the program starts once more.
void start_with_passive_waiting(char** argv) {
    constexpr const char* policy = "OMP_WAIT_POLICY";
    if (std::getenv(policy)) return;
    if (::setenv(policy, "passive", 0) == 0) ::execv("/proc/self/exe", argv);  // where that fails, it goes on as it is
}

int report(const std::string& message, int code) {
    fmt::print(stderr, "photonlab: {}\n", one_line(message));
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
    app.footer(
        "photonlab COMMAND --help says more, with an example.\n\n"
        "Exit codes: 0 done; 1 an error of the program's own; 2 input that cannot be used, or files that cannot be\n"
        "written; 3 ended by SIGINT or SIGTERM after the pass it was at, to be continued (a second signal ends at "
        "once).");
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
    // What was printed may still be on its way to a full disk.
    if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)
        return report("standard output: cannot be written: " + std::string(std::strerror(errno)), bad_input);
    return 0;
}

}  // namespace

int main(int argc, char** argv) {
    start_with_passive_waiting(argv);
    std::signal(SIGXFSZ, SIG_IGN);  // a file that grows beyond a quota is an error of writing like any other
    try {
        return run_program(argc, argv);
    } catch (const photonlab::InputError& error) {
        return report(error.what(), bad_input);
    } catch (const photonlab::Interrupted& interruption) {
        return report(interruption.what(), photonlab::interrupted_exit_code);
    } catch (const std::filesystem::filesystem_error& error) {
        return report(error.what(), bad_input);
    } catch (const std::exception& error) {
        return report(std::string("internal error: ") + error.what(), internal_error);
    }
}
