// The program as a process that can be stopped and limited, and an experiment for it to make.

#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "core/files/files.h"
#include "reference/reference_store.h"
#include "tests/support/two_walls.h"

namespace photonlab {

/// Limits that a process is started with; 0 is none.
struct Limits {
    rlim_t file_bytes = 0;
    rlim_t address_bytes = 0;
    rlim_t open_files = 0;
    bool own_process_ids = false;  ///< as in a container: its own id is 1, and it knows no other
};

/// What starts a program with process ids of its own, which ends with it.
inline const std::vector<std::string> own_process_ids{"/usr/bin/unshare", "-pf", "--mount-proc", "--kill-child"};

/// False where the system does not let this process do that.
inline bool has_own_process_ids() {
    return std::system("unshare -pf --mount-proc --kill-child true 2> /dev/null") == 0;
}

/// A running program, whose messages go to a file.
class Program {
public:
    Program(const std::vector<std::string>& arguments, const std::filesystem::path& messages, Limits limits = {})
        : messages_(messages) {
        std::vector<std::string> words;
        if (limits.own_process_ids) words = own_process_ids;
        words.push_back(PHOTONLAB_PROGRAM);
        words.insert(words.end(), arguments.begin(), arguments.end());
        std::vector<char*> pointers;
        for (std::string& word : words) pointers.push_back(word.data());
        pointers.push_back(nullptr);
        process_ = ::fork();
        if (process_ != 0) return;
        const int descriptor = ::open(messages.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
        ::dup2(descriptor, STDOUT_FILENO);
        ::dup2(descriptor, STDERR_FILENO);
        limit(RLIMIT_FSIZE, limits.file_bytes);
        limit(RLIMIT_AS, limits.address_bytes);
        limit(RLIMIT_NOFILE, limits.open_files);
        ::execv(pointers[0], pointers.data());
        ::_exit(127);
    }
    Program(const Program&) = delete;
    Program& operator=(const Program&) = delete;
    ~Program() {
        if (is_running()) {
            send(SIGKILL);
            wait();
        }
    }

    void send(int signal) { ::kill(process_, signal); }

    bool is_running() {
        if (!has_ended_) has_ended_ = ::waitpid(process_, &status_, WNOHANG) == process_;
        return !has_ended_;
    }

    /// The exit code, or minus the signal that ended it.
    int wait() {
        if (!has_ended_) ::waitpid(process_, &status_, 0);
        has_ended_ = true;
        return WIFEXITED(status_) ? WEXITSTATUS(status_) : -WTERMSIG(status_);
    }

    /// Waits until the file is there or the program has ended; true in the first case.
    bool wait_for(const std::filesystem::path& file) {
        while (!std::filesystem::exists(file)) {
            if (!is_running()) return false;
            std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        return true;
    }

    std::string messages() const { return std::filesystem::exists(messages_) ? read_text_file(messages_) : ""; }

private:
    static void limit(decltype(RLIMIT_AS) resource, rlim_t bytes) {
        if (bytes == 0) return;
        const rlimit value{bytes, bytes};
        ::setrlimit(resource, &value);
    }

    std::filesystem::path messages_;
    pid_t process_ = -1;
    int status_ = 0;
    bool has_ended_ = false;
};

/// Two walls, their reference, and an experiment with every method, probes and sums over seeds.
class ProgramTest : public ::testing::Test {
protected:
    ProgramTest() {
        write_two_walls(folder_, 8);
        folder_.write("tiny.toml",
                      "title = \"Is anything lost?\"\npasses = 24\nsnapshots = [1, 20]\n" + every_method_on_two_walls);
    }

    std::vector<std::string> run_into(const std::string& results) const {
        return {"run", (folder_ / "tiny.toml").string(), "-o", (folder_ / results).string(), "--checkpoint-seconds",
                "0"};
    }

    std::vector<std::string> render_into(const std::string& name, int passes) const {
        return {"render",
                (folder_ / "walls/scene.xml").string(),
                "-o",
                (folder_ / (name + ".exr")).string(),
                "--csv",
                (folder_ / (name + ".csv")).string(),
                "--passes",
                std::to_string(passes),
                "--photons",
                "300",
                "--threads",
                "1",
                "--snapshots",
                "7",
                "--checkpoint-seconds",
                "0",
                "--checkpoint",
                (folder_ / (name + ".checkpoint")).string(),
                "--resume"};
    }

    std::string messages_file() const { return (folder_ / "messages").string(); }

    /// Runs to the end; its exit code, and what it said in `said`.
    int run_program(const std::vector<std::string>& arguments, std::string& said, Limits limits = {}) const {
        Program program(arguments, folder_ / "messages", limits);
        const int code = program.wait();
        said = program.messages();
        return code;
    }

    TestFolder folder_;
};

}  // namespace photonlab
