// Radius rules: how a gather radius changes from pass to pass. "alpha" means something slightly different in each that
// has it, so they are named and cited; equal initial radii are not equal rules.
//
// Every rule is fed what a pass found with the radius before it, and decides the radius of the next: so a pass's own
// estimate is unbiased wherever blurring changes nothing, whatever the rule (docs/theory.md, section 9).
//
// A rule holds what it accumulates for all regions of a method; a region is a hit point, or a pixel where hit points
// are new in every pass. Adding a rule: its name here, a class, a line in make_radius_rule(), and the tests over all
// names have it.

#pragma once

#include <array>
#include <cstdint>
#include <memory>

#include "core/files/state_archive.h"
#include "core/math.h"
#include "core/text/names.h"
#include "gather/kernel.h"
#include "gather/moments.h"

namespace photonlab {

/// What a region accumulates over the passes under every rule. Lengths in units of the scene's box; where regions are
/// pixels, in shares of each hit point's initial radius.
struct GatherStatistics {
    double squared_radius = 0.0;    ///< for the next pass
    double count = 0.0;             ///< Hachisuka's N: photons kept so far; other rules: photons seen so far
    ColorD estimate = ColorD(0.0);  ///< running mean over passes of the pass's own density estimate (docs/theory.md,
                                    ///< section 1)
};

enum class ScheduleName { Hachisuka, KnausZwicker, Adaptive, ChiSquare, FTest };

inline constexpr std::array schedule_names{ChoiceName<ScheduleName>{ScheduleName::Hachisuka, "hachisuka"},
                                           ChoiceName<ScheduleName>{ScheduleName::KnausZwicker, "knaus-zwicker"},
                                           ChoiceName<ScheduleName>{ScheduleName::Adaptive, "adaptive"},
                                           ChoiceName<ScheduleName>{ScheduleName::ChiSquare, "chi-square"},
                                           ChoiceName<ScheduleName>{ScheduleName::FTest, "f-test"}};
constexpr const auto& choice_names(ScheduleName) {
    return schedule_names;
}

/// What schedule "chi-square" tests the counts against.
enum class TestVariant {
    Plain,      ///< uniform
    LinearFit,  ///< the linear density that fits them best
    Pooled,     ///< uniform, opposite sectors taken together, so that a linear density passes
};
inline constexpr std::array test_variant_names{ChoiceName<TestVariant>{TestVariant::Plain, "plain"},
                                               ChoiceName<TestVariant>{TestVariant::LinearFit, "linear-fit"},
                                               ChoiceName<TestVariant>{TestVariant::Pooled, "pooled"}};
constexpr const auto& choice_names(TestVariant) {
    return test_variant_names;
}

struct RadiusRuleSettings {
    ScheduleName schedule = ScheduleName::Hachisuka;
    double alpha = 0.7;
    Kernel kernel = Kernel::Disc;
    double kappa = 6.0;              ///< adaptive_radius.h
    double smallest_radius = 0.125;  ///< of "adaptive", in initial radii
    double largest_radius = 2.0;     ///< likewise
    TestVariant variant = TestVariant::Plain;
    double test_photons = 10.0;  ///< disc_tests.h
    double test_shrink = 0.8;
    double test_growth = 1.5625;
};

/// What one pass brings to one region.
struct PassGather {
    std::uint64_t pass = 1;                ///< its number, from 1
    std::uint64_t passes = 1;              ///< taken by this region so far, with this one
    double found = 0.0;                    ///< photons within the radius
    ColorD estimate = ColorD(0.0);         ///< the pass's own density estimate, with the radius before it changes
    double initial_squared_radius = 1.0;   ///< of the region, before the first pass
    const Curvature* curvature = nullptr;  ///< there for a rule that wants it
    const Sectors* sectors = nullptr;      ///< likewise
};

class RadiusRule {
public:
    virtual ~RadiusRule() = default;

    virtual bool wants_curvature() const { return false; }
    virtual bool wants_sectors() const { return false; }

    /// Sets the squared radius and the count of `statistics`, which are those of the region with this index. Regions
    /// are independent of each other, and may be taken on any thread.
    virtual void take(std::size_t region, const PassGather& gathered, GatherStatistics& statistics) = 0;

    /// Factor on the squared radius after pass `pass`, where it depends on nothing else: such passes can begin
    /// anywhere.
    virtual double shrink_after(std::uint64_t pass) const;

    /// What it accumulates; between two passes.
    virtual void exchange(StateArchive& archive) = 0;
    virtual std::uint64_t bytes() const { return 0; }
};

std::unique_ptr<RadiusRule> make_radius_rule(const RadiusRuleSettings& settings, std::size_t regions);

/// True when radii depend on the number of the pass alone.
inline bool is_blind(ScheduleName schedule) {
    return schedule == ScheduleName::KnausZwicker;
}

/// True when radii shrink where a test finds that photons do not lie evenly in the disc.
inline bool tests_its_disc(ScheduleName schedule) {
    return schedule == ScheduleName::ChiSquare || schedule == ScheduleName::FTest;
}

/// Factor on the squared radius after a pass in which `found` new photons joined `count` kept ones:
/// rho = (N + alpha M) / (N + M), and 1 when N + M = 0.
/// [Hachisuka et al. 2008, equation for the radius reduction]
double hachisuka_shrink(double alpha, double count, double found);

/// Factor on the squared radius after pass `pass` (from 1): r_{i+1}^2 / r_i^2 = (i + alpha) / (i + 1).
/// [Knaus & Zwicker 2011]
double knaus_zwicker_shrink(double alpha, std::uint64_t pass);

/// Changes the radius by the rule, to `least_squared_radius` and no further.
void take_radius(GatherStatistics& statistics, RadiusRule& rule, std::size_t region, const PassGather& gathered,
                 double least_squared_radius);

/// Takes a pass: the estimate is the running mean of the passes' own, which needs no product of a million factors
/// (docs/theory.md, section 1), and the radius changes by the rule, to `least_squared_radius` and no further. A pass
/// without photons counts.
void take_pass(GatherStatistics& statistics, RadiusRule& rule, std::size_t region, const PassGather& gathered,
               double least_squared_radius);

}  // namespace photonlab
