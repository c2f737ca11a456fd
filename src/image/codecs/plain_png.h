// PNG files as most textures and all pictures here are, by libpng itself: OpenImageIO (image_codecs.h) takes a third of
// a second to be loaded, which is longer than a small render.

#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "image/codecs/image_codecs.h"

namespace photonlab {

/// The image of a PNG of 8 bits a channel, grey or RGB, without a palette, transparency or interlacing; empty for any
/// other file, and for one that is damaged or too large: OpenImageIO reads it, or says what is wrong with it. The
/// values are those that OpenImageIO gives. Memory is asked for before it is taken.
std::optional<DecodedImage> read_plain_png(const std::filesystem::path& file, RequireMemory require_memory);

/// Writes 8-bit sRGB to `temporary`, row by row from the top; `file` is its name in messages. Throws InputError.
void write_plain_png(const std::filesystem::path& temporary, const std::filesystem::path& file, int width, int height,
                     const std::vector<std::uint8_t>& bytes);

}  // namespace photonlab
