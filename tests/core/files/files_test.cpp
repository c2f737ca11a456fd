#include "core/files/files.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>

#include "core/error.h"

namespace photonlab {
namespace {

/// A folder of a test's own.
class Files : public ::testing::Test {
protected:
    Files() : folder_(std::filesystem::temp_directory_path() / ("photonlab-files-" + std::to_string(::getpid()))) {
        std::filesystem::create_directories(folder_);
    }
    ~Files() override { std::filesystem::remove_all(folder_); }

    static std::string refusal_of(const std::filesystem::path& file, std::uintmax_t largest = 1000) {
        try {
            read_text_file(file, largest);
        } catch (const InputError& error) {
            const std::string message = error.what();
            return message.starts_with(file.string() + ": ") ? message.substr(file.string().size() + 2) : message;
        }
        return "";
    }

    std::filesystem::path folder_;
};

TEST_F(Files, AreReadAsTheyAre) {
    const std::string bytes("a\0b\r\n\xff", 6);
    write_text_file(folder_ / "a", bytes);
    EXPECT_EQ(read_text_file(folder_ / "a"), bytes);
    EXPECT_EQ(read_text_file(folder_ / "a", 6), bytes);
    EXPECT_EQ(refusal_of(folder_ / "a", 5), "expected at most 5 bytes, got 6");
    write_text_file(folder_ / "empty", "");
    EXPECT_EQ(read_text_file(folder_ / "empty"), "");
    EXPECT_NO_THROW(require_ordinary_file(folder_ / "empty"));
}

TEST_F(Files, ThatAreNotThereAreToldFromThoseThatCannotBeRead) {
    write_text_file(folder_ / "a", "text");
    EXPECT_EQ(read_if_there(folder_ / "a"), "text");
    for (const auto& none : {folder_ / "none", folder_ / "none/none", folder_ / "a/none"}) {
        EXPECT_EQ(read_if_there(none), std::nullopt) << none;
        EXPECT_FALSE(is_there(none)) << none;
    }
    EXPECT_THROW(read_if_there(folder_), InputError);
    EXPECT_TRUE(is_there(folder_));
    const std::filesystem::path long_name = folder_ / std::string(256, 'a');
    EXPECT_THROW(read_if_there(long_name), InputError);
    EXPECT_THROW(is_there(long_name), InputError);
    EXPECT_FALSE(is_folder(long_name));
}

TEST_F(Files, InAFolderAreListedByNameAndRemovedWithAllBelow) {
    for (const char* name : {"b", "a", "deep/er/c", "deep/d"}) {
        std::filesystem::create_directories((folder_ / name).parent_path());
        write_text_file(folder_ / name, "text");
    }
    std::filesystem::create_symlink(folder_, folder_ / "deep/round");
    EXPECT_EQ(entries_of(folder_), (std::vector{folder_ / "a", folder_ / "b", folder_ / "deep"}));
    EXPECT_EQ(entries_of(folder_ / "none"), std::vector<std::filesystem::path>{});
    EXPECT_THROW(entries_of(folder_ / "a"), InputError);
    EXPECT_EQ(files_below(folder_), (std::vector{folder_ / "a", folder_ / "b", folder_ / "deep/d",
                                                 folder_ / "deep/er/c", folder_ / "deep/round"}));
    remove_if_there(folder_ / "deep");
    remove_if_there(folder_ / "none");
    EXPECT_EQ(entries_of(folder_), (std::vector{folder_ / "a", folder_ / "b"}));
}

TEST_F(Files, ThatHaveNoEndOrWouldBeWaitedForAreRefused) {
    ASSERT_EQ(::mkfifo((folder_ / "pipe").c_str(), 0600), 0);
    std::filesystem::create_symlink(folder_ / "pipe", folder_ / "link");
    std::filesystem::create_symlink("round", folder_ / "round");
    for (const auto& file : {folder_ / "pipe", folder_ / "link", std::filesystem::path("/dev/zero")})
        EXPECT_EQ(refusal_of(file), "expected a file, this is a pipe or a device") << file;
    EXPECT_EQ(refusal_of(folder_), "expected a file, this is a folder");
    EXPECT_EQ(refusal_of(folder_ / "none"), "cannot be read: No such file or directory");
    EXPECT_EQ(refusal_of(folder_ / "round"), "cannot be read: Too many levels of symbolic links");
    EXPECT_EQ(refusal_of(folder_ / std::string(256, 'a')), "cannot be read: File name too long");
    EXPECT_EQ(refusal_of("/proc/self/status"), "expected a file that has a size, this is one of the kernel's");
    EXPECT_NE(refusal_of("/proc/kmsg"), "") << "ends when the kernel says something, or may not be read";
}

}  // namespace
}  // namespace photonlab
