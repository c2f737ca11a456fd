// Rough and layered materials, made without a file.

#pragma once

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "scene/materials/material.h"

namespace photonlab {

inline Material rough_plastic(const Microfacets& facets, const Color& diffuse, bool nonlinear = false) {
    const auto coats =
        std::make_shared<const RoughCoats>(make_rough_coats(facets.slopes, Imath::V2f(facets.alpha_u), 1.49, false));
    RoughPlastic plastic{
        .facets = facets, .diffuse_reflectance = diffuse, .coats = coats.get(), .nonlinear = nonlinear};
    Material material{.id = "rough plastic", .bsdf = plastic};
    material.data = coats;
    return material;
}

/// Metal or glass whose roughness depends on the direction.
inline Material anisotropic(const Bsdf& bsdf) {
    return {.id = "anisotropic", .bsdf = bsdf, .is_anisotropic = true};
}

inline Plastic plastic_of(const Color& diffuse, bool nonlinear = false) {
    return {.inner_reflectance = static_cast<float>(inner_reflectance_of(1.49)),
            .nonlinear = nonlinear,
            .diffuse_reflectance = diffuse};
}

inline Material made_of(std::vector<Material> parts, const std::function<Bsdf(const std::vector<Material>&)>& make) {
    const auto kept = std::make_shared<const std::vector<Material>>(std::move(parts));
    Material material{.id = "made", .bsdf = make(*kept)};
    material.data = kept;
    return material;
}

inline Material coated(const Material& inner, const Color& absorption = Color(0.0f)) {
    return made_of({inner}, [&](const auto& parts) {
        Coating coating;
        coating.inner.material = &parts[0];
        coating.absorption = absorption;
        return Bsdf(coating);
    });
}

inline Material masked(const Material& inner, const Color& opacity) {
    return made_of({inner}, [&](const auto& parts) {
        Mask mask;
        mask.inner.material = &parts[0];
        mask.opacity = opacity;
        return Bsdf(mask);
    });
}

inline Material blended(const Material& first, const Material& second, float weight) {
    return made_of({first, second}, [&](const auto& parts) {
        Blend blend;
        blend.first.material = &parts[0];
        blend.second.material = &parts[1];
        blend.weight = weight;
        return Bsdf(blend);
    });
}

inline const Material grey{.id = "grey", .bsdf = Diffuse{Color(0.6f, 0.4f, 0.2f)}};

}  // namespace photonlab
