// Plain PNGs by libpng have the values that OpenImageIO gives, and everything else is left to it.

#include "image/codecs/plain_png.h"

#include <OpenImageIO/imageio.h>
#include <gtest/gtest.h>
#include <png.h>
#include <sys/resource.h>

#include <cstdio>
#include <fstream>
#include <iterator>

#include "core/error.h"
#include "core/machine/available_memory.h"
#include "image/read_image.h"
#include "scratch_folder.h"

namespace photonlab {
namespace {

/// An image of 16 x 16 pixels with every byte in each channel.
void write_by_openimageio(const std::filesystem::path& file, int channels,
                          OIIO::TypeDesc type = OIIO::TypeDesc::UINT8) {
    std::vector<std::uint8_t> bytes;
    for (int i = 0; i < 256 * channels; ++i)
        bytes.push_back(static_cast<std::uint8_t>(i / channels + 85 * (i % channels)));
    const auto output = OIIO::ImageOutput::create(file.string());
    ASSERT_TRUE(output);
    ASSERT_TRUE(output->open(file.string(), OIIO::ImageSpec(16, 16, channels, type)));
    ASSERT_TRUE(output->write_image(OIIO::TypeDesc::UINT8, bytes.data()));
    ASSERT_TRUE(output->close());
}

std::string bytes_of(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(PlainPng, HasTheValuesThatOpenImageIoGives) {
    const ScratchFolder folder;
    for (const int channels : {1, 3}) {
        write_by_openimageio(folder / "plain.png", channels);
        const auto plain = read_plain_png(folder / "plain.png", require_memory_for);
        const DecodedImage expected = image_codecs().read(folder / "plain.png", require_memory_for);
        ASSERT_TRUE(plain) << channels;
        EXPECT_EQ(plain->width, expected.width);
        EXPECT_EQ(plain->height, expected.height);
        EXPECT_EQ(plain->channels, expected.channels);
        EXPECT_EQ(plain->is_floating_point, expected.is_floating_point);
        EXPECT_EQ(plain->values, expected.values);
    }
}

/// The bytes of a zTXt chunk of 7 MB.
std::string chunk_of_long_text(const ScratchFolder& folder) {
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    const std::filesystem::path file = folder / "text.png";
    std::FILE* const stream = std::fopen(file.c_str(), "wb");
    png_init_io(png, stream);
    png_set_IHDR(png, info, 1, 1, 8, PNG_COLOR_TYPE_GRAY, PNG_INTERLACE_NONE, 0, 0);
    std::string key = "Comment", long_text(7'000'000, 'x');
    png_text text{};
    text.compression = PNG_TEXT_COMPRESSION_zTXt;
    text.key = key.data();
    text.text = long_text.data();
    png_set_text(png, info, &text, 1);
    png_write_info(png, info);
    png_destroy_write_struct(&png, &info);
    std::fclose(stream);
    const std::string bytes = bytes_of(file);
    return bytes.substr(bytes.find("zTXt") - 4);
}

// Sixty texts before the pixels and as many behind them would be 840 MB.
TEST(PlainPng, DoesNotUnpackWhatIsBesideThePixels) {
    const ScratchFolder folder;
    write_by_openimageio(folder / "plain.png", 3);
    std::string bytes = bytes_of(folder / "plain.png");
    const std::string chunk = chunk_of_long_text(folder);
    for (const char* next : {"IEND", "IDAT"})
        for (int i = 0; i < 60; ++i) bytes.insert(bytes.find(next) - 4, chunk);
    std::ofstream(folder / "texts.png", std::ios::binary) << bytes;

    const auto peak_mebibytes = [] {
        rusage usage{};
        getrusage(RUSAGE_SELF, &usage);
        return static_cast<double>(usage.ru_maxrss) / 1024.0;
    };
    const double before = peak_mebibytes();
    const auto image = read_plain_png(folder / "texts.png", require_memory_for);
    EXPECT_LT(peak_mebibytes() - before, 50.0);
    ASSERT_TRUE(image);
    EXPECT_EQ(image->values, read_plain_png(folder / "plain.png", require_memory_for)->values);
}

TEST(PlainPng, LeavesAllElseToOpenImageIo) {
    const ScratchFolder folder;
    const auto is_read = [&](const char* name) {
        return read_plain_png(folder / name, require_memory_for).has_value();
    };
    write_by_openimageio(folder / "plain.png", 3);
    EXPECT_TRUE(is_read("plain.png"));
    write_by_openimageio(folder / "transparent.png", 4);
    write_by_openimageio(folder / "wide.png", 3, OIIO::TypeDesc::UINT16);
    write_by_openimageio(folder / "picture.jpg", 3);
    for (const char* name : {"transparent.png", "wide.png", "picture.jpg", "nowhere.png"})
        EXPECT_FALSE(is_read(name)) << name;
}

// An image's ending says how it is read, whatever it holds: a PNG that is called otherwise is refused, plain or not.
TEST(PlainPng, IsReadWhereTheFileIsCalledSo) {
    const ScratchFolder folder;
    for (const int channels : {3, 4}) {
        write_by_openimageio(folder / "image.png", channels);
        std::filesystem::copy_file(folder / "image.png", folder / "image.jpg",
                                   std::filesystem::copy_options::overwrite_existing);
        EXPECT_THROW(read_color_image(folder / "image.jpg", false), InputError) << channels;
        std::filesystem::copy_file(folder / "image.png", folder / "IMAGE.PNG",
                                   std::filesystem::copy_options::overwrite_existing);
        EXPECT_EQ(read_color_image(folder / "IMAGE.PNG", false).pixels,
                  read_color_image(folder / "image.png", false).pixels)
            << channels;
    }
}

// Wherever the file ends or is damaged nothing is read, and nothing breaks.
TEST(PlainPng, DoesNotReadWhatIsDamaged) {
    const ScratchFolder folder;
    write_by_openimageio(folder / "plain.png", 3);
    const std::string whole = bytes_of(folder / "plain.png");
    for (std::size_t size = 0; size < whole.size(); ++size) {
        std::ofstream(folder / "cut.png", std::ios::binary) << whole.substr(0, size);
        EXPECT_FALSE(read_plain_png(folder / "cut.png", require_memory_for)) << size;
    }
    std::string damaged = whole;
    damaged[whole.find("IDAT") + 10] ^= 1;
    std::ofstream(folder / "damaged.png", std::ios::binary) << damaged;
    EXPECT_FALSE(read_plain_png(folder / "damaged.png", require_memory_for));
}

TEST(PlainPng, AsksForMemoryBeforeItIsTaken) {
    const ScratchFolder folder;
    write_by_openimageio(folder / "plain.png", 3);
    const RequireMemory refuse = [](const std::string&, std::uint64_t bytes) {
        EXPECT_GE(bytes, 256u * 6u * sizeof(float));
        throw InputError("no memory");
    };
    EXPECT_THROW(read_plain_png(folder / "plain.png", refuse), InputError);
}

}  // namespace
}  // namespace photonlab
