// Pictures are sRGB by the standard's own numbers, and nothing odd in the radiance can break them.

#include "image/png.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "scratch_folder.h"

namespace photonlab {
namespace {

std::vector<std::uint8_t> read_bytes(const std::filesystem::path& file, int width, int height) {
    const auto input = OIIO::ImageInput::open(file.string());
    EXPECT_TRUE(input);
    if (!input) return {};
    EXPECT_EQ(input->spec().width, width);
    EXPECT_EQ(input->spec().height, height);
    EXPECT_EQ(input->spec().nchannels, 3);
    EXPECT_EQ(input->spec().format, OIIO::TypeDesc::UINT8);
    std::vector<std::uint8_t> bytes(static_cast<std::size_t>(3 * width * height));
    EXPECT_TRUE(input->read_image(0, 0, 0, 3, OIIO::TypeDesc::UINT8, bytes.data()));
    return bytes;
}

// IEC 61966-2-1: linear 0.2140 is display 0.5, 0.0031308 is where the straight part ends (0.04045).
TEST(SrgbByte, FollowsTheStandard) {
    EXPECT_EQ(srgb_byte(0.0), 0);
    EXPECT_EQ(srgb_byte(1.0), 255);
    EXPECT_EQ(srgb_byte(0.0031308), 10);   // 255 * 0.04045 = 10.3
    EXPECT_EQ(srgb_byte(0.5), 188);        // 255 * 0.73536 = 187.5
    EXPECT_EQ(srgb_byte(0.18), 118);       // 255 * 0.46136 = 117.6
    EXPECT_EQ(srgb_byte(0.2140411), 127);  // 255 * 0.49999998 = 127.499995
    EXPECT_EQ(srgb_byte(0.001), 3);        // 255 * 0.01292 = 3.29
}

TEST(SrgbByte, InvertsEveryByte) {
    for (int byte = 0; byte < 256; ++byte) {
        const double encoded = byte / 255.0;
        const double linear = encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
        EXPECT_EQ(srgb_byte(linear), byte);
    }
}

TEST(SrgbByte, ClipsAndAnswersForEveryValue) {
    EXPECT_EQ(srgb_byte(-3.0), 0);
    EXPECT_EQ(srgb_byte(1e300), 255);
    EXPECT_EQ(srgb_byte(std::numeric_limits<double>::infinity()), 255);
    EXPECT_EQ(srgb_byte(-std::numeric_limits<double>::infinity()), 0);
    EXPECT_EQ(srgb_byte(std::numeric_limits<double>::quiet_NaN()), 0);
}

TEST(Png, HoldsEveryPixelInItsPlace) {
    const ScratchFolder folder;
    write_png(folder / "picture.png", 3, 2,
              {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.5, 0.18, 0.001}, {2, 2, 2}, {-1, -1, -1}});
    const std::vector<std::uint8_t> expected = {255, 0, 0, 0, 255, 0, 0, 0, 255, 188, 118, 3, 255, 255, 255, 0, 0, 0};
    EXPECT_EQ(read_bytes(folder / "picture.png", 3, 2), expected);
}

TEST(Png, ExposureMultipliesRadiance) {
    const ScratchFolder folder;
    write_png(folder / "picture.png", 1, 1, {{1.0, 0.36, 4.0}}, 0.5);
    EXPECT_EQ(read_bytes(folder / "picture.png", 1, 1), (std::vector<std::uint8_t>{188, 118, 255}));
}

TEST(Png, ShowsNanInMagenta) {
    const ScratchFolder folder;
    write_png(folder / "picture.png", 1, 1, {{0.5, std::numeric_limits<double>::quiet_NaN(), 0.5}});
    EXPECT_EQ(read_bytes(folder / "picture.png", 1, 1), (std::vector<std::uint8_t>{255, 0, 255}));
}

TEST(Png, RefusesAFolderThatIsNotThereAndLeavesNothingBehind) {
    const ScratchFolder folder;
    try {
        write_png(folder / "nowhere/picture.png", 1, 1, {ColorD(1.0)});
        FAIL() << "nothing was thrown";
    } catch (const InputError& error) {
        EXPECT_NE(std::string(error.what()).find("nowhere/picture.png: cannot be written: "), std::string::npos)
            << error.what();
    }
    EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
}  // namespace photonlab
