// An image on a surface: looked up by texture coordinate, bilinear between pixel centres or the nearest pixel alone.

#pragma once

#include <memory>

#include "image/read_image.h"
#include "scene/textures/texture_kind.h"

namespace photonlab {

/// What is beyond the image's edges.
enum class TextureWrap { Repeat, Mirror, Clamp, Zero, One };

/// The image's first row is at v = 0, its left edge at u = 0, as Mitsuba has it.
struct Bitmap {
    static constexpr const char* name = "bitmap";

    std::shared_ptr<const ColorImage> image;  ///< shared by all that look up the same file in the same way
    Matrix to_uv;                             ///< applied to (u, v, 0) before the look-up
    std::string file = {};                    ///< for messages
    TextureWrap wrap_u = TextureWrap::Repeat;
    TextureWrap wrap_v = TextureWrap::Repeat;
    bool is_nearest = false;

    Color color_at(const Imath::V2f& texture_coordinate) const;
    TextureGradient gradient_at(const Imath::V2f& texture_coordinate) const;
    Color largest() const;
    static Bitmap read(Plugin& plugin);
    void check(const std::string& place) const;

private:
    struct Corners;
    Corners corners_at(const Imath::V2f& texture_coordinate) const;
    ColorD pixel(double column, double row) const;
};

}  // namespace photonlab
