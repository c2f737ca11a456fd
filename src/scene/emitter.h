// Light sources: choosing one by power, and drawing where on it and in which direction light leaves.
//
// The choice is by mean_channel(power), so it does not change when all light is multiplied by a constant.

#pragma once

#include <cstdint>
#include <optional>

#include "core/math.h"
#include "scene/scene.h"

namespace photonlab {

/// Index of the emitter chosen by power; u in [0, 1). The scene must have one.
std::uint32_t choose_emitter(const Scene& scene, double u);

/// Light leaving an emitter: the start of a photon path.
struct EmissionSample {
    Ray ray;       ///< its origin already moved off the emitter's surface
    Color weight;  ///< flux of this sample relative to Scene::total_power, the choice of light included: its mean over
                   ///< samples and channels is 1, but for surfaces beyond the unit box that light from infinity reaches
};

/// Emits from `emitter`, by its power.
EmissionSample sample_emission(const Scene& scene, std::uint32_t emitter, const Imath::V2f& u_position,
                               double u_triangle, const Imath::V2f& u_direction);

/// Draws light of `emitter` for `receiver`: of spheres by the solid angle of their visible cap, of other shapes uniform
/// in area, of an image around the scene by its brightness, of one colour around it by solid angle; of what has no size
/// the one direction. Empty when what was drawn does not shine at the receiver.
std::optional<DirectSample> sample_direct(const Scene& scene, std::uint32_t emitter, const Vector& receiver,
                                          const Imath::V2f& u, double u_triangle);

/// Density per steradian with which sample_direct() draws, from `receiver`, the emitting point at `hit` that was found
/// in `direction` (unit): without the choice of light; 0 when the shape does not emit that way.
double direct_density(const Scene& scene, const Vector& receiver, const Vector& direction, const Hit& hit);

/// Radiance that a ray finds which leaves the scene along `direction` (unit).
ColorD escaped_radiance(const Scene& scene, const Vector& direction);

/// Density per steradian with which sample_direct() draws that direction for the light there: without the choice of
/// light; 0 where there is none.
double escaped_density(const Scene& scene, const Vector& direction);

/// Radiance that leaves the hit point towards `outgoing` (unit, away from the surface); 0 where nothing emits.
ColorD emitted_radiance(const Scene& scene, const Hit& hit, const Vector& outgoing);

/// Radiance that a ray along `direction` (unit) finds at what it meets; `hit` is empty where it leaves the scene.
ColorD met_radiance(const Scene& scene, const std::optional<Hit>& hit, const Vector& direction);

}  // namespace photonlab
