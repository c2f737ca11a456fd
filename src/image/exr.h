// OpenEXR files: linear float RGB (the sum of the layers) in channels R, G, B, each layer as NAME.R, NAME.G, NAME.B,
// and metadata as string attributes.
//
// What is written can be read back to the bit: the layers are stored as they are (float32), and the string
// attribute `photonlab.layers` keeps their order, which the alphabetical channel list of an EXR loses. That
// attribute is also what tells our layers from another renderer's auxiliary channels (albedo.R, ...), which do not
// sum to the picture: without it, R, G, B alone are read.
//
// What a method says of its own error is in estimated_bias.R, ... and estimated_deviation.R, ..., beside the picture:
// not among the layers, and read only by name. So is the radius of its next gather, in one channel called radius, and
// where it was asked for how many photons it holds there (count) and how close they lie (density).
//
// The picture is R, G, B. Where another program has taken layers away, or has changed them or R, G, B, the difference
// is read as one more layer, "rest", so that the sum of the layers is always the picture.

#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "image/image.h"

namespace photonlab {

using Metadata = std::map<std::string, std::string>;  ///< attribute name to value

/// How a file is compressed; nothing is lost by either. The last bits of a noisy image are random and do not shrink.
enum class ExrCompression {
    Fast,   ///< run lengths: 10 ms for 256 x 256 pixels of four layers where ZIP takes 50, and 12% larger when noisy
    Small,  ///< ZIP: for references, which are kept
};

/// Writes to a temporary name beside `file` and renames, so that a half-written file never has the final name.
/// `image` has at least one layer; one layer called "total" is written as R, G, B alone. Values that are not finite
/// are written as they are. Throws InputError with the file's name when it cannot be written.
void write_exr(const std::filesystem::path& file, const Image& image, const Metadata& metadata = {},
               ExrCompression compression = ExrCompression::Fast);

/// The same, for a file that is to be known again by itself: `photonlab.bytes` says how long it is, in 20 digits, and
/// `photonlab.checksum` what hash (core/hash.h) its bytes have while the 32 digits of the checksum are zeros.
void write_sealed_exr(const std::filesystem::path& file, const Image& image, const Metadata& metadata);

/// What a sealed file's attributes say; throws InputError when it is no EXR, has no seal, or is longer or shorter than
/// it says. Its pixels are not looked at.
Metadata read_sealed_metadata(const std::filesystem::path& file);

/// Throws InputError when a byte of a sealed file is not what was written.
void require_seal(const std::filesystem::path& file);

/// Reads an image. Layers are those named by `photonlab.layers` as far as they are there, in that order; in a file
/// without it (another program's), R, G, B become one layer called "total", or r, g, b, or red, green, blue, or of a
/// file of Blender Composite.Combined.R, ..., or LAYER.Combined.R, ... where one layer has them, or the only three such
/// channels. Channels may be float, half or uint, the data window anywhere; alpha and other channels are left out.
/// `metadata` gets every string attribute.
///
/// `component` is what the image is read for: "total", or one layer. Only for the whole must R, G, B be there, or else
/// every layer; a layer that is asked for by name is read without `photonlab.layers`, too.
///
/// Throws InputError: not an EXR, truncated, no R, G, B (luminance alone is refused, not guessed to be grey),
/// several parts, deep, subsampled, a size that the file cannot hold.
Image read_exr(const std::filesystem::path& file, Metadata* metadata = nullptr, const std::string& component = "total");

/// What read_exr() takes for the picture of a file of Blender that has several: "Composite.Combined", what the
/// compositor made of the layers. Empty where there is nothing to choose from. Throws InputError.
std::string chosen_picture(const std::filesystem::path& file);

/// The string attributes alone. Throws InputError when it is not an EXR.
Metadata read_exr_metadata(const std::filesystem::path& file);

}  // namespace photonlab
