#include "gather/radii/disc_tests.h"

#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/fisher_f.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace photonlab {

namespace {

constexpr double significance = 0.05;

/// Integrals of x and y over the bins of the unit disc.
struct BinMoments {
    Bins x{};
    Bins y{};
};

BinMoments make_bin_moments() {
    BinMoments moments;
    const double middle = std::sqrt(0.5);
    for (std::size_t bin = 0; bin < sector_count; ++bin) {
        const bool is_inner = bin < sectors_per_ring;
        const double from = is_inner ? 0.0 : middle;
        const double to = is_inner ? middle : 1.0;
        const double along = (to * to * to - from * from * from) / 3.0;
        const double begin = static_cast<double>(bin % sectors_per_ring) * pi / 3.0;
        const double end = begin + pi / 3.0;
        moments.x[bin] = along * (std::sin(end) - std::sin(begin));
        moments.y[bin] = along * (std::cos(begin) - std::cos(end));
    }
    return moments;
}

double sum_of(const Bins& values, std::size_t bins) {
    return std::accumulate(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(bins), 0.0);
}

Bins even_shares(std::size_t bins) {
    Bins shares{};
    std::fill_n(shares.begin(), bins, 1.0 / static_cast<double>(bins));
    return shares;
}

/// Opposite sectors together: half as many bins.
Bins pooled(const Bins& counts, std::size_t bins) {
    constexpr std::size_t pairs = sectors_per_ring / 2;
    Bins pooled{};
    for (std::size_t bin = 0; bin < bins; ++bin) pooled[bin / sectors_per_ring * pairs + bin % pairs] += counts[bin];
    return pooled;
}

/// By degrees of freedom, up to 11.
const std::array<double, sector_count>& chi_square_criticals() {
    static const std::array<double, sector_count> criticals = [] {
        std::array<double, sector_count> values{};
        for (std::size_t freedom = 1; freedom < values.size(); ++freedom)
            values[freedom] = boost::math::quantile(
                boost::math::complement(boost::math::chi_squared(static_cast<double>(freedom)), significance));
        return values;
    }();
    return criticals;
}

/// The factor on the squared radius of a disc that is not even.
double shrink(bool is_inner_even, double otherwise) {
    return is_inner_even ? 0.5 : otherwise;
}

}  // namespace

double chi_square(const Bins& counts, const Bins& shares, std::size_t bins) {
    const double all = sum_of(counts, bins);
    if (all == 0.0) return 0.0;
    double sum = 0.0;
    for (std::size_t bin = 0; bin < bins; ++bin) {
        const double expected = all * shares[bin];
        sum += (counts[bin] - expected) * (counts[bin] - expected) / expected;
    }
    return sum;
}

Bins linear_shares(const Bins& counts, std::size_t bins) {
    static const BinMoments moments = make_bin_moments();
    // On the inner disc alone, lengths are in units of its own radius: its integrals are as in the unit disc's inner
    // half, times 2^(3/2).
    const double unit = bins == sector_count ? 1.0 : std::sqrt(8.0);
    const double all = sum_of(counts, bins);
    double x = 0.0, y = 0.0, norm = 0.0;
    for (std::size_t bin = 0; bin < bins; ++bin) {
        x += unit * moments.x[bin] * counts[bin];
        y += unit * moments.y[bin] * counts[bin];
        norm += unit * unit * moments.x[bin] * moments.x[bin];
    }
    const double scale = all > 0.0 ? 1.0 / (all * norm) : 0.0;
    const double slope = scale * std::hypot(x, y);
    const double cap = slope > 1.0 / pi ? 1.0 / (pi * slope) : 1.0;
    Bins shares = even_shares(bins);
    for (std::size_t bin = 0; bin < bins; ++bin)
        shares[bin] += cap * scale * unit * (x * moments.x[bin] + y * moments.y[bin]);
    return shares;
}

