// Light that comes alike from everywhere around the scene.

#pragma once

#include "scene/emitters/infinity/from_infinity.h"

namespace photonlab {

struct Constant;

struct ConstantDescription {
    ColorD radiance;  ///< W/(m^2 sr)
    std::string place;
    double sampling_weight = 1.0;

    void check() const { require_light(radiance, place, "radiance"); }
    Bounds bounds() const { return {}; }
    Constant placed(const SceneExtent& extent) const;
};

struct Constant {
    static constexpr const char* name = "constant";
    static constexpr bool is_met_by_rays = true;
    using Description = ConstantDescription;

    ColorD radiance;
    EntryDiscs discs;

    static ConstantDescription read(LightReader& reader);

    ColorD power(const std::vector<Shape>&) const { return radiance * (4.0 * pi * discs.area()); }
    Emission emit(const std::vector<Shape>&, const EmissionDraw& draw) const;
    std::optional<DirectSample> sample_direct(const std::vector<Shape>&, const Vector& receiver, const Imath::V2f& u,
                                              double) const;
    ColorD radiance_from(const Vector&) const { return radiance; }
    double density_of(const Vector&) const { return 1.0 / (4.0 * pi); }
};

}  // namespace photonlab
