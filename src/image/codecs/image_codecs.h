// Image files by OpenImageIO, in a shared library of its own that is loaded when the first is read that is no plain PNG
// (plain_png.h): OpenImageIO brings some 250 libraries, whose start takes longer than a small render. It is looked for
// beside the program, so that the two can be moved together.

#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace photonlab {

/// An image as its file has it, row by row from the top.
struct DecodedImage {
    int width = 0;
    int height = 0;
    int channels = 0;                ///< 1 or 3: alpha and all beyond it are left out
    bool is_floating_point = false;  ///< in the file; integers are scaled to [0, 1]
    std::vector<float> values;       ///< width * height * channels
};

/// require_memory_for(), which the library does not have.
using RequireMemory = void (*)(const std::string& place, std::uint64_t bytes);

struct ImageCodecs {
    /// Reads a BMP, EXR, HDR, JPEG, PNG, TGA or TIFF of at most 2^26 pixels, whose memory is asked for before it is
    /// taken. Throws InputError.
    DecodedImage (*read)(const std::filesystem::path& file, RequireMemory require_memory);
};

/// The codecs, loaded by the first call. Throws InputError when their library is missing.
const ImageCodecs& image_codecs();

}  // namespace photonlab
