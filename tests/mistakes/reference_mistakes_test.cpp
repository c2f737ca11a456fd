// Mistakes in references: a sound folder is made here, and one thing in it is changed at a time.

#include <sys/stat.h>

#include <functional>

#include "core/hash.h"
#include "image/exr.h"
#include "reference/reference.h"
#include "reference/reference_store.h"
#include "tests/mistakes/mistakes.h"

namespace photonlab::test {
namespace {

const ReferenceSubject subject{"0123", 8, 4, 1, -1};

Image half(int width = 8, int height = 4) {
    Image image{width, height, {}};
    for (const char* layer : {"emission", "direct", "gathered"})
        image.layers.push_back({layer, std::vector<Color>(static_cast<std::size_t>(width * height), Color(0.25f))});
    return image;
}

Json sound_json(const std::filesystem::path& folder) {
    return {
        {"key", reference_key(subject)},
        {"reference_version", reference_version},
        {"scene", {{"hash", subject.scene_hash}}},
        {"width", subject.width},
        {"height", subject.height},
        {"samples_per_pixel", subject.samples_per_pixel},
        {"max_depth", subject.max_depth},
        {"samples_per_half", 16},
        {"seconds", 1.5},
        {"floor_mse", {{"total", 1e-4}}},
        {"checksums", {{"half_a", hash_file(folder / "half_a.exr")}, {"half_b", hash_file(folder / "half_b.exr")}}}};
}

class ReferenceMistakes : public ::testing::Test {
protected:
    ReferenceMistakes() {
        for (const char* name : {"half_a.exr", "half_b.exr"}) write_exr(folder_ / name, half());
        folder_.write("reference.json", sound_json(folder_.path()).dump());
    }
    std::string message() const {
        return refusal(folder_.path(), [&] { load_reference(folder_.path(), subject); });
    }
    std::string message_of(const std::string& json) const {
        folder_.write("reference.json", json);
        return message();
    }
    std::string message_with(const std::string& pointer, const Json& value) const {
        Json json = sound_json(folder_.path());
        json[Json::json_pointer(pointer)] = value;
        return message_of(json.dump());
    }
    const MistakesFolder folder_;
};

TEST_F(ReferenceMistakes, TheSoundOneIsRead) {
    EXPECT_EQ(message(), "no error");
}

TEST_F(ReferenceMistakes, EachValueOfItsJsonIsChecked) {
    const std::string file = "reference.json: ";
    for (const std::string name : {"width", "height", "samples_per_pixel"}) {
        const std::string expected = file + name + ": expected a whole number from 1 to 2147483647";
        for (const Json& value : {Json(0), Json(-1), Json(2147483648), Json(1.5), Json(1e300), Json("8"), Json(nullptr),
                                  Json(true), Json::array({8}), Json(18446744073709551615u)})
            EXPECT_EQ(message_with("/" + name, value), expected) << value;
    }
    EXPECT_EQ(message_with("/max_depth", -2), file + "max_depth: expected a whole number from -1 to 2147483647");
    EXPECT_EQ(message_with("/reference_version", -1),
              file + "reference_version: expected a whole number from 0 to 2147483647");
    for (const Json& value : {Json(0), Json(-1), Json(1e30), Json("16")})
        EXPECT_EQ(message_with("/samples_per_half", value),
                  file + "samples_per_half: expected a whole number from 1 to 9223372036854775807");
    EXPECT_EQ(message_with("/floor_mse/total", -1), file + "floor_mse: total: expected a number of at least 0");
    EXPECT_EQ(message_with("/seconds", -1), file + "seconds: expected a number of at least 0");
    for (const std::string pointer : {"/floor_mse/total", "/seconds"})
        EXPECT_EQ(message_with(pointer, "long").rfind(file + "this is no reference: ", 0), 0u) << pointer;
    for (const std::string pointer : {"/key", "/scene/hash", "/checksums/half_a", "/checksums/half_b"})
        EXPECT_EQ(message_with(pointer, 1).rfind(file + "this is no reference: ", 0), 0u) << pointer;
    for (const std::string name : {"key", "reference_version", "scene", "width", "height", "samples_per_pixel",
                                   "max_depth", "samples_per_half", "floor_mse", "checksums"}) {
        Json json = sound_json(folder_.path());
        json.erase(name);
        EXPECT_EQ(message_of(json.dump()).rfind(file + "this is no reference: ", 0), 0u) << name;
    }
}

TEST_F(ReferenceMistakes, WhatIsNoJsonIsRefused) {
    for (const std::string text :
         {"", "{", "[]", "null", "1", "\"\"", "{}", "{\"width\": 8,}", "not json", "{\"a\": \"\xdf\"}"})
        EXPECT_EQ(message_of(text).rfind("reference.json: this is no reference: ", 0), 0u) << text;
    EXPECT_EQ(message_of(std::string(1'000'000, '[')).rfind("reference.json: this is no reference: ", 0), 0u);
    EXPECT_EQ(message_of(std::string(1'000'000, '[') + std::string(1'000'000, ']'))
                  .rfind("reference.json: this is no reference: ", 0),
              0u);
    EXPECT_EQ(message_of(std::string((1 << 24) + 1, ' ')),
              "reference.json: expected at most 16777216 bytes, got 16777217");
}

TEST_F(ReferenceMistakes, OfSomethingElseIsSaidWithEveryDifference) {
    EXPECT_EQ(message_with("/scene/hash", "4567"),
              folder_.path().string() +
                  ": this is a reference of something else: the scene's hash is 4567 in the "
                  "reference and 0123 here");
    EXPECT_NE(message_with("/width", 9).find("the width is 9 in the reference and 8 here"), std::string::npos);
}

TEST_F(ReferenceMistakes, HalvesThatAreNotThoseOfTheJsonAreRefused) {
    const std::string not_it =
        "is not the file that reference.json was written for: it was changed, or a save was interrupted (photonlab "
        "reference with the same folder repairs the latter)";
    const std::string good = read_text_file(folder_ / "half_a.exr");
    folder_.write("half_a.exr", good + "x");
    EXPECT_EQ(message(), "half_a.exr: " + not_it);
    folder_.write("half_a.exr", "");
    EXPECT_EQ(message(), "half_a.exr: " + not_it);
    std::filesystem::remove(folder_ / "half_a.exr");
    EXPECT_EQ(message(), "half_a.exr: cannot be read: No such file or directory");
    std::filesystem::create_directory(folder_ / "half_a.exr");
    EXPECT_EQ(message(), "half_a.exr: expected a file, this is a folder");
    std::filesystem::remove(folder_ / "half_a.exr");
    ASSERT_EQ(::mkfifo((folder_ / "half_a.exr").c_str(), 0600), 0);
    EXPECT_EQ(message(), "half_a.exr: expected a file, this is a pipe or a device");
    std::filesystem::remove(folder_ / "half_a.exr");

    // Checksums right, content wrong.
    const auto with_half = [&](const std::function<void(const std::filesystem::path&)>& write) {
        write(folder_ / "half_a.exr");
        return message_of(sound_json(folder_.path()).dump());
    };
    EXPECT_EQ(with_half([](const auto& file) { write_exr(file, half(4, 8)); }),
              "half_a.exr: is not of the size that reference.json gives");
    EXPECT_EQ(with_half([](const auto& file) { write_text_file(file, "no image"); }),
              "half_a.exr: is not an OpenEXR file");
    EXPECT_EQ(with_half([](const auto& file) { write_exr(file, half()); }), "no error");
}

TEST_F(ReferenceMistakes, AFolderWithoutJsonAndAFileThatIsNoImageAreRefused) {
    std::filesystem::remove(folder_ / "reference.json");
    EXPECT_EQ(message(), folder_.path().string() +
                             ": this is no reference: reference.json is missing (photonlab reference makes one)");
    ASSERT_EQ(::mkfifo((folder_ / "reference.json").c_str(), 0600), 0);
    EXPECT_EQ(message(), "reference.json: expected a file, this is a pipe or a device");
    const auto alone = [&](const std::filesystem::path& file) {
        return refusal(folder_.path(), [&] { load_reference(file, subject); });
    };
    EXPECT_EQ(alone(folder_ / "none"), "none: cannot be read: No such file or directory");
    EXPECT_EQ(alone(folder_.write("text.exr", "no image")), "text.exr: is not an OpenEXR file");
    write_exr(folder_ / "small.exr", half(4, 4));
    EXPECT_EQ(alone(folder_ / "small.exr"), "small.exr: this reference is 4x4, the image 8x4");
    write_exr(folder_ / "same.exr", half());
    EXPECT_EQ(alone(folder_ / "same.exr"), "no error");
}

}  // namespace
}  // namespace photonlab::test
