// A folder of a test's own for scene files and what they name, removed afterwards.

#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "core/error.h"
#include "scene/loader.h"

namespace photonlab {

class SceneFolderTest : public ::testing::Test {
protected:
    void SetUp() override {
        const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
        folder_ = std::filesystem::temp_directory_path() /
                  (std::string("photonlab-") + test->test_suite_name() + "-" + test->name());
        std::filesystem::remove_all(folder_);
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    void write(const std::string& name, const std::string& text) const {
        std::filesystem::create_directories((folder_ / name).parent_path());
        std::ofstream(folder_ / name, std::ios::binary) << text;
    }

    SceneDescription load(const std::string& text) const {
        write("scene.xml", text);
        return load_scene_file(folder_ / "scene.xml");
    }

    /// Loads `inside` as the inside of a scene of that version which has a sensor already.
    SceneDescription load_as(const std::string& version, const std::string& inside) const {
        return load("<scene version='" + version + "'><sensor type='perspective'/>" + inside + "</scene>");
    }

    /// The message of the error that `text` raises, with the folder taken out.
    std::string message_of(const std::string& text) const {
        try {
            load(text);
        } catch (const InputError& error) {
            std::string message = error.what();
            const std::string prefix = folder_.string() + "/";
            for (std::size_t at; (at = message.find(prefix)) != std::string::npos;) message.erase(at, prefix.size());
            return message;
        }
        return "no error";
    }

    std::filesystem::path folder_;
};

}  // namespace photonlab
