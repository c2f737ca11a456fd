// Image files that a scene names: read with their numbers meant as the plugin says, and counted, since a small file can
// hold very many pixels.

#pragma once

#include <filesystem>

#include "image/read_image.h"
#include "scene/mitsuba/plugin.h"

namespace photonlab {

/// How the file's numbers become linear: as its kind says; not at all; by sRGB; by a power.
struct Decoding {
    enum class By { File, Nothing, Srgb, Power } by = By::File;
    double power = 1.0;
};

/// What 0.6's property gamma says: 1 for numbers that are linear, 0 for what the file says, -1 for sRGB.
Decoding read_gamma(Plugin& plugin);

/// The image in `file`, which the plugin's filename names; `bytes_to_pixel` is what the caller will keep of each beside
/// it. Throws InputError, also where the scene's images have too many pixels in all.
ColorImage read_scene_image(Plugin& plugin, const std::filesystem::path& file, const Decoding& decoding,
                            std::size_t bytes_to_pixel = 0);

}  // namespace photonlab
