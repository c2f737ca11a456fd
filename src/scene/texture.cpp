#include "scene/texture.h"

#include "scene/mitsuba/transform.h"

namespace photonlab {

Color Texture::color_at(const Imath::V2f& texture_coordinate) const {
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

}  // namespace photonlab
