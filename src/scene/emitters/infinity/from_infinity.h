// Light from infinity as it enters the scene: where on its way to begin with it, and how densely that is drawn.
//
// Light along one direction is spread alike over the plane across it. It is drawn from discs in that plane, all around
// the middle of what the unit box is made for: the first covers that, each further one is four times as wide, and the
// last covers everything. So surfaces that are millions of times larger, such as a ground plane, get their light and
// do not starve the rest, and what they throw back from every distance is found alike.

#pragma once

#include <vector>

#include "scene/emitters/light_kind.h"

namespace photonlab {

struct EntryDiscs {
    VectorD centre;             ///< unit box
    std::vector<double> radii;  ///< rising, at least one

    explicit EntryDiscs(const SceneExtent& extent = {});

    /// Of the first disc: light of irradiance E brings E times this to what the unit box is made for.
    double area() const { return pi * radii.front() * radii.front(); }

    struct Entry {
        Emission emission;
        double density;  ///< per area across the direction
    };
    /// A ray along `direction` (unit), into the scene.
    Entry draw(const Vector& direction, const Imath::V2f& u_position, double u_disc) const;

    /// A point towards the light at `direction` (unit, away from the scene) with nothing of the scene beyond it.
    Vector beyond(const Vector& receiver, const Vector& direction) const;

private:
    double share_of(std::size_t disc) const;
};

}  // namespace photonlab
