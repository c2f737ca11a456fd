// A point that shines into a cone, brightest inside its beam.

#pragma once

#include <memory>

#include "scene/emitters/light_kind.h"
#include "scene/textures/texture.h"

namespace photonlab {

struct Spot;

struct SpotDescription {
    VectorD position;
    TextureAxes axes = scene_axes;                ///< unit; the light shines along the third
    ColorD intensity;                             ///< W/sr, inside the beam
    double cutoff_angle = 20.0;                   ///< radians, above 0, below pi; no light beyond
    double beam_angle = 15.0;                     ///< radians, at most cutoff_angle; linear in the angle in between
    std::shared_ptr<const Texture> texture = {};  ///< a factor by direction, whose square the cone fills; or none
    std::string place;
    double sampling_weight = 1.0;

    void check() const;
    Bounds bounds() const { return {position, position}; }
    Spot placed(const SceneExtent& extent) const;
};

struct Spot {
    static constexpr const char* name = "spot";
    static constexpr bool is_met_by_rays = false;
    using Description = SpotDescription;

    Vector position;
    TextureAxes axes;
    ColorD intensity;  ///< power per steradian
    double cutoff_angle;
    double beam_angle;
    std::shared_ptr<const Texture> texture;
    double texture_tangent;  ///< half the width of the texture's square at distance 1
    ColorD all;              ///< power

    static SpotDescription read(LightReader& reader);

    ColorD power(const std::vector<Shape>&) const { return all; }
    ColorD intensity_along(const VectorD& direction) const;  ///< unit, away from the light
    Emission emit(const std::vector<Shape>&, const EmissionDraw& draw) const;
    std::optional<DirectSample> sample_direct(const std::vector<Shape>&, const Vector& receiver, const Imath::V2f&,
                                              double) const;
};

}  // namespace photonlab