bool passes_chi_square(const Bins& counts, std::size_t bins, TestVariant variant) {
    const std::array<double, sector_count>& criticals = chi_square_criticals();
    switch (variant) {
        case TestVariant::Plain:
            break;
        case TestVariant::LinearFit:  // two degrees of freedom go into the slope
            return chi_square(counts, linear_shares(counts, bins), bins) < criticals[bins - 3];
        case TestVariant::Pooled:
            return chi_square(pooled(counts, bins), even_shares(bins / 2), bins / 2) < criticals[bins / 2 - 1];
    }
    return chi_square(counts, even_shares(bins), bins) < criticals[bins - 1];
}

double f_ratio(const Bins& sums, const Bins& squares, std::size_t bins, double samples) {
    const double groups = static_cast<double>(bins);
    const double mean = sum_of(sums, bins) / (groups * samples);
    double between = 0.0;
    double within = 0.0;
    for (std::size_t bin = 0; bin < bins; ++bin) {
        const double own = sums[bin] / samples;
        between += samples * (own - mean) * (own - mean);
        within += std::max(0.0, squares[bin] - samples * own * own);
    }
    between /= groups - 1.0;
    within /= groups * (samples - 1.0);
    if (within > 0.0) return between / within;
    return between > 0.0 ? std::numeric_limits<double>::infinity() : 0.0;
}

double f_critical(std::size_t bins, double samples) {
    const double groups = static_cast<double>(bins);
    const boost::math::fisher_f distribution(groups - 1.0, groups * (samples - 1.0));
    return boost::math::quantile(boost::math::complement(distribution, significance));
}

ChiSquareRadius::ChiSquareRadius(const RadiusRuleSettings& settings, std::size_t regions)
    : settings_(settings), counts_(regions) {
    for (Counts& counts : counts_) counts.awaited = settings.test_photons;
}

void ChiSquareRadius::take(std::size_t region, const PassGather& gathered, GatherStatistics& statistics) {
    statistics.count += gathered.found;
    Counts& counts = counts_[region];
    for (std::size_t bin = 0; bin < sector_count; ++bin) counts.bins[bin] += gathered.sectors->count[bin];
    const auto is_even = [&](std::size_t bins) { return passes_chi_square(counts.bins, bins, settings_.variant); };
    if (sum_of(counts.bins, sector_count) < counts.awaited || is_even(sector_count)) return;
    const bool is_inner_even = is_even(sectors_per_ring);
    statistics.squared_radius *= shrink(is_inner_even, settings_.test_shrink);
    counts = {.bins = {}, .awaited = counts.awaited * settings_.test_growth};
}

FTestRadius::FTestRadius(const RadiusRuleSettings& settings, std::size_t regions)
    : settings_(settings), samples_(regions) {
    constexpr std::size_t tabulated = 1024;  // beyond, F hardly depends on it
    outer_critical_.assign(tabulated + 1, 0.0);
    inner_critical_.assign(tabulated + 1, 0.0);
    for (std::size_t samples = fewest_passes; samples <= tabulated; ++samples) {
        outer_critical_[samples] = f_critical(sector_count, static_cast<double>(samples));
        inner_critical_[samples] = f_critical(sectors_per_ring, static_cast<double>(samples));
    }
}

double FTestRadius::critical(std::size_t bins, double samples) const {
    const std::vector<double>& table = bins == sector_count ? outer_critical_ : inner_critical_;
    return table[std::min(static_cast<std::size_t>(samples), table.size() - 1)];
}

void FTestRadius::take(std::size_t region, const PassGather& gathered, GatherStatistics& statistics) {
    statistics.count += gathered.found;
    Samples& samples = samples_[region];
    samples.passes += 1.0;
    for (std::size_t bin = 0; bin < sector_count; ++bin) {
        const double flux = gathered.sectors->flux[bin];
        samples.sums[bin] += flux;
        samples.squares[bin] += flux * flux;
    }
    const auto is_even = [&](std::size_t bins) {
        return f_ratio(samples.sums, samples.squares, bins, samples.passes) < critical(bins, samples.passes);
    };
    if (samples.passes < static_cast<double>(fewest_passes) || is_even(sector_count)) return;
    statistics.squared_radius *= shrink(is_even(sectors_per_ring), settings_.test_shrink);
    samples = {};
}

}  // namespace photonlab
