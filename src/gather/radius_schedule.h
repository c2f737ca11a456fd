// Radius schedules: how a gather radius shrinks from pass to pass. "alpha" means something slightly different in each,
// so they are named and cited; equal initial radii are not equal schedules.
//
// A schedule is a value with its own state, chosen by name. Hachisuka's state is in each hit point (its photon count);
// Knaus and Zwicker's is one factor for the whole image, a function of the pass alone.

#pragma once

#include <array>
#include <cstdint>

#include "core/math.h"
#include "core/text/names.h"

namespace photonlab {

/// What a hit point accumulates over the passes. Lengths in units of the scene's box.
struct GatherStatistics {
    double squared_radius = 0.0;    ///< for the next pass
    double count = 0.0;             ///< Hachisuka's N: photons kept so far; other schedules: photons seen so far
    ColorD estimate = ColorD(0.0);  ///< running mean over passes of the pass's own density estimate (docs/theory.md,
                                    ///< section 1)
};

enum class ScheduleName { Hachisuka, KnausZwicker };

inline constexpr std::array schedule_names{ChoiceName<ScheduleName>{ScheduleName::Hachisuka, "hachisuka"},
                                           ChoiceName<ScheduleName>{ScheduleName::KnausZwicker, "knaus-zwicker"}};
constexpr const auto& choice_names(ScheduleName) {
    return schedule_names;
}

/// Factor on the squared radius after a pass in which `found` new photons joined `count` kept ones:
/// rho = (N + alpha M) / (N + M), and 1 when N + M = 0.
/// [Hachisuka et al. 2008, equation for the radius reduction]
double hachisuka_shrink(double alpha, double count, double found);

/// Factor on the squared radius after pass `pass` (from 1): r_{i+1}^2 / r_i^2 = (i + alpha) / (i + 1).
/// [Knaus & Zwicker 2011]
double knaus_zwicker_shrink(double alpha, std::uint64_t pass);

/// What one pass brings to one hit point.
struct PassGather {
    std::uint64_t pass = 1;         ///< its number, from 1
    std::uint64_t passes = 1;       ///< taken by this hit point so far, with this one
    double found = 0.0;             ///< photons within the radius
    ColorD estimate = ColorD(0.0);  ///< the pass's own density estimate, with the radius before it shrinks
};

/// Takes a pass: the estimate is the running mean of the passes' own, which needs no product of a million factors
/// (docs/theory.md, section 1), and the radius shrinks by the schedule, to `least_squared_radius` and no further. A
/// pass without photons counts.
void take_pass(GatherStatistics& statistics, ScheduleName schedule, double alpha, const PassGather& gathered,
               double least_squared_radius);

}  // namespace photonlab
