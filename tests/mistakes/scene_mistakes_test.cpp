// Mistakes in scene files and meshes: one file each in scene/ and obj/, and here those that are too large for a file or
// none that an editor would show.

#include <sys/stat.h>

#include <fstream>

#include "scene/loader.h"
#include "scene/scene.h"
#include "scene/shapes/meshes/obj.h"
#include "tests/mistakes/mistakes.h"

namespace photonlab::test {
namespace {

void read_scene(const std::filesystem::path& file) {
    build_scene(load_scene_file(file));
}

TEST(SceneMistakes, EachGetsItsMessage) {
    expect_messages("scene", ".xml", 190, read_scene);
}

TEST(MeshMistakes, EachGetsItsMessage) {
    expect_messages("obj", ".obj", 37, [](const std::filesystem::path& file) { load_obj_mesh(file, false); });
}

TEST(SceneMistakes, EachIsNamedByItsFileAndLine) {
    for (const std::string kind : {"scene", "obj"})
        for (const auto& file : files_in(mistakes_folder(kind), kind == "obj" ? ".obj" : ".xml")) {
            const std::string message = expected_message(file);
            const std::size_t colon = message.find(':');
            ASSERT_NE(colon, message.npos) << message;
            EXPECT_EQ(message.find_first_not_of("0123456789", colon + 1), message.find(": ", colon)) << message;
        }
}

const std::string sensor = "<sensor type='perspective'/>";

std::string repeated(const std::string& text, std::size_t times) {
    std::string result;
    result.reserve(text.size() * times);
    for (std::size_t i = 0; i < times; ++i) result += text;
    return result;
}

TEST(SceneMistakes, FilesThatAreNoTextAreRefusedWithTheirLine) {
    const MistakesFolder folder;
    const auto message = [&](const std::string& bytes) {
        return refusal(folder.path(), [&] { read_scene(folder.write("scene.xml", bytes)); });
    };
    const std::string good = "<scene version='3.0.0'>\n" + sensor + "</scene>\n";
    EXPECT_EQ(message(good), "no error");
    EXPECT_EQ(message("\xef\xbb\xbf" + good), "no error") << "a byte order mark";
    EXPECT_EQ(message("<scene version='3.0.0'>\r\n" + sensor + "\r\n</scene>\r\n"), "no error");
    EXPECT_EQ(message("<scene version='3.0.0'>\r\n\r\n<light/>" + sensor + "</scene>").substr(0, 33),
              "scene.xml:3: unknown element <lig");
    EXPECT_EQ(message(""), "scene.xml:1: expected <scene>, got no element");
    EXPECT_EQ(message(" \n\n"), "scene.xml:1: expected <scene>, got no element");
    EXPECT_EQ(message(good + std::string(1, '\0')), "scene.xml:3: expected UTF-8 text, got byte 0x00");
    EXPECT_EQ(message("<scene version='3.0.0'>\n<!-- Stra\xdf"
                      "e -->" +
                      sensor + "</scene>"),
              "scene.xml:2: expected UTF-8 text, got byte 0xdf");
    EXPECT_EQ(message("<scene version='3.0.0'>\n<!-- Stra\xc3\x9f"
                      "e -->" +
                      sensor + "</scene>"),
              "no error");
    EXPECT_EQ(message(std::string("\xff\xfe<\0s\0c\0", 8)), "scene.xml:1: expected UTF-8 text, got byte 0xff");
    EXPECT_EQ(message(std::string("\0\0\0<\0\0\0s", 8)), "scene.xml:1: expected UTF-8 text, got byte 0x00");
    for (const std::string overlong :
         {"\xc0\x80", "\xe0\x80\x80", "\xf0\x80\x80\x80", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\xe2\x82", "\x80"})
        EXPECT_EQ(message("<scene version='3.0.0'>\n" + overlong).substr(0, 36),
                  "scene.xml:2: expected UTF-8 text, go");
    EXPECT_EQ(message(std::string(1'000'000, 'x')).substr(0, 46), "scene.xml:1: expected <scene>, got no element");
}

TEST(SceneMistakes, WhatIsNoFileIsRefusedNotWaitedFor) {
    const MistakesFolder folder;
    ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
    const auto message = [&](const std::string& inside) {
        return refusal(folder.path(), [&] {
            read_scene(folder.write("scene.xml", "<scene version='3.0.0'>" + sensor + "\n" + inside + "</scene>"));
        });
    };
    const std::string name = "<string name='filename' value='pipe'/>";
    const std::string refused = "scene.xml:2: pipe: expected a file, this is a pipe or a device";
    EXPECT_EQ(message("<shape type='obj'>" + name + "</shape>"), refused);
    EXPECT_EQ(message("<bsdf type='merl'>" + name + "</bsdf>"), refused);
    EXPECT_EQ(message("<bsdf type='diffuse'><texture type='bitmap' name='reflectance'>" + name + "</texture></bsdf>"),
              refused);
    EXPECT_EQ(message("<include filename='pipe'/>"), refused);
    EXPECT_EQ(refusal(folder.path(), [&] { read_scene(folder / "pipe"); }),
              "pipe: expected a file, this is a pipe or a device");
    EXPECT_EQ(refusal(folder.path(), [&] { read_scene("/dev/zero"); }),
              "/dev/zero: expected a file, this is a pipe or a device");
    EXPECT_EQ(refusal(folder.path().parent_path(), [&] { read_scene(folder.path()); }),
              folder.path().filename().string() + ": expected a file, this is a folder");
    EXPECT_EQ(refusal(folder.path(), [&] { read_scene(folder / "none.xml"); }),
              "none.xml: cannot be read: No such file or directory");
    EXPECT_EQ(refusal(folder.path(), [&] { read_scene(folder.write("here.xml", "") / "scene.xml"); }),
              "here.xml/scene.xml: cannot be read: Not a directory");
    std::filesystem::create_symlink("loop.xml", folder / "loop.xml");
    EXPECT_EQ(refusal(folder.path(), [&] { read_scene(folder / "loop.xml"); }),
              "loop.xml: cannot be read: Too many levels of symbolic links");
    if (::geteuid() != 0) {
        std::filesystem::permissions(folder.write("secret.xml", ""), std::filesystem::perms::none);
        EXPECT_EQ(refusal(folder.path(), [&] { read_scene(folder / "secret.xml"); }),
                  "secret.xml: cannot be read: Permission denied");
    }
}

TEST(SceneMistakes, FilesThatGrowWithoutEndAreRefused) {
    const MistakesFolder folder;
    const auto message = [&](const std::string& text) {
        return refusal(folder.path(), [&] { read_scene(folder.write("scene.xml", text)); });
    };
    EXPECT_EQ(message("<scene version='3.0.0'>" + repeated("<bsdf type='twosided'>", 300'000) +
                      repeated("</bsdf>", 300'000) + "</scene>"),
              "scene.xml:1: expected at most 100 elements inside each other");
    EXPECT_EQ(message("<scene version='3.0.0'>" + repeated("<a>", 1'000'000)).substr(0, 31),
              "scene.xml:1: not well-formed XM");
    EXPECT_EQ(message("<scene version='3.0.0'>" + repeated("<shape type='cube'/>", 1'100'000) + "</scene>"),
              "scene.xml:1: expected at most 1000000 elements");
    EXPECT_EQ(message("<scene version='3.0.0'>" + repeated(" ", 33 << 20) + "</scene>"),
              "scene.xml: expected a scene file and what it includes to have at most 33554432 bytes");
    EXPECT_EQ(message("<scene version='3.0.0'>" + sensor + repeated("\n<bsdf type='diffuse'/>", 65'537) + "</scene>"),
              "scene.xml:65538: expected at most 65536 materials");
    const std::string long_value = "<float name='radius' value='" + std::string(10'000'000, '1') + "'/>";
    EXPECT_EQ(message("<scene version='3.0.0'>\n<shape type='sphere'>" + long_value + "</shape></scene>"),
              "scene.xml:2: expected at most 65536 characters in a value");

    std::string chain;
    for (int i = 0; i < 100'000; ++i)
        chain += "<texture type='scale' id='t" + std::to_string(i) + "'><ref id='t" + std::to_string(i + 1) +
                 "'/></texture>";
    EXPECT_EQ(message("<scene version='0.6.0'>" + sensor + chain +
                      "<texture type='checkerboard' id='t100000'/><bsdf type='diffuse'><ref name='reflectance' "
                      "id='t0'/></bsdf></scene>"),
              "scene.xml:1: expected at most 16 textures inside each other");

    std::string doubling = "<default name='a0' value='0123456789'/>";
    for (int i = 1; i < 40; ++i) {
        const std::string last = "$a" + std::to_string(i - 1);
        doubling += "<default name='a" + std::to_string(i) + "' value='" + last + last + "'/>";
    }
    EXPECT_EQ(message("<scene version='3.0.0'>" + doubling + "</scene>"),
              "scene.xml:1: expected at most 65536 characters in a value");

    for (int i = 0; i < 20; ++i)
        folder.write("level" + std::to_string(i) + ".xml",
                     "<scene version='3.0.0'><include filename='level" + std::to_string(i + 1) + ".xml'/></scene>");
    EXPECT_EQ(message("<scene version='3.0.0'><include filename='level0.xml'/></scene>"),
              "level13.xml:1: expected at most 15 nested includes");
}

TEST(MeshMistakes, FilesThatAreNoTextAreRefused) {
    const MistakesFolder folder;
    const auto message = [&](const std::string& bytes) {
        return refusal(folder.path(), [&] { load_obj_mesh(folder.write("mesh.obj", bytes), false); });
    };
    const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";
    EXPECT_EQ(message(square + "f 1 2 3\n"), "no error");
    EXPECT_EQ(message("\xef\xbb\xbf" + square + "f 1 2 3\n"), "no error") << "a byte order mark";
    EXPECT_EQ(message(square + "f 1 2 3\n" + std::string(1, '\0')).substr(0, 28), "mesh.obj:6: unknown keyword ");
    EXPECT_EQ(message(square + std::string("f 1 2 \0003\n", 9)).substr(0, 35), "mesh.obj:5: expected a whole number");
    EXPECT_EQ(message(square + "f 1 2 3\ng Stra\xdf"
                               "e\n"),
              "no error")
        << "names are not read";
    EXPECT_EQ(message(std::string(1'000'000, 'v')).substr(0, 35), "mesh.obj:1: unknown keyword \"vvvvvv");
    EXPECT_EQ(message("f" + repeated(" 1", 1'000'000)), "mesh.obj:1: a face names vertex 1, but there are 0");
    EXPECT_EQ(message(square + "f" + repeated(" 1", 1'000'000) + "\n"), "no error");
}

}  // namespace
}  // namespace photonlab::test
