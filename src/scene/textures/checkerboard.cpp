#include "scene/textures/checkerboard.h"

#include <fmt/format.h>

#include "core/error.h"
#include "scene/mitsuba/transform.h"
#include "scene/textures/uv_transform.h"

namespace photonlab {

Color Checkerboard::color_at(const Imath::V2f& texture_coordinate) const {
    const VectorD uv = transform_point(to_uv, {texture_coordinate.x, texture_coordinate.y, 0.0});
    const auto is_upper = [](double x) { return x - std::floor(x) > 0.5; };
    return is_upper(uv.x) == is_upper(uv.y) ? first : second;
}

/// Mitsuba 3 has color0 where one coordinate is in its upper half, 0.6 where both or neither are.
Checkerboard Checkerboard::read(Plugin& plugin) {
    plugin.require_no_objects();
    Checkerboard board{.first = Color(plugin.properties.reflectance("color0").value_or(ColorD(0.4))),
                       .second = Color(plugin.properties.reflectance("color1").value_or(ColorD(0.2))),
                       .to_uv = read_uv_transform(plugin)};
    if (!plugin.is_version_06()) std::swap(board.first, board.second);
    return board;
}

void Checkerboard::check(const std::string& place) const {
    for (const Color& color : {first, second})
        if (!is_finite(color) || std::min({color.x, color.y, color.z}) < 0.0f || max_channel(color) > 1.0f)
            throw InputError(place, fmt::format("checkerboard: expected reflectances in [0, 1], got {} {} {}", color.x,
                                                color.y, color.z));
}

}  // namespace photonlab
