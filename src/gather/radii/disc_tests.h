// Radii that shrink when a statistical test finds that photons do not lie evenly in the disc: nothing is done as long
// as the light could be uniform for all that is known.
//
// "chi-square": counts in 12 bins (moments.h) pile up over passes, and are tested at 5% after every pass once there are
// `test_photons` of them. Where all 12 bins could be even, the radius stays and counting goes on. Otherwise the squared
// radius is halved if the 6 inner bins alone could be even, and multiplied by `test_shrink` if not; counts start anew,
// and the number that the next test waits for grows by `test_growth`. Variants: a linear density is fitted first and
// tested against (a linear density leaves no bias), or opposite sectors are pooled, which cancels it.
// After Lin, Li, Zeng, Zhang, Jia, Wang & Zheng 2020, "CPPM: Chi-Squared Progressive Photon Mapping", whose public code
// it follows. Ours: hit points may be fixed, photons count only where they are accepted, and pooling takes the place of
// throwing photons to the opposite side by chance.
//
// "f-test": one-way analysis of variance of the flux that each bin received in each pass since the radius last changed,
// which a few heavy photons, or photons that come in pairs, do not fool. The same steps otherwise, from the fifth pass
// on. After Lin, Hu, Jia & Li 2025 (arXiv 2504.04411). Ours: what a sample is, when a test begins, and the steps.

#pragma once

#include <array>
#include <vector>

#include "gather/radii/radius_rule.h"

namespace photonlab {

/// Counts or fluxes of a disc's bins, the inner ring first.
using Bins = std::array<double, sector_count>;

/// Sum over the first `bins` of (O - N p)^2 / (N p), with N the sum of O; 0 without photons. `shares`: p, sum 1 over
/// those bins.
double chi_square(const Bins& counts, const Bins& shares, std::size_t bins);

/// Shares of the first `bins` (6 or 12) bins under the linear density on their disc that fits the counts best, in the
/// sense of least squares; its slope is capped where the density would be negative at the rim.
Bins linear_shares(const Bins& counts, std::size_t bins);

/// Whether the first `bins` (6 or 12) could be even, at 5%.
bool passes_chi_square(const Bins& counts, std::size_t bins, TestVariant variant);

/// F of the first `bins` bins: each has `samples` (at least 2) values, of which `sums` and `squares` are the sum and
/// the sum of squares. 0 where all values are the same, infinite where only the bins differ.
double f_ratio(const Bins& sums, const Bins& squares, std::size_t bins, double samples);

/// What F of `bins` bins and `samples` values in each exceeds in one case in twenty.
double f_critical(std::size_t bins, double samples);

class ChiSquareRadius : public RadiusRule {
public:
    ChiSquareRadius(const RadiusRuleSettings& settings, std::size_t regions);

    bool wants_sectors() const override { return true; }
    void take(std::size_t region, const PassGather& gathered, GatherStatistics& statistics) override;
    void exchange(StateArchive& archive) override { archive.exchange_as_many(counts_); }
    std::uint64_t bytes() const override { return counts_.size() * sizeof(Counts); }

private:
    struct Counts {
        Bins bins{};
        double awaited = 0.0;  // photons that the next test needs
    };

    const RadiusRuleSettings settings_;
    std::vector<Counts> counts_;
};

class FTestRadius : public RadiusRule {
public:
    FTestRadius(const RadiusRuleSettings& settings, std::size_t regions);

    bool wants_sectors() const override { return true; }
    void take(std::size_t region, const PassGather& gathered, GatherStatistics& statistics) override;
    void exchange(StateArchive& archive) override { archive.exchange_as_many(samples_); }
    std::uint64_t bytes() const override { return samples_.size() * sizeof(Samples); }

    static constexpr std::uint64_t fewest_passes = 5;  ///< that are tested

private:
    struct Samples {
        Bins sums{};
        Bins squares{};
        double passes = 0.0;  // since the radius changed
    };

    double critical(std::size_t bins, double samples) const;

    const RadiusRuleSettings settings_;
    std::vector<double> outer_critical_;  // by samples
    std::vector<double> inner_critical_;
    std::vector<Samples> samples_;
};

}  // namespace photonlab
