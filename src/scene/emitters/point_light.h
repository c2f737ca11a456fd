// A point that shines alike in all directions.

#pragma once

#include "core/sampling.h"
#include "scene/emitters/light_kind.h"

namespace photonlab {

struct PointLight;

struct PointLightDescription {
    VectorD position;
    ColorD intensity;  ///< W/sr
    std::string place;
    double sampling_weight = 1.0;

    void check() const;
    Bounds bounds() const { return {position, position}; }
    PointLight placed(const SceneExtent& extent) const;
};

struct PointLight {
    static constexpr const char* name = "point";
    static constexpr bool is_met_by_rays = false;
    using Description = PointLightDescription;

    ColorD intensity;  ///< power per steradian
    Vector position;

    static PointLightDescription read(LightReader& reader);

    ColorD power(const std::vector<Shape>&) const { return intensity * (4.0 * pi); }
    Emission emit(const std::vector<Shape>&, const EmissionDraw& draw) const;
    std::optional<DirectSample> sample_direct(const std::vector<Shape>&, const Vector& receiver, const Imath::V2f&,
                                              double) const;
};

inline Emission PointLight::emit(const std::vector<Shape>&, const EmissionDraw& draw) const {
    return {{position, sample_unit_sphere(draw.u_direction)}};
}

}  // namespace photonlab
