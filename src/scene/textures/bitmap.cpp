#include "scene/textures/bitmap.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/text/nearest.h"
#include "scene/mitsuba/plugin.h"
#include "scene/mitsuba/transform.h"
#include "scene/textures/image_file.h"
#include "scene/textures/uv_transform.h"

namespace photonlab {

namespace {

/// 0.6 has a gamma in place of raw.
Decoding read_decoding(Plugin& plugin) {
    if (plugin.is_version_06()) return read_gamma(plugin);
    return {plugin.properties.boolean("raw").value_or(false) ? Decoding::By::Nothing : Decoding::By::File};
}

/// One image a file and decoding, however many textures look it up.
std::shared_ptr<const ColorImage> shared_image(Plugin& plugin, const std::filesystem::path& file,
                                               const Decoding& decoding) {
    const std::string key = fmt::format("{}|{}|{}", file.string(), static_cast<int>(decoding.by), decoding.power);
    std::shared_ptr<const ColorImage>& image = plugin.source.images[key];
    if (!image) image = std::make_shared<const ColorImage>(read_scene_image(plugin, file, decoding));
    return image;
}

TextureWrap read_wrap(Plugin& plugin, const std::string& name, TextureWrap missing) {
    const auto text = plugin.properties.text(name);
    if (!text) return missing;
    std::vector<std::pair<std::string_view, TextureWrap>> known{
        {"repeat", TextureWrap::Repeat}, {"mirror", TextureWrap::Mirror}, {"clamp", TextureWrap::Clamp}};
    if (plugin.is_version_06()) {
        known.emplace_back("zero", TextureWrap::Zero);
        known.emplace_back("one", TextureWrap::One);
    }
    std::vector<std::string_view> names;
    for (const auto& [known_name, wrap] : known) {
        if (*text == known_name) return wrap;
        names.push_back(known_name);
    }
    throw InputError(plugin.properties.place_of(name), unknown_name(name, *text, names));
}

/// What filters over a pixel in 0.6 is bilinear at a point of it.
bool read_is_nearest(Plugin& plugin) {
    std::vector<std::string_view> known{"bilinear", "nearest"};
    if (plugin.is_version_06()) known = {"ewa", "trilinear", "nearest", "bilinear"};
    const std::string filter = plugin.properties.text("filter_type").value_or("bilinear");
    if (std::find(known.begin(), known.end(), filter) == known.end())
        throw InputError(plugin.properties.place_of("filter_type"), unknown_name("filter_type", filter, known));
    return filter == "nearest";
}

/// The index that is looked up for one beyond the edge; none where a constant is.
std::optional<std::size_t> wrapped(double index, int size, TextureWrap wrap) {
    const double last = size - 1;
    switch (wrap) {
        case TextureWrap::Repeat:
            return static_cast<std::size_t>(index - std::floor(index / size) * size);
        case TextureWrap::Clamp:
            return static_cast<std::size_t>(std::clamp(index, 0.0, last));
        case TextureWrap::Mirror: {
            const double twice = index - std::floor(index / (2.0 * size)) * (2.0 * size);
            return static_cast<std::size_t>(twice < size ? twice : 2.0 * size - 1.0 - twice);
        }
        default:
            break;
    }
    return index >= 0.0 && index <= last ? std::optional(static_cast<std::size_t>(index)) : std::nullopt;
}

/// Whole repeats are taken off first, so that far coordinates keep their precision.
double in_pixels(double coordinate, int size, TextureWrap wrap) {
    if (wrap == TextureWrap::Repeat) coordinate -= std::floor(coordinate);
    if (wrap == TextureWrap::Mirror) coordinate -= 2.0 * std::floor(0.5 * coordinate);
    return std::clamp(coordinate, -2.0, 3.0) * size;
}

}  // namespace

/// The four pixels around a point, and where it is between them.
struct Bitmap::Corners {
    ColorD upper_left, upper_right, lower_left, lower_right;
    double right_share, lower_share;
};

ColorD Bitmap::pixel(double column, double row) const {
    const auto x = wrapped(column, image->width, wrap_u);
    const auto y = wrapped(row, image->height, wrap_v);
    if (!x) return ColorD(wrap_u == TextureWrap::One ? 1.0 : 0.0);
    if (!y) return ColorD(wrap_v == TextureWrap::One ? 1.0 : 0.0);
    return ColorD(image->pixels[*y * static_cast<std::size_t>(image->width) + *x]);
}

Bitmap::Corners Bitmap::corners_at(const Imath::V2f& texture_coordinate) const {
    const VectorD uv = transform_point(to_uv, {texture_coordinate.x, texture_coordinate.y, 0.0});
    const double x = in_pixels(uv.x, image->width, wrap_u) - 0.5;
    const double y = in_pixels(uv.y, image->height, wrap_v) - 0.5;
    const double left = std::floor(x);
    const double top = std::floor(y);
    return {pixel(left, top), pixel(left + 1.0, top), pixel(left, top + 1.0), pixel(left + 1.0, top + 1.0), x - left,
            y - top};
}

Color Bitmap::color_at(const Imath::V2f& texture_coordinate) const {
    if (is_nearest) {
        const VectorD uv = transform_point(to_uv, {texture_coordinate.x, texture_coordinate.y, 0.0});
        return Color(pixel(std::floor(in_pixels(uv.x, image->width, wrap_u)),
                           std::floor(in_pixels(uv.y, image->height, wrap_v))));
    }
    const Corners at = corners_at(texture_coordinate);
    const ColorD upper = at.upper_left * (1.0 - at.right_share) + at.upper_right * at.right_share;
    const ColorD lower = at.lower_left * (1.0 - at.right_share) + at.lower_right * at.right_share;
    return Color(upper * (1.0 - at.lower_share) + lower * at.lower_share);
}

TextureGradient Bitmap::gradient_at(const Imath::V2f& texture_coordinate) const {
    if (is_nearest) return {};
    const Corners at = corners_at(texture_coordinate);
    const ColorD by_x = ((at.upper_right - at.upper_left) * (1.0 - at.lower_share) +
                         (at.lower_right - at.lower_left) * at.lower_share) *
                        static_cast<double>(image->width);
    const ColorD by_y = ((at.lower_left - at.upper_left) * (1.0 - at.right_share) +
                         (at.lower_right - at.upper_right) * at.right_share) *
                        static_cast<double>(image->height);
    return {by_x * to_uv[0][0] + by_y * to_uv[0][1], by_x * to_uv[1][0] + by_y * to_uv[1][1]};
}

Color Bitmap::largest() const {
    Color result = image->pixels.front();
    for (const Color& pixel : image->pixels)
        for (int channel = 0; channel < 3; ++channel) result[channel] = std::max(result[channel], pixel[channel]);
    return result;
}

Bitmap Bitmap::read(Plugin& plugin) {
    const std::filesystem::path file = plugin.require_file();
    plugin.require_no_objects();
    Bitmap bitmap;
    bitmap.to_uv = read_uv_transform(plugin);
    bitmap.file = file.string();
    const TextureWrap wrap = read_wrap(plugin, "wrap_mode", TextureWrap::Repeat);
    bitmap.wrap_u = plugin.is_version_06() ? read_wrap(plugin, "wrap_mode_u", wrap) : wrap;
    bitmap.wrap_v = plugin.is_version_06() ? read_wrap(plugin, "wrap_mode_v", wrap) : wrap;
    bitmap.is_nearest = read_is_nearest(plugin);
    const Decoding decoding = read_decoding(plugin);
    plugin.pass_over({"format"}, "values are kept as 32-bit floats");
    plugin.require_all_known();
    bitmap.image = shared_image(plugin, file, decoding);
    return bitmap;
}

void Bitmap::check(const std::string& place) const {
    for (const Color& pixel : image->pixels)
        if (!is_finite(pixel) || std::min({pixel.x, pixel.y, pixel.z}) < 0.0f || max_channel(pixel) > 1.0f)
            throw InputError(place, fmt::format("{}: expected reflectances in [0, 1], got {} {} {}", file, pixel.x,
                                                pixel.y, pixel.z));
}

}  // namespace photonlab
