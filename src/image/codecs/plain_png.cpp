// libpng goes on after an error by a jump back, over which no object that has a destructor may stand: what it reads
// into is made before.

#include "image/codecs/plain_png.h"

#include <fmt/format.h>
#include <png.h>

#include <algorithm>
#include <cstdio>
#include <memory>

#include "core/error.h"

namespace photonlab {

namespace {

/// Of more pixels, or more values to a byte, than image_codecs() takes, it says so itself.
constexpr std::size_t largest_png_side = std::size_t{1} << 15;
constexpr std::size_t most_png_pixels = std::size_t{1} << 26;
constexpr std::size_t largest_png_ratio = 10'000;

struct CloseFile {
    void operator()(std::FILE* stream) const { std::fclose(stream); }
};
using OpenFile = std::unique_ptr<std::FILE, CloseFile>;

[[noreturn]] void jump_back(png_structp png, png_const_charp) {
    png_longjmp(png, 1);
}
void say_nothing(png_structp, png_const_charp) {}

/// A file that is being read.
struct Reading {
    Reading() : png(png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, jump_back, say_nothing)) {
        if (png) info = png_create_info_struct(png);
    }
    ~Reading() { png_destroy_read_struct(&png, &info, nullptr); }
    Reading(const Reading&) = delete;
    Reading& operator=(const Reading&) = delete;

    png_structp png;
    png_infop info = nullptr;
};

/// Reads up to the pixels; false for what is not plain.
bool begin(const Reading& reading, std::FILE* stream) {
    if (setjmp(png_jmpbuf(reading.png))) return false;
    png_init_io(reading.png, stream);
    // What is beside the pixels, as texts and profiles, is passed over: unpacked it can be a thousand times the file.
    constexpr int all_but_transparency = -1;
    png_set_keep_unknown_chunks(reading.png, PNG_HANDLE_CHUNK_NEVER, nullptr, all_but_transparency);
    png_read_info(reading.png, reading.info);
    const png_byte color = png_get_color_type(reading.png, reading.info);
    return png_get_bit_depth(reading.png, reading.info) == 8 &&
           (color == PNG_COLOR_TYPE_GRAY || color == PNG_COLOR_TYPE_RGB) &&
           !png_get_valid(reading.png, reading.info, PNG_INFO_tRNS) &&
           png_get_interlace_type(reading.png, reading.info) == PNG_INTERLACE_NONE;
}

/// Reads the pixels, `row_bytes` a row, to the end of the file.
bool read_rows(const Reading& reading, std::uint8_t* bytes, std::size_t rows, std::size_t row_bytes) {
    if (setjmp(png_jmpbuf(reading.png))) return false;
    for (std::size_t row = 0; row < rows; ++row) png_read_row(reading.png, bytes + row * row_bytes, nullptr);
    png_read_end(reading.png, nullptr);
    return true;
}

}  // namespace

std::optional<DecodedImage> read_plain_png(const std::filesystem::path& file, RequireMemory require_memory) {
    const OpenFile stream(std::fopen(file.c_str(), "rb"));
    const Reading reading;
    if (!stream || !reading.info || !begin(reading, stream.get())) return std::nullopt;
    const std::size_t width = png_get_image_width(reading.png, reading.info);
    const std::size_t height = png_get_image_height(reading.png, reading.info);
    const std::size_t channels = png_get_channels(reading.png, reading.info);
    const std::size_t count = width * height * channels;
    if (std::max(width, height) > largest_png_side || width * height > most_png_pixels ||
        count / largest_png_ratio > std::filesystem::file_size(file))
        return std::nullopt;
    require_memory(file.string(), sizeof(float) * (count + 3 * width * height) + count);
    std::vector<std::uint8_t> bytes(count);
    if (!read_rows(reading, bytes.data(), height, width * channels)) return std::nullopt;
    DecodedImage image{static_cast<int>(width), static_cast<int>(height), static_cast<int>(channels), false, {}};
    image.values.reserve(count);
    for (const std::uint8_t byte : bytes) image.values.push_back(static_cast<float>(byte) * (1.0f / 255.0f));
    return image;
}

void write_plain_png(const std::filesystem::path& temporary, const std::filesystem::path& file, int width, int height,
                     const std::vector<std::uint8_t>& bytes) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = static_cast<png_uint_32>(width);
    image.height = static_cast<png_uint_32>(height);
    image.format = PNG_FORMAT_RGB;
    if (!png_image_write_to_file(&image, temporary.c_str(), 0, bytes.data(), 0, nullptr))
        throw InputError(file.string(), fmt::format("cannot be written: {}", image.message));
}

}  // namespace photonlab
