// Density estimation through PhotonMap against exact expectations (docs/theory.md, sections 1 and 4).
//
// All draws are seeded, so a result never changes by itself. Each comparison is a z-test at |z| < 4.5: with other
// seeds, and all being well, one would fail with a probability of 7e-6; there are about sixty here. Where a wrong
// formula is named, the test also states that it would have been told apart.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "core/random.h"
#include "core/sampling.h"
#include "gather/kernel.h"
#include "gather/map/photon_map.h"
#include "gather/radii/radius_rule.h"

namespace photonlab {
namespace {

constexpr double z_limit = 4.5;

const Vector up(0.0f, 0.0f, 1.0f);
const Vector sideways(1.0f, 0.0f, 0.0f);

/// Mean, variance and fourth central moment of independent draws.
class Sample {
public:
    void add(double value) { values_.push_back(value); }
    double mean() const {
        double sum = 0.0;
        for (const double value : values_) sum += value;
        return sum / count();
    }
    double moment(int power) const {
        const double centre = mean();
        double sum = 0.0;
        for (const double value : values_) sum += std::pow(value - centre, power);
        return sum / count();
    }
    /// Of the mean against `expected`, in standard errors.
    double z_of_mean(double expected) const { return (mean() - expected) / std::sqrt(moment(2) / (count() - 1.0)); }
    /// Of the variance against `expected`, in standard errors.
    double z_of_variance(double expected) const {
        const double variance = moment(2) * count() / (count() - 1.0);
        return (variance - expected) / std::sqrt((moment(4) - variance * variance) / count());
    }

private:
    double count() const { return static_cast<double>(values_.size()); }
    std::vector<double> values_;
};

/// Of a count against Binomial(trials, probability), in standard deviations.
double binomial_z(double count, double trials, double probability) {
    return (count - trials * probability) / std::sqrt(trials * probability * (1.0 - probability));
}

Photon photon_at(const Vector& position, const Vector& normal = up, const Vector& incoming = up) {
    return {.position = position,
            .power = Color(1.0f),
            .incoming = PackedDirection(incoming),
            .normal = CoarseDirection(normal),
            .edges = 1};
}

/// Uniform on the unit square [-1/2, 1/2]^2 at z = 0: density 1 with `count` photons of power 1 / count.
std::vector<Photon> photons_on_the_unit_square(std::size_t count, std::uint64_t draw) {
    std::vector<Photon> photons;
    photons.reserve(count);
    RandomStream random(21, RandomPurpose::Test, 0, draw);
    for (std::size_t i = 0; i < count; ++i) {
        const float x = random.next() - 0.5f;
        photons.push_back(photon_at(Vector(x, random.next() - 0.5f, 0.0f)));
    }
    return photons;
}

double count_within(const PhotonMap& map, const Vector& position, const Vector& normal, double radius) {
    double count = 0.0;
    map.within(position, normal, radius, [&](const Photon&, double) { ++count; });
    return count;
}

/// Share of a disc of radius 1 that lies on the near side of a straight edge at distance t in [0, 1].
double share_beside_an_edge(double t) {
    return 1.0 - (std::acos(t) - t * std::sqrt(1.0 - t * t)) / pi;
}

// ---------------------------------------------------------------------------------------------------------------------
// A fixed radius

TEST(CountInADisc, IsBinomial) {
    constexpr std::size_t photons = 500;
    constexpr double radius = 0.2;
    const double probability = pi * radius * radius;
    Sample counts;
    for (std::uint64_t draw = 0; draw < 4000; ++draw)
        counts.add(
            count_within(PhotonMap(photons_on_the_unit_square(photons, draw)), Vector(0.1f, -0.05f, 0.0f), up, radius));
    const double mean = static_cast<double>(photons) * probability;
    EXPECT_LT(std::abs(counts.z_of_mean(mean)), z_limit);
    EXPECT_LT(std::abs(counts.z_of_variance(mean * (1.0 - probability))), z_limit);
    EXPECT_GT(std::abs(counts.z_of_variance(mean)), z_limit) << "a Poisson variance should be told apart";
}

TEST(CountInADisc, LosesTheClosedFormShareBesideAnEdge) {
    constexpr std::size_t photons = 400'000;
    const PhotonMap map(photons_on_the_unit_square(photons, 10'000));
    constexpr double radius = 0.1;
    for (const double t : {0.0, 0.25, 0.5, 0.75, 1.0}) {
        const Vector position(static_cast<float>(-0.5 + t * radius), 0.0f, 0.0f);
        const double distance = (static_cast<double>(position.x) + 0.5) / radius;  // t as the float holds it
        const double share = share_beside_an_edge(std::min(distance, 1.0));
        const double count = count_within(map, position, up, radius);
        EXPECT_LT(std::abs(binomial_z(count, photons, share * pi * radius * radius)), z_limit) << "t = " << t;
    }
    EXPECT_DOUBLE_EQ(share_beside_an_edge(0.0), 0.5);
    EXPECT_LT(std::abs(binomial_z(count_within(map, Vector(-0.5f, 0.5f, 0.0f), up, radius), photons,
                                  0.25 * pi * radius * radius)),
              z_limit);
}

// Floor z = 0 and wall x = 0, both [0, 1] wide and with photons that see both. Without a test of normals the floor's
// estimate takes in the half disc of radius sqrt(r^2 - d^2) that the sphere cuts from the wall.
TEST(ConcaveCorner, LeaksWithoutTheTestOfNormalsAndNotWithIt) {
    constexpr std::size_t floor_photons = 200'000;
    constexpr std::size_t wall_photons = 600'000;
    constexpr double wall_irradiance = 3.0;  // the floor's is 1
    constexpr double radius = 0.1;
    RandomStream random(22, RandomPurpose::Test, 0, 0);
    const Vector diagonal(std::sqrt(0.5f), 0.0f, std::sqrt(0.5f));
    std::vector<Photon> photons;
    for (std::size_t i = 0; i < floor_photons; ++i) {
        const float x = random.next();
        photons.push_back(photon_at(Vector(x, random.next() - 0.5f, 0.0f), up, diagonal));
    }
    for (std::size_t i = 0; i < wall_photons; ++i) {
        const float z = random.next();
        photons.push_back(photon_at(Vector(0.0f, random.next() - 0.5f, z), sideways, diagonal));
    }
    const PhotonMap map(photons);
    for (const float d : {0.0f, 0.03125f, 0.0625f}) {
        const Vector position(d, 0.0f, 0.0f);
        double found = 0.0;
        map.within(position, up, radius, [&](const Photon& photon, double) {
            EXPECT_EQ(photon.normal.unit(), up);
            ++found;
        });
        const double floor_share = share_beside_an_edge(d / radius) * pi * radius * radius;
        EXPECT_LT(std::abs(binomial_z(found, floor_photons, floor_share)), z_limit) << "d = " << d;

        double leaked = 0.0;
        for (const Photon& photon : photons)
            leaked += photon.normal.unit() == sideways &&
                      squared_distance_between(photon.position, position) <= radius * radius;
        const double squared_distance = static_cast<double>(d) * d;
        const double leak = wall_irradiance * (radius * radius - squared_distance) / (2.0 * radius * radius);
        EXPECT_LT(std::abs(binomial_z(leaked, wall_photons, leak / wall_irradiance * pi * radius * radius)), z_limit)
            << "d = " << d;
        EXPECT_GT(leak, 0.5);  // as much as half of the truth: worth the test
    }
}

TEST(Sphere, AChordOfLengthRCapturesTheAreaOfADiscOfRadiusR) {
    constexpr std::size_t photons = 400'000;
    constexpr float sphere_radius = 0.5f;
    RandomStream random(23, RandomPurpose::Test, 0, 0);
    std::vector<Photon> on_the_sphere;
    for (std::size_t i = 0; i < photons; ++i) {
        const Vector normal = -sample_unit_sphere(random.next_2d());  // inwards, as in an integrating sphere
        on_the_sphere.push_back(photon_at(normal * -sphere_radius, normal, normal));
    }
    const PhotonMap map(std::move(on_the_sphere));
    // Up to r = R the normals of all that is captured agree to better than 60 degrees.
    for (const double radius : {0.01, 0.1, 0.3, 0.499})
        for (const Vector& outwards : {up, sideways, Vector(0.6f, 0.0f, -0.8f)}) {
            const double count = count_within(map, outwards * sphere_radius, -outwards, radius);
            EXPECT_LT(std::abs(binomial_z(count, photons, radius * radius / (4.0 * 0.25))), z_limit)
                << "r = " << radius;
        }
}

// ---------------------------------------------------------------------------------------------------------------------
// Kernels

// Density proportional to 1 + 20 (x^2 + y^2): its Laplacian is 80 everywhere and there are no higher terms, so the
// expectation at the centre is 1 + c r^2 80, exactly.
TEST(KernelEstimate, OfAQuadraticDensityHasTheKernelsBias) {
    constexpr std::size_t photons = 200'000;
    constexpr double curvature = 20.0;
    constexpr double total = 1.0 + curvature / 6.0;  // integral over the unit square
    constexpr double radius = 0.4;
    RandomStream random(24, RandomPurpose::Test, 0, 0);
    std::vector<Photon> drawn;
    while (drawn.size() < photons) {
        const float x = random.next() - 0.5f;
        const float y = random.next() - 0.5f;
        const double density = 1.0 + curvature * (static_cast<double>(x) * x + static_cast<double>(y) * y);
        if (random.next_double() * (1.0 + curvature / 2.0) < density) drawn.push_back(photon_at(Vector(x, y, 0.0f)));
    }
    const PhotonMap map(std::move(drawn));

    struct Row {
        Kernel kernel;
        double bias;
    };
    for (const Row& row : {Row{Kernel::Disc, 1.0 / 8.0}, Row{Kernel::Cone, 0.075},
                           Row{Kernel::Epanechnikov, 1.0 / 12.0}, Row{Kernel::Biweight, 1.0 / 16.0}}) {
        double sum = 0.0;
        double sum_of_squares = 0.0;
        map.within(Vector(0.0f), up, radius, [&](const Photon&, double squared_distance) {
            const double value = total *
                                 kernel_weight(row.kernel, std::min(1.0, squared_distance / (radius * radius))) /
                                 (pi * radius * radius);
            sum += value;
            sum_of_squares += value * value;
        });
        const double n = static_cast<double>(photons);
        const double mean = sum / n;
        const double standard_error = std::sqrt((sum_of_squares / n - mean * mean) / n);
        const auto z = [&](double bias) {
            return (mean - (1.0 + bias * radius * radius * 4.0 * curvature)) / standard_error;
        };
        EXPECT_LT(std::abs(z(row.bias)), z_limit) << name_of(row.kernel);
        for (const double other : {1.0 / 8.0, 0.075, 1.0 / 12.0, 1.0 / 16.0})
            if (other != row.bias) {
                EXPECT_GT(std::abs(z(other)), z_limit) << name_of(row.kernel);
            }
    }
}

// ---------------------------------------------------------------------------------------------------------------------
// The k nearest

/// Estimate of the density 1 at the centre of the unit square, as photonmapper makes it: flux of those that carry it.
double nearest_estimate(const PhotonMap& map, std::size_t k, double max_radius, Kernel kernel) {
    double sum = 0.0;
    const NearestPhotons answer = map.nearest(
        Vector(0.0f), up, k, max_radius, [&](const Photon&, double squared_distance, double squared_radius) {
            sum += kernel_weight(kernel, std::min(1.0, squared_distance / squared_radius));
        });
    return sum / (pi * answer.squared_radius * static_cast<double>(map.size()));
}

TEST(NearestEstimate, IsUnbiasedAndHasTheClosedFormVariance) {
    constexpr double n = 200.0;
    for (const std::size_t photons_asked : {std::size_t{6}, std::size_t{12}, std::size_t{20}}) {
        const double k = static_cast<double>(photons_asked);
        Sample estimates;
        Sample uncorrected;
        for (std::uint64_t draw = 0; draw < 8000; ++draw) {
            const PhotonMap map(photons_on_the_unit_square(200, 100'000 * photons_asked + draw));
            const NearestPhotons answer =
                map.nearest(Vector(0.0f), up, photons_asked, 10.0, [](const Photon&, double, double) {});
            uncorrected.add(k / (pi * answer.squared_radius * n));
            estimates.add(nearest_estimate(map, photons_asked, 10.0, Kernel::Disc));
        }
        EXPECT_LT(std::abs(estimates.z_of_mean(1.0)), z_limit) << "k = " << k;
        EXPECT_LT(std::abs(estimates.z_of_variance((n - k + 1.0) / (n * (k - 2.0)))), z_limit) << "k = " << k;
        EXPECT_LT(std::abs(uncorrected.z_of_mean(k / (k - 1.0))), z_limit) << "k = " << k;
        EXPECT_GT(uncorrected.z_of_mean(1.0), z_limit) << "k / (pi r^2) should be told apart from the truth, k = " << k;
    }
}

TEST(NearestEstimate, IsUnbiasedForEveryKernelWithNoFurtherFactor) {
    for (const Kernel kernel : {Kernel::Cone, Kernel::Epanechnikov, Kernel::Biweight}) {
        Sample estimates;
        for (std::uint64_t draw = 0; draw < 6000; ++draw)
            estimates.add(
                nearest_estimate(PhotonMap(photons_on_the_unit_square(200, 3'000'000 + draw)), 10, 10.0, kernel));
        EXPECT_LT(std::abs(estimates.z_of_mean(1.0)), z_limit) << name_of(kernel);
        EXPECT_GT(std::abs(estimates.z_of_mean(0.9)), z_limit) << name_of(kernel);  // what one more (k-1)/k would give
    }
}

TEST(NearestEstimate, TakesAllOverTheLargestDiscWhereThereAreFewerThanK) {
    constexpr double max_radius = 0.2;
    Sample estimates;
    for (std::uint64_t draw = 0; draw < 6000; ++draw) {
        const PhotonMap map(photons_on_the_unit_square(200, 4'000'000 + draw));
        const NearestPhotons answer =
            map.nearest(Vector(0.0f), up, 100, max_radius, [](const Photon&, double, double) {});
        ASSERT_LT(answer.found, 100u);
        ASSERT_EQ(answer.squared_radius, max_radius * max_radius);
        estimates.add(nearest_estimate(map, 100, max_radius, Kernel::Disc));
    }
    const double probability = pi * max_radius * max_radius;
    EXPECT_LT(std::abs(estimates.z_of_mean(1.0)), z_limit);
    EXPECT_LT(std::abs(estimates.z_of_variance((1.0 - probability) / (200.0 * probability))), z_limit);
}

// The two rules fit together: (k-1) / (pi r_k^2) contributes P(Binomial(N-1, p) >= k-1) to the mean and the count over
// the largest disc P(Binomial(N-1, p) <= k-2), which is 1 in sum.
TEST(NearestEstimate, IsUnbiasedWhereTheMaximumRadiusBindsHalfOfTheTime) {
    constexpr double max_radius = 0.2;  // 25 photons in the mean
    Sample estimates;
    std::size_t bound = 0;
    for (std::uint64_t draw = 0; draw < 8000; ++draw) {
        const PhotonMap map(photons_on_the_unit_square(200, 5'000'000 + draw));
        bound += map.nearest(Vector(0.0f), up, 25, max_radius, [](const Photon&, double, double) {}).found < 25;
        estimates.add(nearest_estimate(map, 25, max_radius, Kernel::Disc));
    }
    EXPECT_GT(bound, 3000u);
    EXPECT_LT(bound, 5000u);
    EXPECT_LT(std::abs(estimates.z_of_mean(1.0)), z_limit);
}

// ---------------------------------------------------------------------------------------------------------------------
// Progressive passes

// PPM at one point of a uniform density: unbiased at every alpha and every initial radius, empty passes included. The
// last two radii hold 0.3 and 0.03 photons in the mean of the first pass.
TEST(ProgressiveEstimate, OfAUniformDensityIsUnbiased) {
    constexpr std::size_t photons = 100;
    constexpr int passes = 16;
    struct Setting {
        double alpha;
        double initial_radius;
    };
    std::uint64_t draw = 6'000'000;
    for (const Setting& setting : {Setting{0.3, 0.3}, Setting{0.5, 0.3}, Setting{0.7, 0.3}, Setting{1.0, 0.3},
                                   Setting{0.7, 0.1}, Setting{0.7, 0.03}, Setting{0.3, 0.01}}) {
        Sample estimates;
        Sample skipping_empty_passes;
        for (int repetition = 0; repetition < 600; ++repetition) {
            GatherStatistics statistics{.squared_radius = setting.initial_radius * setting.initial_radius};
            double estimate = 0.0;
            int passes_with_photons = 0;
            for (int pass = 1; pass <= passes; ++pass) {
                const PhotonMap map(photons_on_the_unit_square(photons, draw++));
                const double found = count_within(map, Vector(0.0f), up, std::sqrt(statistics.squared_radius));
                passes_with_photons += found > 0.0;
                estimate += found / (static_cast<double>(photons) * pi * statistics.squared_radius);
                statistics.squared_radius *= hachisuka_shrink(setting.alpha, statistics.count, found);
                statistics.count += setting.alpha * found;
            }
            estimates.add(estimate / passes);
            skipping_empty_passes.add(passes_with_photons > 0 ? estimate / passes_with_photons : 0.0);
        }
        const std::string where =
            "alpha " + std::to_string(setting.alpha) + ", radius " + std::to_string(setting.initial_radius);
        EXPECT_LT(std::abs(estimates.z_of_mean(1.0)), z_limit) << where;
        if (setting.initial_radius <= 0.03) {
            EXPECT_GT(skipping_empty_passes.z_of_mean(1.0), z_limit) << where;
        }
    }
}

}  // namespace
}  // namespace photonlab
