// Meshes and scenes as files hold them at their worst: numbers that are none are refused with their line, triangles
// without area and normals that are missing change nothing.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "core/error.h"
#include "scene/loader.h"
#include "scene/shapes/meshes/obj.h"
#include "tests/statistical/rendering.h"
#include "tests/statistical/scenes.h"

namespace photonlab::test {
namespace {

class ExtremeFiles : public ::testing::Test {
protected:
    void SetUp() override {
        const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
        folder_ = std::filesystem::temp_directory_path() / (std::string("photonlab-ExtremeFiles-") + test->name());
        std::filesystem::remove_all(folder_);
        std::filesystem::create_directories(folder_);
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    std::filesystem::path write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name, std::ios::binary) << text;
        return folder_ / name;
    }

    /// The message that reading raises, without the folder's name.
    template <typename Read>
    std::string message_of(const Read& read) const {
        try {
            read();
        } catch (const InputError& error) {
            std::string message = error.what();
            const std::string folder = folder_.string() + "/";
            if (message.compare(0, folder.size(), folder) == 0) message.erase(0, folder.size());
            return message;
        }
        return "no error";
    }

    std::filesystem::path folder_;
};

const std::string corners = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST_F(ExtremeFiles, VerticesThatAreNotFiniteAreRefusedWithTheirLine) {
    for (const std::string bad :
         {"nan", "NaN", "-nan", "nan(ind)", "inf", "-inf", "Infinity", "1e999", "-1e400", "1.#IND", "-1.#INF"})
        for (const std::string& line : {"v " + bad + " 0 0", "v 0 " + bad + " 0", "v 0 0 " + bad}) {
            const auto file = write("mesh.obj", corners + "# a remark\n" + line + "\nf 1 2 3\n");
            const std::string message = message_of([&] { load_obj_mesh(file, true); });
            EXPECT_EQ(message.rfind("mesh.obj:6: ", 0), 0u) << line << ": " << message;
            EXPECT_NE(message.find(bad), std::string::npos) << message;
        }
}

std::string scene_text(const std::string& shapes) {
    return "<scene version=\"3.0.0\">\n" + shapes + "</scene>\n";
}

TEST_F(ExtremeFiles, NumbersThatAreNotFiniteAreRefusedWithTheirLine) {
    for (const std::string bad : {"nan", "inf", "1e999"})
        for (const std::string& line :
             {"<shape type=\"sphere\"><float name=\"radius\" value=\"" + bad + "\"/></shape>\n",
              "<shape type=\"sphere\"><point name=\"center\" x=\"0\" y=\"" + bad + "\" z=\"0\"/></shape>\n",
              "<emitter type=\"point\"><rgb name=\"intensity\" value=\"1 " + bad + " 1\"/></emitter>\n",
              "<shape type=\"sphere\"><transform name=\"to_world\"><scale value=\"" + bad +
                  "\"/></transform></shape>\n"}) {
            const auto file = write("scene.xml", scene_text("\n" + line));
            const std::string message = message_of([&] { build_scene(load_scene_file(file)); });
            EXPECT_EQ(message.rfind("scene.xml:3: ", 0), 0u) << line << message;
        }
}

TEST_F(ExtremeFiles, AlbedoAboveOneIsRefusedAndOneIsNot) {
    const auto load = [&](const std::string& albedo) {
        const auto file = write("scene.xml", scene_text("<sensor type=\"perspective\"/>\n<bsdf type=\"diffuse\" "
                                                        "id=\"wall\"><rgb name=\"reflectance\" value=\"" +
                                                        albedo + "\"/></bsdf>\n"));
        return message_of([&] { build_scene(load_scene_file(file)); });
    };
    for (const std::string bad : {"1.0000001", "0.5 0.5 1.001", "2", "1e30", "-1e-30"}) {
        const std::string message = load(bad);
        EXPECT_NE(message.find("reflectance"), std::string::npos) << bad << ": " << message;
        EXPECT_NE(message.find("[0, 1]"), std::string::npos) << bad << ": " << message;
    }
    for (const std::string good : {"0", "1", "0 1 0.5", "1e-40"}) EXPECT_EQ(load(good), "no error") << good;
}

// A mesh without normals gets smooth ones from its faces: a face without area has no say in them.
TEST_F(ExtremeFiles, TrianglesWithoutAreaTurnNoNormal) {
    const std::string bent = "v 0 0 0\nv 1 0 0\nv 1 1 0.3\nv 0 1 0.3\nv 0 2 0\nv 1 2 0\nf 1 2 3 4\nf 4 3 6 5\n";
    const MeshDescription plain = load_obj_mesh(write("plain.obj", bent), false);
    const MeshDescription worse = load_obj_mesh(write("worse.obj", bent + "f 1 1 1\nf 1 2 1\nf 2 2 3\n"), false);
    ASSERT_EQ(worse.positions.size(), plain.positions.size());
    for (std::size_t i = 0; i < plain.normals.size(); ++i) {
        EXPECT_EQ(worse.normals[i], plain.normals[i]);
        EXPECT_NEAR(worse.normals[i].length(), 1.0, 1e-12);
    }
    // Nothing but such faces: no surface, and no number that is none.
    const MeshDescription nothing = load_obj_mesh(write("nothing.obj", corners + "f 1 1 1\nf 2 2 3\n"), false);
    for (const VectorD& normal : nothing.normals) EXPECT_TRUE(is_finite(normal));
}

}  // namespace
}  // namespace photonlab::test
