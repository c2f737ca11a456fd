// Mistakes in images and tables: textures, MERL tables, OpenEXR files. They are made here, for they are binary: a sound
// file, and what is changed in it.

#include <sys/stat.h>

#include <cstdint>
#include <cstring>

#include "image/exr.h"
#include "image/png.h"
#include "image/read_image.h"
#include "scene/materials/rough/merl.h"
#include "scene/mitsuba/xml_reader.h"
#include "tests/mistakes/mistakes.h"

// Read by LeakSanitizer, in builds that have it. libpng jumps over OpenImageIO's destructors where a PNG is broken,
// which leaks the message of the error.
extern "C" const char*
__lsan_default_suppressions() {  // NOLINT(bugprone-reserved-identifier): the sanitizer's name for it
    return "leak:OpenImageIO";
}

namespace photonlab::test {
namespace {

Image small_image(int width = 8, int height = 4) {
    Image image{width, height, {}};
    for (const char* layer : {"emission", "direct", "gathered"})
        image.layers.push_back({layer, std::vector<Color>(static_cast<std::size_t>(width * height), Color(0.25f))});
    return image;
}

std::string bytes_of(const std::filesystem::path& file) {
    return read_text_file(file);
}

std::string little_endian(std::int32_t value) {
    std::string bytes(4, '\0');
    std::memcpy(bytes.data(), &value, 4);
    return bytes;
}

std::string big_endian(std::uint32_t value) {
    std::string bytes;
    for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>(value >> shift & 0xff);
    return bytes;
}

std::uint32_t crc32(const std::string& bytes) {
    std::uint32_t crc = 0xffffffff;
    for (const char c : bytes) {
        crc ^= static_cast<unsigned char>(c);
        for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320 : 0);
    }
    return ~crc;
}

std::string png_chunk(const std::string& type, const std::string& data) {
    return big_endian(static_cast<std::uint32_t>(data.size())) + type + data + big_endian(crc32(type + data));
}

/// A PNG of 8-bit grey that claims this size, with a few bytes of pixels.
std::string png_claiming(std::uint32_t width, std::uint32_t height) {
    return "\x89PNG\r\n\x1a\n" +
           png_chunk("IHDR", big_endian(width) + big_endian(height) + std::string("\x08\0\0\0\0", 5)) +
           png_chunk("IDAT", std::string("\x78\x9c\x63\x60\0\0\0\x02\0\x01", 10)) + png_chunk("IEND", "");
}

/// `bytes` with the attribute's value, which begins `skip` bytes after its name's end, replaced.
std::string with_value(std::string bytes, const std::string& name_and_type, const std::string& value) {
    const std::size_t at = bytes.find(name_and_type);
    EXPECT_NE(at, bytes.npos) << name_and_type;
    bytes.replace(at + name_and_type.size() + 4, value.size(), value);  // 4: the attribute's size
    return bytes;
}

std::string with_data_window(const std::string& exr, std::int32_t left, std::int32_t top, std::int32_t right,
                             std::int32_t bottom) {
    return with_value(exr, std::string("dataWindow\0box2i\0", 17),
                      little_endian(left) + little_endian(top) + little_endian(right) + little_endian(bottom));
}

TEST(TextureMistakes, EachGetsItsMessage) {
    const MistakesFolder folder;
    write_png(folder / "good.png", 8, 4, std::vector<ColorD>(32, ColorD(0.5)), 1.0);
    const std::string good = bytes_of(folder / "good.png");
    const auto message = [&](const std::string& name, const std::string& bytes) {
        return refusal(folder.path(), [&] { read_color_image(folder.write(name, bytes), false); });
    };
    EXPECT_EQ(message("a.png", good), "no error");
    EXPECT_EQ(message("a.PNG", good), "no error");
    const std::string formats = ": expected an image file .bmp, .exr, .hdr, .jpg, .png, .tga or .tif";
    EXPECT_EQ(message("a.webp", good), "a.webp" + formats);
    EXPECT_EQ(message("a.mp4", good), "a.mp4" + formats);
    EXPECT_EQ(message("a", good), "a" + formats);
    EXPECT_EQ(message("empty.png", "").rfind("empty.png: cannot be read as an image: ", 0), 0u);
    EXPECT_EQ(message("text.png", "no image").rfind("text.png: cannot be read as an image: ", 0), 0u);
    for (const char* name : {"a.bmp", "a.exr", "a.hdr", "a.jpg", "a.tga", "a.tif"})
        EXPECT_EQ(message(name, good).rfind(std::string(name) + ": ", 0), 0u) << message(name, good);
    for (std::size_t length = 1; length + 12 < good.size(); length += 7)
        EXPECT_EQ(message("cut.png", good.substr(0, length)).rfind("cut.png: cannot be read as an image: ", 0), 0u)
            << length;

    const std::string limits =
        "expected a flat image of 1 to 32768 pixels a side, 67108864 in all, with 1 to 1024 channels, got ";
    EXPECT_EQ(message("bomb.png", png_claiming(32'768, 32'768)), "bomb.png: " + limits + "32768 x 32768 with 1");
    EXPECT_EQ(message("bomb.png", png_claiming(8193, 8193)), "bomb.png: " + limits + "8193 x 8193 with 1");
    EXPECT_EQ(message("bomb.png", png_claiming(8000, 8000)), "bomb.png: claims 8000 x 8000 pixels, more than its " +
                                                                 std::to_string(png_claiming(8000, 8000).size()) +
                                                                 " bytes can hold");
    EXPECT_EQ(message("bomb.png", png_claiming(1'000'000'000, 1)).rfind("bomb.png: ", 0), 0u);
    EXPECT_EQ(message("zero.png", png_claiming(0, 4)).rfind("zero.png: ", 0), 0u);

    ASSERT_EQ(::mkfifo((folder / "pipe.png").c_str(), 0600), 0);
    EXPECT_EQ(refusal(folder.path(), [&] { read_color_image(folder / "pipe.png", false); }),
              "pipe.png: expected a file, this is a pipe or a device");
    EXPECT_EQ(refusal(folder.path(), [&] { read_color_image(folder / "none.png", false); }),
              "none.png: cannot be read: No such file or directory");
}

TEST(MerlMistakes, EachGetsItsMessage) {
    const MistakesFolder folder;
    std::string good = little_endian(90) + little_endian(90) + little_endian(180);
    good.resize(MerlTable::file_size, '\0');
    const auto message = [&](const std::string& bytes) {
        BytesRead read;
        return refusal(folder.path(), [&] { load_merl_table(folder.write("a.binary", bytes), "scene.xml:7", read); });
    };
    const std::string expected =
        "scene.xml:7: a.binary: expected a MERL BRDF, 34992012 bytes with the dimensions 90 90 180, got ";
    EXPECT_EQ(message(good), "no error");
    EXPECT_EQ(message(""), expected + "0 bytes");
    EXPECT_EQ(message("\x5a"), expected + "1 bytes");
    EXPECT_EQ(message(good.substr(0, 12)), expected + "12 bytes with the dimensions 90 90 180");
    EXPECT_EQ(message(good.substr(0, good.size() - 1)), expected + "34992011 bytes with the dimensions 90 90 180");
    EXPECT_EQ(message(good + "\n"), expected + "34992013 bytes with the dimensions 90 90 180");
    const auto with = [&](std::int32_t a, std::int32_t b, std::int32_t c) {
        return little_endian(a) + little_endian(b) + little_endian(c) + good.substr(12);
    };
    EXPECT_EQ(message(with(180, 90, 90)), expected + "34992012 bytes with the dimensions 180 90 90");
    EXPECT_EQ(message(with(-90, -90, 180)), expected + "34992012 bytes with the dimensions -90 -90 180");
    EXPECT_EQ(message(with(2147483647, 2147483647, 2147483647)),
              expected + "34992012 bytes with the dimensions 2147483647 2147483647 2147483647");
    EXPECT_EQ(message(big_endian(90) + big_endian(90) + big_endian(180) + good.substr(12)),
              expected + "34992012 bytes with the dimensions 1509949440 1509949440 -1275068416");
    const auto with_number = [&](std::size_t index, double number) {
        std::string bytes = good;
        std::memcpy(bytes.data() + 12 + 8 * index, &number, 8);
        return bytes;
    };
    EXPECT_EQ(
        message(with_number(3, std::numeric_limits<double>::quiet_NaN())),
        "scene.xml:7: a.binary: expected finite numbers, got 1 of 4374000 that are not; the first is number 3, red "
        "of theta_h 0, theta_d 0, phi_d 3, counted from 0");
    EXPECT_EQ(message(with_number(1'458'000, std::numeric_limits<double>::infinity())),
              "scene.xml:7: a.binary: expected finite numbers, got 1 of 4374000 that are not; the first is number "
              "1458000, green of theta_h 0, theta_d 0, phi_d 0, counted from 0");
    EXPECT_EQ(message(with_number(4'373'999, 1e300)),
              "scene.xml:7: a.binary: expected finite numbers, got 1 of 4374000 that are not; the first is number "
              "4373999, blue of theta_h 89, theta_d 89, phi_d 179, counted from 0");
}

TEST(ExrMistakes, EachGetsItsMessage) {
    const MistakesFolder folder;
    write_exr(folder / "good.exr", small_image());
    const std::string good = bytes_of(folder / "good.exr");
    const auto message = [&](const std::string& bytes) {
        return refusal(folder.path(), [&] { read_exr(folder.write("a.exr", bytes)); });
    };
    EXPECT_EQ(message(good), "no error");
    EXPECT_EQ(message(""), "a.exr: is not an OpenEXR file");
    EXPECT_EQ(message("no image"), "a.exr: is not an OpenEXR file");
    EXPECT_EQ(message("\x76\x2f\x31\x01").rfind("a.exr: ", 0), 0u);
    for (std::size_t length = 5; length < good.size(); length += 11)
        EXPECT_EQ(message(good.substr(0, length)).rfind("a.exr: ", 0), 0u) << length;

    const std::string claims =
        "pixels, more than is read here or than its " + std::to_string(good.size()) + " bytes can hold";
    EXPECT_EQ(message(with_data_window(good, 0, 0, 16'000'000, 3)), "a.exr: claims 16000001 x 4 " + claims);
    EXPECT_EQ(message(with_data_window(good, -8'000'000, -2, 8'000'000, 1)), "a.exr: claims 16000001 x 4 " + claims);
    for (const std::int32_t most : {9'999, 19'999, 99'999})  // its table of blocks is missing
        EXPECT_EQ(message(with_data_window(good, 0, 0, most, most)).rfind("a.exr: cannot be read as OpenEXR: ", 0), 0u);
    for (const std::int32_t most : {999'999'999, 2'147'483'646})
        EXPECT_EQ(message(with_data_window(good, 0, 0, most, most)).rfind("a.exr: cannot be read as OpenEXR: ", 0), 0u);
    EXPECT_EQ(message(with_data_window(good, 0, 0, 7, 2'147'483'646)).rfind("a.exr: ", 0), 0u);
    EXPECT_EQ(message(with_data_window(good, 5, 5, 0, 0)).rfind("a.exr: ", 0), 0u);

    std::string long_attribute = good;
    const std::string compression("compression\0compression\0", 24);
    long_attribute.replace(good.find(compression) + compression.size(), 4, little_endian(1'600'000'000));
    EXPECT_EQ(message(long_attribute),
              "a.exr: is broken: an attribute of its header claims 1600000000 bytes, more than follow");
    // The same length as "emission,direct,gathered", which keeps the header whole.
    const std::string layers("photonlab.layers\0string\0", 24);
    EXPECT_EQ(message(with_value(good, layers, "emission,direct,emission")), "a.exr: names a layer twice");
    EXPECT_EQ(message(with_value(good, layers, ",,,,,,,,,,,,,,,,,,,,,,,,")), "a.exr: names a layer twice");
    EXPECT_EQ(message(with_value(good, layers, "emission,direct,elevated")), "no error") << "the picture is there";
    EXPECT_EQ(message(with_value(good, compression, "\x63")).rfind("a.exr: cannot be read as OpenEXR: ", 0), 0u);

    ASSERT_EQ(::mkfifo((folder / "pipe.exr").c_str(), 0600), 0);
    EXPECT_EQ(refusal(folder.path(), [&] { read_exr(folder / "pipe.exr"); }),
              "pipe.exr: expected a file, this is a pipe or a device");
    EXPECT_EQ(refusal(folder.path(), [&] { read_exr("/dev/zero"); }),
              "/dev/zero: expected a file, this is a pipe or a device");
    EXPECT_EQ(refusal(folder.path(), [&] { read_exr(folder / "none.exr"); }),
              "none.exr: cannot be read: No such file or directory");
}

// Random changes of a sound file must give an image or a message, of any kind.
TEST(ExrMistakes, ChangedBytesNeverDoWorse) {
    const MistakesFolder folder;
    write_exr(folder / "good.exr", small_image());
    const std::string good = bytes_of(folder / "good.exr");
    std::uint32_t state = 1;
    const auto random = [&] { return state = state * 1664525u + 1013904223u; };
    for (int round = 0; round < 300; ++round) {
        std::string bytes = good;
        for (std::uint32_t i = random() >> 30; i < 4; ++i)
            bytes[(random() >> 8) % bytes.size()] = static_cast<char>(random() >> 24);
        const std::string message = refusal(folder.path(), [&] { read_exr(folder.write("a.exr", bytes)); });
        EXPECT_TRUE(message == "no error" || message.starts_with("a.exr: ")) << round << ": " << message;
    }
}

}  // namespace
}  // namespace photonlab::test
