#include "core/files/file_lock.h"

#include <gtest/gtest.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <csignal>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "core/error.h"
#include "core/files/files.h"
#include "core/files/json.h"
#include "core/machine/host.h"
#include "tests/image/scratch_folder.h"

namespace photonlab {
namespace {

TEST(FileLock, IsHeldByOneAndLeavesNoFile) {
    const ScratchFolder folder;
    {
        const auto lock = FileLock::try_lock(folder / "deep/lock");
        ASSERT_TRUE(lock);
        EXPECT_FALSE(FileLock::try_lock(folder / "deep/lock"));
        EXPECT_TRUE(std::filesystem::exists(folder / "deep/lock"));
    }
    EXPECT_FALSE(std::filesystem::exists(folder / "deep/lock"));
    EXPECT_TRUE(FileLock::try_lock(folder / "deep/lock"));
}

TEST(FileLock, OfAKilledProcessIsFree) {
    const ScratchFolder folder;
    const pid_t process = ::fork();
    if (process == 0) {
        const auto lock = FileLock::try_lock(folder / "lock");
        ::kill(::getpid(), SIGKILL);
    }
    ::waitpid(process, nullptr, 0);
    EXPECT_TRUE(std::filesystem::exists(folder / "lock"));
    EXPECT_TRUE(FileLock::try_lock(folder / "lock"));
    EXPECT_FALSE(std::filesystem::exists(folder / "lock"));
}

TEST(FileLock, AsksForTheInterruptionAsLongAsItWaits) {
    const ScratchFolder folder;
    auto lock = FileLock::try_lock(folder / "lock");
    int asked = 0;
    EXPECT_FALSE(FileLock::wait_for(folder / "lock", [&] { return ++asked == 3; }));
    EXPECT_EQ(asked, 3);
    EXPECT_TRUE(std::filesystem::exists(folder / "lock"));
    EXPECT_TRUE(FileLock::wait_for(folder / "lock", [&] {
        lock.reset();
        return false;
    }));
    EXPECT_TRUE(FileLock::wait_for(folder / "lock", [] { return true; }));  // nobody holds it: no wait
}

TEST(FileLock, LeavesFilesOfOthersAlone) {
    const ScratchFolder folder;
    const auto message = [&] {
        try {
            FileLock::try_lock(folder / "lock");
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string();
    };
    std::ofstream(folder / "lock") << "combination";
    EXPECT_NE(message().find("lock: is in the way: expected the file of a lock here, or none"), std::string::npos)
        << message();
    EXPECT_EQ(read_text_file(folder / "lock"), "combination");
    std::filesystem::rename(folder / "lock", folder / "aim");
    std::filesystem::create_symlink(folder / "nothing", folder / "lock");
    EXPECT_NE(message().find("lock: cannot be written"), std::string::npos) << message();
    EXPECT_FALSE(std::filesystem::exists(folder / "nothing"));
    std::filesystem::remove(folder / "lock");
    std::filesystem::create_directory(folder / "lock");
    EXPECT_NE(message().find("lock: cannot be written: Is a directory"), std::string::npos) << message();
}

// Somebody who removes the file by hand frees it for the next; the first then leaves the next one's alone.
TEST(FileLock, RemovesNoFileButItsOwn) {
    const ScratchFolder folder;
    auto first = FileLock::try_lock(folder / "lock");
    std::filesystem::remove(folder / "lock");
    const auto second = FileLock::try_lock(folder / "lock");
    ASSERT_TRUE(second);
    first.reset();
    EXPECT_TRUE(std::filesystem::exists(folder / "lock"));
    EXPECT_FALSE(FileLock::try_lock(folder / "lock"));
}

/// A file that a lock has left, or has, whose process is on some machine and was seen so many seconds ago.
void leave_lock(const std::filesystem::path& file, const std::string& boot, double seconds_ago) {
    std::ofstream(file)
        << Json{{"photonlab", "lock"}, {"host", "n17"}, {"process", 4711}, {"boot", boot}, {"nonce", "0"}}.dump();
    std::filesystem::last_write_time(file, std::filesystem::file_time_type::clock::now() -
                                               std::chrono::milliseconds(std::llround(1000.0 * seconds_ago)));
}

TEST(FileLock, SaysWhoHoldsIt) {
    const ScratchFolder folder;
    const auto lock = FileLock::try_lock(folder / "lock");
    LockHolder holder;
    EXPECT_FALSE(FileLock::try_lock(folder / "lock", &holder));
    EXPECT_EQ(holder.host, host_name());
    EXPECT_EQ(holder.process, ::getpid());
    EXPECT_TRUE(holder.is_certain);
    EXPECT_EQ(describe(holder), "process " + std::to_string(::getpid()) + " on " + host_name());
}

// The file system gives the lock away: its process has died, or is on a machine that locks of this one do not reach.
TEST(FileLock, OfAnotherMachineIsLeftAloneUntilItsLeaseIsOver) {
    const ScratchFolder folder;
    leave_lock(folder / "lock", "another", lease_seconds - 2.0);
    const std::string before = read_text_file(folder / "lock");
    LockHolder holder;
    EXPECT_FALSE(FileLock::try_lock(folder / "lock", &holder));
    EXPECT_EQ(describe(holder), "process 4711 on n17");
    EXPECT_FALSE(holder.is_certain);
    EXPECT_EQ(read_text_file(folder / "lock"), before);
    EXPECT_TRUE(FileLock::wait_for(folder / "lock", [] { return false; }));
    EXPECT_FALSE(std::filesystem::exists(folder / "lock"));
}

TEST(FileLock, OfThisMachineIsFreeWhateverItsLease) {
    const ScratchFolder folder;
    leave_lock(folder / "lock", boot_id(), 0.0);
    EXPECT_TRUE(FileLock::try_lock(folder / "lock"));
}

TEST(FileLock, ThatIsNotSignedYetIsLeftAloneForSomeSeconds) {
    const ScratchFolder folder;
    std::ofstream(folder / "lock").flush();
    LockHolder holder;
    EXPECT_FALSE(FileLock::try_lock(folder / "lock", &holder));
    EXPECT_EQ(describe(holder), "another process");
    EXPECT_FALSE(holder.is_certain);
    EXPECT_TRUE(FileLock::wait_for(folder / "lock", [] { return false; }));
}

/// As a file system whose locks do not reach another machine looks from there, to which its process is one of another
/// boot, last seen so many seconds ago.
void move_out_of_reach(const std::filesystem::path& file, double seconds_ago) {
    for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
        std::error_code ignored;
        if (std::filesystem::equivalent(entry.path(), file, ignored))
            ::flock(std::stoi(entry.path().filename().string()), LOCK_UN);
    }
    Json text = Json::parse(read_text_file(file));
    text["boot"] = "another";
    std::ofstream(file) << text.dump();  // the same file
    std::filesystem::last_write_time(file, std::filesystem::file_time_type::clock::now() -
                                               std::chrono::milliseconds(std::llround(1000.0 * seconds_ago)));
}

TEST(FileLock, WhoseLeaseWasOverIsLostToWhoTookIt) {
    const ScratchFolder folder;
    auto first = FileLock::try_lock(folder / "lock");
    move_out_of_reach(folder / "lock", lease_seconds - 5.0);
    EXPECT_FALSE(FileLock::try_lock(folder / "lock"));
    first->require_held();
    move_out_of_reach(folder / "lock", lease_seconds + 1.0);
    const auto second = FileLock::try_lock(folder / "lock");
    ASSERT_TRUE(second);
    EXPECT_THROW(first->require_held(), InputError);
    second->require_held();
    const std::string text = read_text_file(folder / "lock");
    first.reset();
    second->require_held();
    EXPECT_EQ(read_text_file(folder / "lock"), text);
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder.path()), {}), 1);
}

// Of many that find the same lease over at a time, one has it.
TEST(FileLock, WhoseLeaseIsOverIsTakenByOne) {
    const ScratchFolder folder;
    for (int i = 0; i < 50; ++i) {
        leave_lock(folder / "lock", "another", lease_seconds + 1.0);
        std::array<std::optional<FileLock>, 4> locks;
        std::vector<std::thread> threads;
        for (auto& lock : locks)
            threads.emplace_back([&] {
                if (auto taken = FileLock::try_lock(folder / "lock")) lock.emplace(std::move(*taken));
            });
        for (auto& thread : threads) thread.join();
        EXPECT_EQ(std::count_if(locks.begin(), locks.end(), [](const auto& lock) { return lock.has_value(); }), 1);
    }
}

TEST(FileLock, KnowsThatItWasTakenAway) {
    const ScratchFolder folder;
    auto first = FileLock::try_lock(folder / "lock");
    first->require_held();
    std::filesystem::remove(folder / "lock");
    EXPECT_THROW(first->require_held(), InputError);
    const auto second = FileLock::try_lock(folder / "lock");
    EXPECT_THROW(first->require_held(), InputError);
    second->require_held();
}

}  // namespace
}  // namespace photonlab
