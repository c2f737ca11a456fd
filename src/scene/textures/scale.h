// Another texture, or one colour, times a factor.

#pragma once

#include <memory>

#include "scene/textures/texture_kind.h"

namespace photonlab {

struct Scale {
    static constexpr const char* name = "scale";

    std::shared_ptr<const NestedTexture> nested;  ///< null: `factor` alone
    Color factor = Color(1.0f);

    Color color_at(const Imath::V2f& texture_coordinate) const;
    TextureGradient gradient_at(const Imath::V2f& texture_coordinate) const;
    Color largest() const;
    static Scale read(Plugin& plugin);
    void check(const std::string& place) const;
};

}  // namespace photonlab
