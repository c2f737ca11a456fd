#include "core/files/file_lock.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "core/error.h"
#include "core/files/files.h"
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
    EXPECT_NE(message().find("lock: is in the way: expected the empty file of a lock here, or none"), std::string::npos)
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

}  // namespace
}  // namespace photonlab
