#include "scene/textures/checkerboard.h"

#include <fmt/format.h>

#include "core/error.h"
#include "scene/mitsuba/transform.h"
#include "scene/textures/uv_transform.h"

namespace photonlab {

Color Checkerboard::color_at(const Imath::V2f& texture_coordinate) const {
    const VectorD uv = transform_point(to_uv, {texture_coordinate.x, texture_coordinate.y, 0.0});
    const auto is_upper = [&](double x) {
        if (is_mirrored) return std::fmod(std::trunc(2.0 * x), 2.0) != 0.0;
        return x - std::floor(x) > 0.5;
    };
    return is_upper(uv.x) == is_upper(uv.y) ? first : second;
}

Checkerboard Checkerboard::read(Plugin& plugin) {
    plugin.require_no_objects();
    return {.first = Color(plugin.color("color0").value_or(ColorD(0.4))),
            .second = Color(plugin.color("color1").value_or(ColorD(0.2))),
            .to_uv = read_uv_transform(plugin),
            .is_mirrored = plugin.is_version_06()};
}

void Checkerboard::check(const std::string& place) const {
    for (const Color& color : {first, second})
        if (!is_finite(color) || std::min({color.x, color.y, color.z}) < 0.0f || max_channel(color) > 1.0f)
            throw InputError(place, fmt::format("checkerboard: expected reflectances in [0, 1], got {} {} {}", color.x,
                                                color.y, color.z));
}

}  // namespace photonlab
