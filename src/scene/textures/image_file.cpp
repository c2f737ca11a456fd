#include "scene/textures/image_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/machine/available_memory.h"

namespace photonlab {

namespace {

constexpr std::size_t pixel_limit = std::size_t{1} << 27;  // of a scene

void decode(ColorImage& image, const Decoding& decoding) {
    if (decoding.by != Decoding::By::Srgb && decoding.by != Decoding::By::Power) return;
    for (Color& pixel : image.pixels)
        for (int channel = 0; channel < 3; ++channel) {
            const double value = std::max(0.0f, pixel[channel]);
            pixel[channel] = static_cast<float>(decoding.by == Decoding::By::Srgb ? srgb_to_linear(value)
                                                                                  : std::pow(value, decoding.power));
        }
}

}  // namespace

Decoding read_gamma(Plugin& plugin) {
    using By = Decoding::By;
    const double gamma = plugin.properties.number("gamma").value_or(0.0);
    if (gamma == 0.0) return {By::File};
    if (gamma == 1.0) return {By::Nothing};
    if (gamma == -1.0) return {By::Srgb};
    if (!(gamma > 0.0))
        throw InputError(plugin.properties.place_of("gamma"),
                         fmt::format("gamma: expected -1 (sRGB), 0 (as the file says) or more, got {}", gamma));
    return {By::Power, gamma};
}

ColorImage read_scene_image(Plugin& plugin, const std::filesystem::path& file, const Decoding& decoding,
                            std::size_t bytes_to_pixel) {
    const std::string& place = plugin.properties.place_of("filename");
    read_part(file, place, plugin.source.bytes_read);
    try {
        ColorImage image = read_color_image(file, decoding.by != Decoding::By::File);
        require_memory_for(file.string(), bytes_to_pixel * image.pixels.size());
        plugin.source.image_pixels += image.pixels.size();
        if (plugin.source.image_pixels > pixel_limit)
            throw InputError(file.string(), fmt::format("expected images of at most {} pixels in all", pixel_limit));
        decode(image, decoding);
        return image;
    } catch (const InputError& error) {
        throw InputError(place, error.what());
    }
}

}  // namespace photonlab
