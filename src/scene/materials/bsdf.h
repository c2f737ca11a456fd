// What every material's BSDF speaks in: directions are unit, in the local frame of the shading normal (z along it), and
// all point away from the surface: `outgoing` to where the path came from, `incoming` to where it goes on. A BSDF is
// asked only for outgoing directions with outgoing.z > 0; whoever asks turns it over first (orient() in scene.h).

#pragma once

#include <array>
#include <optional>

#include "core/math.h"

namespace photonlab {

/// What a path carries. Camera paths carry radiance, which refraction compresses with the square of the index; photons
/// carry flux, which it leaves alone. [Veach 1997, section 5.2]
enum class Carried { Radiance, Flux };

/// A direction drawn from a BSDF.
struct BsdfSample {
    Vector incoming;       ///< unit, local frame
    Color weight;          ///< f |cos| / density: what the path's throughput is multiplied by
    float density = 0.0f;  ///< per steradian; 0 for a specular direction, which no other technique finds
};

/// One of the directions in which specular light goes on.
struct SpecularBranch {
    Vector incoming;  ///< unit, local frame
    Color weight;     ///< what the path's throughput is multiplied by
};

/// All of them: reflection, refraction or both.
struct SpecularBranches {
    std::array<SpecularBranch, 2> branch;
    int count = 0;

    void add(const Vector& incoming, const Color& weight) {
        branch[static_cast<std::size_t>(count++)] = {incoming, weight};
    }
    const SpecularBranch* begin() const { return branch.data(); }
    const SpecularBranch* end() const { return branch.data() + count; }
};

}  // namespace photonlab
