// The program: one subcommand a task. Bad input and bad usage end with one line and exit code 2, an error of the
// program's own with 1, an interruption with 3, and what another process is making with 4.

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <new>
#include <sstream>
#include <string>
#include <system_error>
#include <vector>

#include "app/command_line.h"
#include "app/commands/commands.h"
#include "app/interruption.h"
#include "app/limits.h"
#include "core/error.h"
#include "core/files/file_lock.h"
#include "core/text/messages.h"

namespace {

constexpr int bad_input = 2;
constexpr int internal_error = 1;
constexpr int held_elsewhere = 4;

/// One line, whatever a message quotes: of more than 2000 bytes the middle is left out.
std::string one_line(std::string text) {
    constexpr std::size_t longest = 2000;
    if (text.size() > longest) text.replace(longest / 2, text.size() - longest, " ... ");
    std::replace(text.begin(), text.end(), '\n', ' ');
    return text;
}

/// OpenMP's threads spin while they wait, which takes processor time from those that work and from other programs (two
/// threads: 1.6 times as fast as one with it, 1.8 without). The environment says otherwise, but is read before main():
/// so the program starts once more, as it does for the stack of threads.
void start_with_passive_waiting(char** argv) {
    constexpr const char* policy = "OMP_WAIT_POLICY";
    const bool is_raised = photonlab::raise_limits();
    if (std::getenv(policy) && !is_raised) return;
    if (::setenv(policy, "passive", 0) == 0) ::execv("/proc/self/exe", argv);  // where that fails, it goes on as it is
}

int report(const std::string& message, int code) {
    photonlab::print_message("photonlab: {}\n", one_line(message));
    return code;
}

/// Some libraries end the program where they are refused memory or a thread, without a word.
[[noreturn]] void end_for_a_library() noexcept {
    try {
        const std::string message = photonlab::limit_message();
        ::_exit(message.empty() ? report("internal error: a library ended the program", internal_error)
                                : report(message, bad_input));
    } catch (...) {
        photonlab::write_message("photonlab: memory: more was needed than there is\n");
        ::_exit(bad_input);
    }
}

/// Reads the command line and does what it says; its messages are the library's own.
void run_command(CLI::App& app, std::vector<std::string> words) {
    using namespace photonlab;
    require_command(app, words);
    if (are_for_analysis(words)) start_analysis(words);
    std::vector<std::string> last_first(words.rbegin(), words.rend());  // as CLI11 takes them
    try {
        app.parse(last_first);
    } catch (const CLI::ParseError& error) {
        if (error.get_exit_code() != 0) {
            require_known_options(app, words[0]);
            throw InputError(error.what());
        }
        std::ostringstream text;  // of --help and --version
        app.exit(error, text, text);
        print_output("{}", text.str());
    }
}

int run_program(int argc, char** argv) {
    using namespace photonlab;
    CLI::App app("photonlab: a research harness for photon mapping", "photonlab");
    add_commands(app);
    run_command(app, {argv + std::min(argc, 1), argv + argc});
    const std::string failure = output_failure();
    return failure.empty() ? 0 : report("standard output: cannot be written: " + failure, bad_input);
}

}  // namespace

int main(int argc, char** argv) {
    photonlab::occupy_standard_streams();
    start_with_passive_waiting(argv);
    std::set_terminate(end_for_a_library);
    std::signal(SIGXFSZ, SIG_IGN);  // a file that grows beyond a quota is an error of writing like any other
    std::signal(SIGPIPE, SIG_IGN);  // and so is a pipe whose reader has left
    try {
        photonlab::require_stack();
        return run_program(argc, argv);
    } catch (const photonlab::HeldElsewhere& error) {
        return report(error.what(), held_elsewhere);
    } catch (const photonlab::InputError& error) {
        return report(error.what(), bad_input);
    } catch (const photonlab::Interrupted& interruption) {
        return report(interruption.what(), photonlab::interrupted_exit_code);
    } catch (const std::filesystem::filesystem_error& error) {
        return report(error.path1().string() + ": " + error.code().message(), bad_input);
    } catch (const std::system_error& error) {  // of threads
        return report(error.what(), bad_input);
    } catch (const std::bad_alloc&) {
        return report(photonlab::no_memory_message(), bad_input);
    } catch (const std::exception& error) {
        return report(std::string("internal error: ") + error.what(), internal_error);
    }
}
