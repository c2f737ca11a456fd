#include "core/files/temporary_file.h"

#include <gtest/gtest.h>
#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <set>

#include "core/error.h"
#include "core/files/files.h"
#include "core/text/text.h"
#include "tests/image/scratch_folder.h"

namespace photonlab {
namespace {

std::set<std::string> names_in(const std::filesystem::path& folder) {
    std::set<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) names.insert(entry.path().filename());
    return names;
}

/// Leaves what a process leaves that is killed while it writes `file`.
void be_killed_writing(const std::filesystem::path& file) {
    const pid_t process = ::fork();
    if (process == 0) {
        TemporaryFile temporary(file);
        temporary.descriptor().write("half of i");
        ::kill(::getpid(), SIGKILL);
    }
    ::waitpid(process, nullptr, 0);
}

TEST(TemporaryFile, HasItsNameOnceItIsWhole) {
    const ScratchFolder folder;
    write_text_file(folder / "rows.csv", "old");
    TemporaryFile temporary(folder / "rows.csv");
    ASSERT_TRUE(temporary.descriptor().write("ne"));
    ASSERT_TRUE(temporary.descriptor().write("w", 2));
    EXPECT_EQ(read_text_file(folder / "rows.csv"), "old");
    temporary.rename();
    EXPECT_EQ(read_text_file(folder / "rows.csv"), "new");
    EXPECT_EQ(names_in(folder.path()), std::set<std::string>{"rows.csv"});
}

TEST(TemporaryFile, TwoOfOneNameAreTwoFiles) {
    const ScratchFolder folder;
    TemporaryFile first(folder / "rows.csv");
    TemporaryFile second(folder / "rows.csv");
    EXPECT_NE(first.path(), second.path());
    first.descriptor().write("first");
    second.descriptor().write("second");
    second.rename();
    EXPECT_EQ(read_text_file(folder / "rows.csv"), "second");
    first.rename();
    EXPECT_EQ(read_text_file(folder / "rows.csv"), "first");
}

TEST(TemporaryFile, LeftByAKilledProcessIsRemovedByTheNext) {
    const ScratchFolder folder;
    be_killed_writing(folder / "rows.csv");
    be_killed_writing(folder / "other.exr");
    EXPECT_EQ(names_in(folder.path()).size(), 1u);  // the second removed the first's
    write_text_file(folder / "rows.csv", "whole");
    EXPECT_EQ(names_in(folder.path()), std::set<std::string>{"rows.csv"});
}

TEST(TemporaryFile, BeingWrittenStays) {
    const ScratchFolder folder;
    TemporaryFile temporary(folder / "rows.csv");
    remove_leftovers(folder.path());
    write_text_file(folder / "other.csv", "other");
    EXPECT_TRUE(std::filesystem::exists(temporary.path()));
    temporary.rename();
}

TEST(TemporaryFile, OfOthersIsNoLeftover) {
    const ScratchFolder folder;
    const std::set<std::string> names{"rows.csv.partial-123", "rows.csv.partial-0123456789abcdeg",
                                      "rows.csv.partial-0123456789ABCDEF", "0123456789abcdef"};
    for (const std::string& name : names) std::ofstream(folder / name) << "theirs";
    std::filesystem::create_directory(folder / "folder.partial-0123456789abcdef");
    std::ofstream(folder / "aim") << "aim";
    std::filesystem::create_symlink(folder / "aim", folder / "link.partial-0123456789abcdef");
    remove_leftovers(folder.path());
    EXPECT_EQ(names_in(folder.path()).size(), names.size() + 3);
}

TEST(TemporaryFile, ReplacesALinkAndWritesNotThroughIt) {
    const ScratchFolder folder;
    std::ofstream(folder / "aim") << "aim";
    std::filesystem::create_symlink(folder / "aim", folder / "rows.csv");
    write_text_file(folder / "rows.csv", "rows");
    EXPECT_EQ(read_text_file(folder / "aim"), "aim");
    EXPECT_EQ(read_text_file(folder / "rows.csv"), "rows");
    EXPECT_FALSE(std::filesystem::is_symlink(folder / "rows.csv"));
}

TEST(TemporaryFile, ThatSomebodyRemovedIsAnError) {
    const ScratchFolder folder;
    TemporaryFile temporary(folder / "rows.csv");
    std::filesystem::remove(temporary.path());
    EXPECT_THROW(temporary.rename(), InputError);
    std::ofstream(temporary.path()) << "another";
    EXPECT_THROW(temporary.rename(), InputError);
    EXPECT_FALSE(std::filesystem::exists(folder / "rows.csv"));
}

TEST(TemporaryFile, HasANameThatTheFileSystemTakesForAnyThatItTakes) {
    const ScratchFolder folder;
    const std::string accented = std::string(115, 'x') + [] {
        std::string text;
        for (int i = 0; i < 70; ++i) text += "\xc3\xa9";
        return text;
    }();
    for (const std::string& name : {std::string(255, 'x'), accented}) {
        ASSERT_EQ(name.size(), 255u);
        require_writable(folder / name);
        TemporaryFile temporary(folder / name);
        EXPECT_EQ(find_no_text(temporary.path().string()), std::string_view::npos);
        temporary.rename();
        EXPECT_TRUE(std::filesystem::exists(folder / name));
    }
    EXPECT_THROW(require_writable(folder / std::string(256, 'x')), InputError);
    EXPECT_EQ(names_in(folder.path()).size(), 2u);
}

/// Runs `body` in a process whose id is 1, as that of any other that does the same; false where the system refuses.
template <typename Body>
bool run_as_process_one(const Body& body, pid_t& process) {
    process = ::fork();
    if (process == 0) {
        if (::unshare(CLONE_NEWPID) != 0) ::_exit(77);
        const pid_t first = ::fork();
        if (first == 0) {
            try {
                body();
            } catch (const std::exception& error) {
                std::fprintf(stderr, "%s\n", error.what());
                ::_exit(1);
            }
            ::_exit(0);
        }
        int status = 0;
        ::waitpid(first, &status, 0);
        ::_exit(WIFEXITED(status) ? WEXITSTATUS(status) : 1);
    }
    return process > 0;
}

// As in containers, where all processes have the same few ids.
TEST(TemporaryFile, ProcessesOfOneIdReplaceAFileWithoutAHalfOfIt) {
    const ScratchFolder folder;
    const std::filesystem::path file = folder / "rows.csv";
    write_text_file(file, std::string(50000, 'x'));
    std::vector<pid_t> processes(4);
    for (std::size_t i = 0; i < processes.size(); ++i)
        ASSERT_TRUE(run_as_process_one(
            [&] {
                for (int k = 0; k < 100; ++k) write_text_file(file, std::string(50000, static_cast<char>('a' + i)));
            },
            processes[i]));
    std::size_t halves = 0;
    std::size_t running = processes.size();
    while (running > 0) {
        const std::string text = read_text_file(file);
        halves += text.size() != 50000 || text.find_first_not_of(text[0]) != std::string::npos;
        int status = 0;
        for (pid_t& process : processes)
            if (process > 0 && ::waitpid(process, &status, WNOHANG) == process) {
                process = 0;
                --running;
                if (WEXITSTATUS(status) == 77) GTEST_SKIP() << "process ids of one's own are not allowed here";
                EXPECT_EQ(WEXITSTATUS(status), 0);
            }
    }
    EXPECT_EQ(halves, 0u);
    EXPECT_EQ(names_in(folder.path()), std::set<std::string>{"rows.csv"});
}

}  // namespace
}  // namespace photonlab
