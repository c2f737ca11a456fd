// Files that hold one mistake each. What must be said of it stands in the file's last line, after "expected: ", with
// names of files as they are in the mistakes' folder. Where it ends in " ...", the rest is a library's own words, which
// differ between its versions.

#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "core/error.h"
#include "core/files/files.h"

namespace photonlab::test {

inline std::filesystem::path mistakes_folder(const std::string& kind) {
    return std::filesystem::path(PHOTONLAB_SOURCE_DIR) / "tests/mistakes" / kind;
}

/// The files of that ending in the folder itself, sorted.
inline std::vector<std::filesystem::path> files_in(const std::filesystem::path& folder, const std::string& ending) {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder))
        if (entry.path().extension() == ending) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
}

/// `text` without every mention of `folder`.
inline std::string without_folder(std::string text, const std::filesystem::path& folder) {
    const std::string prefix = folder.string() + "/";
    for (std::size_t at; (at = text.find(prefix)) != text.npos;) text.erase(at, prefix.size());
    return text;
}

/// What the last line of a mistake expects.
inline std::string expected_message(const std::filesystem::path& file) {
    const std::string text = read_text_file(file);
    const std::string mark = "expected: ";
    const std::size_t at = text.rfind("\n", text.size() - 2);
    std::string line = text.substr(at + 1, text.find_last_not_of("\n") - at);
    if (line.ends_with(" -->")) line.resize(line.size() - 4);
    return line.find(mark) == line.npos ? "nothing: its last line has no \"expected: \""
                                        : line.substr(line.find(mark) + mark.size());
}

/// The message of the InputError that `read` throws, without the folder; anything else by what it is.
template <typename Read>
std::string refusal(const std::filesystem::path& folder, const Read& read) {
    try {
        read();
    } catch (const InputError& error) {
        return without_folder(error.what(), folder);
    } catch (const std::exception& error) {
        return std::string("not an InputError: ") + error.what();
    }
    return "no error";
}

/// `message`, cut like the expected one where that ends in " ...".
inline std::string as_far_as(const std::string& expected, const std::string& message) {
    const std::string begin = expected.ends_with(" ...") ? expected.substr(0, expected.size() - 4) : expected;
    return begin != expected && message.starts_with(begin) ? expected : message;
}

/// Reads every mistake of a kind and compares messages. There are at least `least`, lest they be lost unseen.
template <typename Read>
void expect_messages(const std::string& kind, const std::string& ending, std::size_t least, const Read& read) {
    const std::filesystem::path folder = mistakes_folder(kind);
    const std::vector<std::filesystem::path> files = files_in(folder, ending);
    EXPECT_GE(files.size(), least);
    for (const std::filesystem::path& file : files) {
        const std::string expected = expected_message(file);
        EXPECT_EQ(as_far_as(expected, refusal(folder, [&] { read(file); })), expected) << file.string();
    }
}

/// A folder of a test's own, removed afterwards.
class MistakesFolder {
public:
    MistakesFolder() {
        const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
        folder_ = std::filesystem::temp_directory_path() /
                  (std::string("photonlab-") + test->test_suite_name() + "-" + test->name());
        std::filesystem::remove_all(folder_);
        std::filesystem::create_directories(folder_);
    }
    MistakesFolder(const MistakesFolder&) = delete;
    MistakesFolder& operator=(const MistakesFolder&) = delete;
    ~MistakesFolder() { std::filesystem::remove_all(folder_); }

    const std::filesystem::path& path() const { return folder_; }
    std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }

    std::filesystem::path write(const std::string& name, const std::string& bytes) const {
        std::filesystem::create_directories((folder_ / name).parent_path());
        write_text_file(folder_ / name, bytes);
        return folder_ / name;
    }

private:
    std::filesystem::path folder_;
};

}  // namespace photonlab::test
