// Light that comes from one direction, as from a sun without width.

#pragma once

#include "scene/emitters/infinity/from_infinity.h"

namespace photonlab {

struct Directional;

struct DirectionalDescription {
    VectorD direction;  ///< unit, along which light travels
    ColorD irradiance;  ///< W/m^2, on a surface across it
    std::string place;
    double sampling_weight = 1.0;

    void check() const;
    Bounds bounds() const { return {}; }
    Directional placed(const SceneExtent& extent) const;
};

struct Directional {
    static constexpr const char* name = "directional";
    static constexpr bool is_met_by_rays = false;
    using Description = DirectionalDescription;

    Vector direction;
    ColorD irradiance;
    EntryDiscs discs;

    static DirectionalDescription read(LightReader& reader);

    ColorD power(const std::vector<Shape>&) const { return irradiance * discs.area(); }
    Emission emit(const std::vector<Shape>&, const EmissionDraw& draw) const;
    std::optional<DirectSample> sample_direct(const std::vector<Shape>&, const Vector& receiver, const Imath::V2f&,
                                              double) const;
};

}  // namespace photonlab
