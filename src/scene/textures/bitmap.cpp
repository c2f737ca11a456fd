#include "scene/textures/bitmap.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "scene/mitsuba/plugin.h"
#include "scene/mitsuba/transform.h"

namespace photonlab {

namespace {

constexpr std::size_t texture_pixel_limit = std::size_t{1} << 27;  // of a scene: small files can hold very many

/// What 0.6 has in place of to_uv.
Matrix read_scale_and_offset(Properties& properties) {
    const double scale = properties.number("uvscale").value_or(1.0);
    Matrix to_uv;
    to_uv.setScale(
        VectorD(properties.number("uscale").value_or(scale), properties.number("vscale").value_or(scale), 1.0));
    to_uv[3][0] = properties.number("uoffset").value_or(0.0);
    to_uv[3][1] = properties.number("voffset").value_or(0.0);
    return to_uv;
}

/// What 0.6 has in place of raw: without a gamma it decodes as the file says.
bool is_linear(Properties& properties) {
    const auto gamma = properties.number("gamma");
    if (gamma && *gamma != 0.0 && *gamma != 1.0)
        throw InputError(properties.place_of("gamma"),
                         fmt::format("gamma: expected 1, or none for that of the file, got {}", *gamma));
    return gamma && *gamma == 1.0;
}

/// The image, whose errors are at `place` too.
ColorImage read_image_at(const std::filesystem::path& file, bool raw, const std::string& place) {
    try {
        return read_color_image(file, raw);
    } catch (const InputError& error) {
        throw InputError(place, error.what());
    }
}

void require_only(Properties& properties, const std::string& name, const std::string& only) {
    const std::string value = properties.text(name).value_or(only);
    if (value != only)
        throw InputError(properties.place_of(name),
                         fmt::format("{}: only \"{}\" is known here, got \"{}\"", name, only, value));
}

}  // namespace

Color Bitmap::color_at(const Imath::V2f& texture_coordinate) const {
    const VectorD uv = transform_point(to_uv, {texture_coordinate.x, texture_coordinate.y, 0.0});
    // Whole repeats are taken off first, so that far coordinates keep their precision.
    const double x = (uv.x - std::floor(uv.x)) * image.width - 0.5;
    const double y = (uv.y - std::floor(uv.y)) * image.height - 0.5;
    const double left = std::floor(x);
    const double top = std::floor(y);
    const auto pixel = [&](double column, double row) {
        const auto wrap = [](double index, int size) {
            return static_cast<std::size_t>((static_cast<int>(index) + size) % size);
        };
        return ColorD(
            image.pixels[wrap(row, image.height) * static_cast<std::size_t>(image.width) + wrap(column, image.width)]);
    };
    const double right_share = x - left;
    const double bottom_share = y - top;
    const ColorD upper = pixel(left, top) * (1.0 - right_share) + pixel(left + 1.0, top) * right_share;
    const ColorD lower = pixel(left, top + 1.0) * (1.0 - right_share) + pixel(left + 1.0, top + 1.0) * right_share;
    return Color(upper * (1.0 - bottom_share) + lower * bottom_share);
}

Bitmap Bitmap::read(Plugin& plugin) {
    Properties& properties = plugin.properties;
    const std::filesystem::path file = plugin.require_file();
    // What filters over a pixel in 0.6 is bilinear at a point of it.
    const std::string filter = properties.text("filter_type").value_or("bilinear");
    if (!plugin.is_version_06() || (filter != "ewa" && filter != "trilinear"))
        require_only(properties, "filter_type", "bilinear");
    require_only(properties, "wrap_mode", "repeat");
    const bool raw = plugin.is_version_06() ? is_linear(properties) : properties.boolean("raw").value_or(false);
    const Matrix to_uv =
        plugin.is_version_06() ? read_scale_and_offset(properties) : properties.transform("to_uv").value_or(Matrix());
    properties.require_all_known();
    plugin.require_no_objects();
    read_part(file, properties.place_of("filename"), plugin.source.bytes_read);
    Bitmap bitmap{read_image_at(file, raw, properties.place_of("filename")), to_uv, file.string()};
    plugin.source.texture_pixels += bitmap.image.pixels.size();
    if (plugin.source.texture_pixels > texture_pixel_limit)
        throw InputError(properties.place_of("filename"),
                         fmt::format("expected textures of at most {} pixels in all", texture_pixel_limit));
    return bitmap;
}

void Bitmap::check(const std::string& place) const {
    for (const Color& pixel : image.pixels)
        if (!is_finite(pixel) || std::min({pixel.x, pixel.y, pixel.z}) < 0.0f || max_channel(pixel) > 1.0f)
            throw InputError(place, fmt::format("{}: expected reflectances in [0, 1], got {} {} {}", file, pixel.x,
                                                pixel.y, pixel.z));
}

}  // namespace photonlab
