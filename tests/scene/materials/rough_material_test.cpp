// Rough and layered materials alone: that samples follow the density that is claimed for them, that f is what samples
// weigh, is reciprocal and gives no more than it gets, and what is known of each in closed form.
//
// Integrals over directions are by the midpoint rule, whose error for lobes of these widths is below the tolerances
// that each test states. Chi-square tests fail by chance with probability 1e-4 each (chi_square.h), seeds are fixed.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "core/random.h"
#include "core/sampling.h"
#include "scene/materials/material.h"
#include "tests/scene/described.h"
#include "tests/scene/geometry.h"
#include "tests/support/chi_square.h"
#include "tests/support/layered.h"

namespace photonlab {
namespace {

constexpr double angles[] = {0.0, 30.0, 60.0, 80.0, 89.0};

Vector direction_of(double z, double azimuth) {
    const double sine = std::sqrt(std::max(0.0, 1.0 - z * z));
    return Vector(VectorD(sine * std::cos(azimuth), sine * std::sin(azimuth), z));
}

/// The integral of `f` over all directions with z in [least, most].
double over_sphere(const std::function<double(const Vector&)>& f, double least, double most, int steps = 500) {
    return cell_integral([&](double z, double azimuth) { return f(direction_of(z, azimuth)); }, least, most, 0.0,
                         2.0 * pi, steps);
}

const FacetSlopes all_slopes[] = {FacetSlopes::Beckmann, FacetSlopes::Ggx, FacetSlopes::Phong};

struct Alphas {
    float u, v;
};

std::ostream& operator<<(std::ostream& out, const Alphas& alphas) {
    return out << alphas.u << " by " << alphas.v;
}

// The projected area of all facets is that of the surface. [Walter et al. 2007, equation 4]
TEST(Microfacets, CoverTheSurface) {
    for (const FacetSlopes slopes : all_slopes)
        for (const Alphas& alpha : {Alphas{0.05f, 0.05f}, {0.3f, 0.3f}, {1.0f, 1.0f}, {0.1f, 0.5f}, {0.6f, 0.05f}}) {
            const Microfacets facets{slopes, alpha.u, alpha.v};
            // In x = sqrt(1 - cos) a narrow peak at the normal is resolved.
            const double area = cell_integral(
                [&](double x, double azimuth) {
                    const Vector normal = direction_of(1.0 - x * x, azimuth);
                    return facets.distribution(normal) * (1.0 - x * x) * 2.0 * x;
                },
                0.0, 1.0, 0.0, 2.0 * pi, 2000);
            EXPECT_NEAR(area, 1.0, 1e-4) << static_cast<int>(slopes) << " " << alpha;
        }
}

// From every direction the facets that are seen cover what is seen of the surface. [Heitz 2014, equation 14]
TEST(Microfacets, ThatAreSeenCoverWhatIsSeenOfTheSurface) {
    for (const FacetSlopes slopes : {FacetSlopes::Beckmann, FacetSlopes::Ggx})
        for (const Alphas& alpha : {Alphas{0.1f, 0.1f}, {0.5f, 0.5f}, {1.0f, 1.0f}, {0.1f, 0.5f}, {0.9f, 0.2f}})
            for (const double degrees : angles) {
                const Microfacets facets{slopes, alpha.u, alpha.v};
                const Vector view = at_angle(degrees, alpha.u == alpha.v ? 0.0 : 0.8);
                const double seen = cell_integral(
                    [&](double x, double azimuth) {
                        const Vector normal = direction_of(1.0 - x * x, azimuth);
                        return facets.density(view, normal) * 2.0 * x;
                    },
                    0.0, 1.0, 0.0, 2.0 * pi, 1500);
                EXPECT_NEAR(seen, 1.0, 2e-3) << static_cast<int>(slopes) << " " << alpha << " " << degrees;
            }
}

TEST(Microfacets, AreDrawnWithTheirDensity) {
    for (const FacetSlopes slopes : all_slopes)
        for (const Alphas& alpha : {Alphas{0.1f, 0.1f}, {0.5f, 0.5f}, {0.1f, 0.5f}, {0.6f, 0.2f}})
            for (const double degrees : angles) {
                SCOPED_TRACE(fmt::format("{} {} {} {}", static_cast<int>(slopes), alpha.u, alpha.v, degrees));
                const Microfacets facets{slopes, alpha.u, alpha.v};
                const Vector view = at_angle(degrees, 0.7);
                RandomStream random = stream_of_scenes();
                expect_distributed(
                    [&] {
                        const Vector normal = facets.sample(view, random.next_2d());
                        const double azimuth = std::atan2(normal.y, normal.x);
                        return std::pair(std::sqrt(std::max(0.0, 1.0 - static_cast<double>(normal.z))),
                                         azimuth < 0.0 ? azimuth + 2.0 * pi : azimuth);
                    },
                    [&](double x, double azimuth) {
                        return facets.density(view, direction_of(1.0 - x * x, azimuth)) * 2.0 * x;
                    },
                    0.0, 1.0, 0.0, 2.0 * pi, 100'000, 48);
            }
}

TEST(Microfacets, AreDrawnWithTheirDensityWhereTheyAreNearlySmoothAndSeenAtGrazingAngles) {
    for (const FacetSlopes slopes : {FacetSlopes::Beckmann, FacetSlopes::Ggx})
        for (const double degrees : {0.0, 60.0, 89.5}) {
            const Microfacets facets{slopes, 1e-3f};
            const Vector view = at_angle(degrees);
            RandomStream random = stream_of_scenes();
            double squared = 0.0, weight = 0.0;
            constexpr int samples = 20'000;
            for (int i = 0; i < samples; ++i) {
                const Vector normal = facets.sample(view, random.next_2d());
                if (slopes == FacetSlopes::Beckmann && degrees < 80.0) {
                    ASSERT_GT(normal.z, 0.99f);
                }
                squared += std::min(1.0, (static_cast<double>(normal.y) * normal.y) / (normal.z * normal.z * 1e-6));
                weight += facets.weight(view, mirrored(view, normal), normal);
            }
            // Across the view slopes are those of all facets; what is above one alpha counts as one. Beckmann's density
            // is exp(-s^2) / sqrt(pi), Ggx's 1 / (2 (1 + s^2)^(3/2)); four standard errors are below 0.01.
            const double expected = slopes == FacetSlopes::Beckmann ? 0.3711 : 0.4672;
            EXPECT_NEAR(squared / samples, expected, 0.01) << static_cast<int>(slopes) << " " << degrees;
            if (degrees < 80.0) {
                EXPECT_NEAR(weight / samples, 1.0, 1e-3);
            }
        }
}

// ---------------------------------------------------------------------------------------------------------------------

struct NamedBsdf {
    std::string name;
    Material material;
    bool is_opaque = true;
};

std::vector<NamedBsdf> materials() {
    const Color gold_eta(0.143119f, 0.374957f, 1.442479f), gold_k(3.983160f, 2.385721f, 1.603215f);
    std::vector<NamedBsdf> all;
    for (const FacetSlopes slopes : all_slopes)
        for (const float alpha : {0.2f, 0.6f}) {
            const Microfacets facets{slopes, alpha};
            const std::string which = fmt::format(" {} {}", static_cast<int>(slopes), alpha);
            all.push_back({"rough conductor" + which,
                           {.id = "metal", .bsdf = RoughConductor{.facets = facets, .eta = gold_eta, .k = gold_k}}});
            all.push_back({"rough plastic" + which, rough_plastic(facets, Color(0.6f, 0.4f, 0.2f))});
            all.push_back({"rough glass" + which, {.id = "glass", .bsdf = RoughDielectric{.facets = facets}}, false});
            all.push_back({"inside of rough glass" + which,
                           {.id = "glass", .bsdf = RoughDielectric{.facets = facets}.turned_over()},
                           false});
        }
    for (const FacetSlopes slopes : all_slopes) {
        const Microfacets facets{slopes, 0.5f, 0.15f};
        const std::string which = fmt::format("brushed {} ", static_cast<int>(slopes));
        const RoughDielectric glass{.facets = facets};
        all.push_back({which + "metal", anisotropic(RoughConductor{.facets = facets, .eta = gold_eta, .k = gold_k})});
        all.push_back({which + "glass", anisotropic(glass), false});
        all.push_back({which + "inside of glass", anisotropic(glass.turned_over()), false});
    }
    const Material metal{.id = "metal", .bsdf = RoughConductor{.facets = {FacetSlopes::Ggx, 0.3f}}};
    Material brushed = coated(anisotropic(RoughConductor{.facets = {FacetSlopes::Ggx, 0.2f, 0.5f}}));
    brushed.is_anisotropic = true;
    all.push_back({"coated brushed metal", brushed});
    all.push_back({"plastic", {.id = "plastic", .bsdf = plastic_of(Color(0.6f, 0.4f, 0.2f))}});
    all.push_back({"nonlinear plastic", {.id = "plastic", .bsdf = plastic_of(Color(0.6f, 0.4f, 0.2f), true)}});
    all.push_back({"phong", {.id = "phong", .bsdf = Phong{.exponent = 20.0f}}});
    for (const WardForm form : {WardForm::Ward, WardForm::Duer, WardForm::Balanced}) {
        const Ward ward{.facets = {FacetSlopes::Beckmann, 0.4f, 0.15f}, .form = form};
        all.push_back({form == WardForm::Duer ? "Duer" : "Ward", anisotropic(ward)});
    }
    all.push_back({"rough diffuse", {.id = "cloth", .bsdf = RoughDiffuse{.alpha = 0.5f}}});
    all.push_back({"qualitative", {.id = "cloth", .bsdf = RoughDiffuse{.alpha = 0.5f, .is_qualitative = true}}});
    all.push_back({"coated grey", coated(grey, Color(0.1f, 0.2f, 0.3f))});
    all.push_back({"coated metal", coated(metal)});
    all.push_back({"masked grey", masked(grey, Color(0.7f))});
    all.push_back({"blend", blended(grey, metal, 0.4f)});
    all.push_back({"blend with a mirror", blended(grey, {.id = "mirror", .bsdf = Conductor{}}, 0.3f)});
    return all;
}

class RoughMaterials : public ::testing::Test {
protected:
    std::vector<NamedBsdf> all_ = materials();
};

TEST_F(RoughMaterials, AreSound) {
    // A surface is given a tangent only where its material asks for it.
    const Bsdf brushed = RoughConductor{.facets = {FacetSlopes::Ggx, 0.2f, 0.5f}};
    EXPECT_THROW(require_valid(Material{.id = "metal", .bsdf = brushed}), InputError);
    EXPECT_THROW(require_valid(coated(anisotropic(brushed))), InputError);
    for (const NamedBsdf& named : all_) EXPECT_NO_THROW(require_valid(named.material)) << named.name;
}

// What is absorbed, and what goes on in single directions, is missing from the density of directions.
TEST_F(RoughMaterials, AreSampledByTheirDensity) {
    for (const NamedBsdf& named : all_) {
        const Bsdf bsdf = bsdf_at(named.material, {0, 0}, false);
        const double least = named.is_opaque ? 0.0 : -1.0;
        // At grazing angles lobes are too narrow for these cells; facets are tried there by themselves.
        for (const double degrees : {0.0, 25.0, 45.0, 60.0, 75.0}) {
            SCOPED_TRACE(fmt::format("{} at {} degrees", named.name, degrees));
            const Vector outgoing = at_angle(degrees, 0.4);
            // Cells narrow towards the horizon and the pole, where the peaks are: z = x^2 (3 - 2 x).
            const auto z_of = [&](double x) { return least + (1.0 - least) * x * x * (3.0 - 2.0 * x); };
            const auto stretch = [&](double x) { return (1.0 - least) * 6.0 * x * (1.0 - x); };
            const auto x_of = [&](double z) {
                double low = 0.0, high = 1.0;
                for (int i = 0; i < 50; ++i) (z_of(0.5 * (low + high)) < z ? low : high) = 0.5 * (low + high);
                return low;
            };
            const auto at = [&](double x, double azimuth) {
                return density(bsdf, outgoing, direction_of(z_of(x), azimuth)) * stretch(x);
            };
            const double all = cell_integral(at, 0.0, 1.0, 0.0, 2.0 * pi, 500);
            if (all < 0.02) continue;  // nearly all is absorbed
            RandomStream random = stream_of_scenes();
            int drawn = 0, scattered = 0;
            expect_distributed(
                [&] {
                    for (;;) {
                        ++drawn;
                        const auto found = sample(bsdf, outgoing, Carried::Radiance, random.next_2d());
                        if (!found || found->density == 0.0f) continue;
                        ++scattered;
                        const double azimuth = std::atan2(found->incoming.y, found->incoming.x);
                        return std::pair(x_of(found->incoming.z), azimuth < 0.0 ? azimuth + 2.0 * pi : azimuth);
                    }
                },
                [&](double x, double azimuth) { return at(x, azimuth) / all; }, 0.0, 1.0, 0.0, 2.0 * pi, 30'000, 24);
            const double share = static_cast<double>(scattered) / drawn;
            EXPECT_NEAR(share, all, 4.5 * std::sqrt(all * (1.0 - std::min(all, 1.0)) / drawn) + 2e-3);
        }
    }
}

TEST_F(RoughMaterials, WeighSamplesByTheirValue) {
    for (const NamedBsdf& named : all_) {
        const bool is_blend = named.name.starts_with("blend");  // weighs each sample by the material it came from
        const Bsdf bsdf = bsdf_at(named.material, {0, 0}, false);
        for (const double degrees : angles) {
            const Vector outgoing = at_angle(degrees, 1.1);
            RandomStream random = stream_of_scenes();
            for (int i = 0; i < 300; ++i) {
                const auto found = sample(bsdf, outgoing, Carried::Radiance, random.next_2d());
                if (!found || found->density == 0.0f || is_blend) continue;
                EXPECT_NEAR(found->density / density(bsdf, outgoing, found->incoming), 1.0, 2e-3) << named.name;
                const Color value =
                    evaluate(bsdf, outgoing, found->incoming) * (std::abs(found->incoming.z) / found->density);
                for (int channel = 0; channel < 3; ++channel)
                    EXPECT_NEAR(value[channel], found->weight[channel], 3e-3 * found->weight[channel] + 1e-6)
                        << named.name << " " << degrees;
            }
        }
    }
}

// f(a, b) = f(b, a); through an interface f over the square of the index on the viewer's side. [Veach 1997, 5.2]
TEST_F(RoughMaterials, AreReciprocal) {
    RandomStream random = stream_of_scenes();
    for (const NamedBsdf& named : all_) {
        const Bsdf front = bsdf_at(named.material, {0, 0}, false);
        const Bsdf back = bsdf_at(named.material, {0, 0}, true);
        for (int i = 0; i < 2000; ++i) {
            const Vector a = sample_unit_sphere(random.next_2d());
            const Vector b = sample_unit_sphere(random.next_2d());
            if (a.z <= 0.01f || std::abs(b.z) <= 0.01f || (named.is_opaque && b.z < 0.0f)) continue;
            Color forth = evaluate(front, a, b);
            Color back_again = b.z > 0.0f ? evaluate(front, b, a) : evaluate(back, {b.x, b.y, -b.z}, {a.x, a.y, -a.z});
            if (const auto* glass = std::get_if<RoughDielectric>(&front); glass && b.z < 0.0f) {
                forth /= glass->index_here * glass->index_here;
                back_again /= glass->index_beyond * glass->index_beyond;
            }
            for (int channel = 0; channel < 3; ++channel)
                EXPECT_NEAR(forth[channel], back_again[channel], 2e-3 * std::abs(forth[channel]) + 1e-6) << named.name;
        }
    }
}

/// Share of the light along `outgoing`, as flux, that goes on anywhere; by samples.
ColorD albedo(const Bsdf& bsdf, const Vector& outgoing, int samples = 40'000) {
    RandomStream random = stream_of_scenes();
    ColorD sum(0.0);
    for (int i = 0; i < samples; ++i)
        if (const auto found = sample(bsdf, outgoing, Carried::Flux, random.next_2d())) sum += ColorD(found->weight);
    return sum / samples;
}

TEST_F(RoughMaterials, GiveNoMoreThanTheyGet) {
    for (const NamedBsdf& named : all_) {
        const Bsdf bsdf = bsdf_at(named.material, {0, 0}, false);
        for (const double degrees : angles) {
            const ColorD all = albedo(bsdf, at_angle(degrees));
            if (named.name == "Duer") continue;  // can give more than it gets, as its author says
            // The shadowing that goes with Phong's facets is Beckmann's, and not their own: they can give more.
            const bool is_phong = named.name.find(" 2 ") != std::string::npos;
            EXPECT_LT(std::max({all.x, all.y, all.z}), is_phong ? 1.06 : 1.005) << named.name << " " << degrees;
            EXPECT_GE(std::min({all.x, all.y, all.z}), 0.0) << named.name;
        }
    }
}

// ---------------------------------------------------------------------------------------------------------------------
// White furnaces

/// (x, y) a quarter turn on.
Vector quarter_turned(const Vector& v) {
    return {-v.y, v.x, v.z};
}

TEST(Anisotropy, TurnsByAQuarterWhereUAndVAreExchanged) {
    RandomStream random = stream_of_scenes();
    for (const FacetSlopes slopes : all_slopes) {
        const RoughDielectric glass{.facets = {slopes, 0.4f, 0.1f}};
        const RoughDielectric exchanged{.facets = {slopes, 0.1f, 0.4f}};
        double largest = 0.0;
        for (int i = 0; i < 500; ++i) {
            const Vector a = sample_unit_sphere(random.next_2d());
            const Vector b = sample_unit_sphere(random.next_2d());
            if (a.z <= 0.05f || std::abs(b.z) <= 0.05f) continue;
            const double f = evaluate(glass, a, b).x;
            EXPECT_NEAR(evaluate(exchanged, quarter_turned(a), quarter_turned(b)).x, f, 1e-5 * f + 1e-12);
            EXPECT_NEAR(density(exchanged, quarter_turned(a), quarter_turned(b)), density(glass, a, b),
                        1e-5 * f + 1e-9);
            largest = std::max(largest, std::abs(f - evaluate(exchanged, a, b).x));
        }
        EXPECT_GT(largest, 0.01) << "and not otherwise";
    }
}

TEST(Anisotropy, ThatVanishesLeavesWhatIsTheSameInAllDirections) {
    RandomStream random = stream_of_scenes();
    for (const FacetSlopes slopes : all_slopes) {
        const Microfacets same{slopes, 0.3f};
        const Microfacets nearly{slopes, 0.3f, std::nextafter(0.3f, 1.0f)};
        ASSERT_FALSE(same.is_anisotropic());
        ASSERT_TRUE(nearly.is_anisotropic());
        for (int i = 0; i < 200; ++i) {
            const Vector view = sample_cosine_hemisphere(random.next_2d());
            const Vector normal = sample_cosine_hemisphere(random.next_2d());
            if (normal.z < 0.3f) continue;  // where there is hardly any
            EXPECT_NEAR(nearly.distribution(normal) / same.distribution(normal), 1.0, 2e-5 / normal.z / normal.z);
            EXPECT_NEAR(nearly.density(view, normal), same.density(view, normal),
                        2e-5 * same.density(view, normal) / normal.z / normal.z);
            const Imath::V2f u = random.next_2d();
            EXPECT_NEAR((nearly.sample(view, u) - same.sample(view, u)).length(), 0.0, 1e-5);
        }
    }
}

// Slopes along an axis are those of a surface of that axis' roughness.
TEST(Anisotropy, HasTheRoughnessOfEachAxisAlongIt) {
    const Vector along_u = Vector(0.3f, 0.0f, 1.0f).normalized();
    for (const FacetSlopes slopes : all_slopes) {
        const Microfacets both{slopes, 0.4f, 0.1f};
        const Microfacets of_u{slopes, 0.4f};
        const Microfacets of_v{slopes, 0.1f};
        const auto fall = [](const Microfacets& facets, const Vector& normal) {
            return facets.distribution(normal) / facets.distribution({0.0f, 0.0f, 1.0f});
        };
        EXPECT_NEAR(fall(both, along_u) / fall(of_u, along_u), 1.0, 1e-5);
        EXPECT_NEAR(fall(both, quarter_turned(along_u)) / fall(of_v, along_u), 1.0, 1e-5);
        EXPECT_NEAR(both.unhidden(along_u, {0, 0, 1}), of_u.unhidden(along_u, {0, 0, 1}), 1e-7);
        EXPECT_NEAR(both.unhidden(quarter_turned(along_u), {0, 0, 1}), of_v.unhidden(along_u, {0, 0, 1}), 1e-7);
        EXPECT_NEAR(both.mean_alpha(), 0.2, 1e-7);
    }
}

// In the terms of their papers: of the sum of the directions, which is not of unit length.
TEST(Wards, AreThoseOfTheirPapers) {
    const float u = 0.4f, v = 0.15f;
    RandomStream random = stream_of_scenes();
    for (int i = 0; i < 100; ++i) {
        const Vector a = sample_cosine_hemisphere(random.next_2d());
        const Vector b = sample_cosine_hemisphere(random.next_2d());
        if (a.z < 0.05f || b.z < 0.05f) continue;
        const VectorD h = VectorD(a) + VectorD(b);
        const double spread = std::exp(-(h.x * h.x / (u * u) + h.y * h.y / (v * v)) / (h.z * h.z)) / (pi * u * v);
        const auto lobe = [&](WardForm form) {
            const Ward ward{.facets = {FacetSlopes::Beckmann, u, v},
                            .form = form,
                            .colors = {.diffuse_reflectance = Color(0.0f), .specular_reflectance = Color(1.0f)}};
            return evaluate(Bsdf(ward), a, b).x;
        };
        const double cosines = static_cast<double>(a.z) * b.z;
        const auto expect = [&](WardForm form, double expected) {
            EXPECT_NEAR(lobe(form), expected, 1e-4 * expected + 1e-12);
        };
        expect(WardForm::Ward, spread / (4.0 * std::sqrt(cosines)));
        expect(WardForm::Duer, spread / (4.0 * cosines));
        expect(WardForm::Balanced, spread * h.length2() / std::pow(h.z, 4.0));
    }
}

// Between the roughnesses for which its coat is made a textured plastic is that of its roughness.
TEST(RoughCoats, AreRightBetweenTheirSteps) {
    const RoughCoats coats = make_rough_coats(FacetSlopes::Ggx, {smallest_roughness, 1.0f}, 1.49, false);
    EXPECT_EQ(coats.coats.size(), 17u);
    for (const float alpha : {smallest_roughness, 0.01f, 0.05f, 0.12f, 0.3f, 0.97f, 1.0f}) {
        const RoughCoat coat = make_rough_coat({FacetSlopes::Ggx, alpha}, 1.49, false);
        EXPECT_NEAR(coats.inner_reflectance_at(alpha), coat.inner_reflectance, 1e-3) << alpha;
        for (const float cosine : {0.0f, 0.03f, 0.1f, 0.3f, 0.6f, 1.0f})
            EXPECT_NEAR(coats.let_in_at(alpha, cosine), coat.let_in_at(cosine), cosine < 0.1f ? 0.012 : 0.004)
                << alpha << " " << cosine;
    }
    EXPECT_EQ(make_rough_coats(FacetSlopes::Ggx, Imath::V2f(0.2f), 1.49, false).coats.size(), 1u);
}

TEST(Anisotropy, LosesNoLightWhereItIsNearlySmoothInOneDirection) {
    for (const FacetSlopes slopes : {FacetSlopes::Beckmann, FacetSlopes::Ggx})
        for (const double degrees : {0.0, 45.0, 75.0})
            for (const double azimuth : {0.0, 0.7}) {
                const Microfacets facets{slopes, 1e-3f, 0.02f};
                const Vector outgoing = at_angle(degrees, azimuth);
                EXPECT_NEAR(albedo(RoughConductor{.facets = facets}, outgoing).x, 1.0, 5e-3) << degrees;
                EXPECT_NEAR(albedo(RoughDielectric{.facets = facets}, outgoing).x, 1.0, 5e-3) << degrees;
            }
}

TEST(NearlySmooth, MetalAndGlassAreWhatTheyAreWhenSmooth) {
    for (const FacetSlopes slopes : {FacetSlopes::Beckmann, FacetSlopes::Ggx})
        for (const double degrees : {0.0, 45.0, 75.0}) {
            const Vector outgoing = at_angle(degrees);
            const Microfacets facets{slopes, 1e-3f};
            const RoughConductor metal{.facets = facets, .eta = Color(0.2f), .k = Color(3.9f)};
            EXPECT_NEAR(albedo(metal, outgoing).x, fresnel_conductor(outgoing.z, 0.2f, 3.9f), 2e-3) << degrees;
            EXPECT_NEAR(albedo(RoughDielectric{.facets = facets}, outgoing).x, 1.0, 2e-3) << degrees;
        }
}

// At grazing angles facets of alpha 1e-3 still hide each other; nothing is made of it, and little is lost.
TEST(NearlySmooth, SurfacesLoseLittleAtGrazingAngles) {
    for (const FacetSlopes slopes : {FacetSlopes::Beckmann, FacetSlopes::Ggx}) {
        const Microfacets facets{slopes, 1e-3f};
        const double white = albedo(RoughConductor{.facets = facets}, at_angle(89.5)).x;
        EXPECT_LE(white, 1.0 + 1e-6);
        EXPECT_GT(white, 0.98);
    }
}

// What one facet reflects and lets through, by samples and by the integral of f over all directions.
TEST(RoughGlass, SendsOnWhatItsIntegralSays) {
    for (const FacetSlopes slopes : {FacetSlopes::Beckmann, FacetSlopes::Ggx})
        for (const bool inside : {false, true})
            for (const double degrees : {0.0, 35.0, 60.0}) {
                RoughDielectric glass{.facets = {slopes, 0.4f}};
                if (inside) glass = glass.turned_over();
                const Vector outgoing = at_angle(degrees);
                const double eta = glass.index_here / glass.index_beyond;
                const double integral = over_sphere(
                    [&](const Vector& v) {
                        const double flux = v.z < 0.0f ? 1.0 / (eta * eta) : 1.0;
                        return glass.evaluate(outgoing, v).x * std::abs(v.z) * flux;
                    },
                    -1.0, 1.0, 1200);
                EXPECT_NEAR(albedo(glass, outgoing, 100'000).x, integral, 5e-3) << degrees << " " << inside;
            }
}

// F + T (1 - R_outside) / (n^2 (1 - R)) = 1 for a white base, since 1 - R_outside = n^2 (1 - R).
// A blend leaves few bits of the first number, and the second draws the facet: within a hundredth of either as over the
// whole of both, 4% of nearly smooth facets reflect, to five standard errors.
TEST(RoughGlass, ChoosesItsSideByBothNumbers) {
    const RoughDielectric glass{.facets = {FacetSlopes::Beckmann, 0.05f}};
    RandomStream random = stream_of_scenes();
    int reflected = 0;
    constexpr int samples = 40'000;
    for (int i = 0; i < samples; ++i) {
        const auto drawn = glass.sample({0, 0, 1}, Carried::Flux, {0.5f, 0.5f + 0.0005f * random.next()});
        ASSERT_TRUE(drawn);
        reflected += drawn->incoming.z > 0.0f;
    }
    EXPECT_NEAR(static_cast<double>(reflected) / samples, 0.04, 0.005);
}

TEST(Plastic, WithAWhiteBaseLosesNothing) {
    for (const bool nonlinear : {false, true})
        for (const double degrees : {0.0, 40.0, 70.0, 85.0}) {
            const Plastic plastic = plastic_of(Color(1.0f), nonlinear);
            const Vector outgoing = at_angle(degrees);
            const double base =
                over_sphere([&](const Vector& v) { return plastic.evaluate(outgoing, v).x * v.z; }, 0.0, 1.0, 400);
            const double coat = plastic.branches(outgoing, Carried::Radiance).branch[0].weight.x;
            EXPECT_NEAR(base + coat, 1.0, 1e-3) << degrees;
        }
}

TEST(Plastic, ScattersWhatItsFormulaSays) {
    const Plastic linear = plastic_of(Color(0.5f));
    const Plastic nonlinear = plastic_of(Color(0.5f), true);
    const double inner = inner_reflectance_of(1.49);
    const double let_in = 1.0 - fresnel_dielectric(1.0, 1.0 / 1.49).reflected;
    const double once = let_in * let_in / (1.49 * 1.49 * pi);
    EXPECT_NEAR(linear.evaluate({0, 0, 1}, {0, 0, 1}).x, 0.5 / (1.0 - inner) * once, 1e-6);
    EXPECT_NEAR(nonlinear.evaluate({0, 0, 1}, {0, 0, 1}).x, 0.5 / (1.0 - 0.5 * inner) * once, 1e-6);
}

// 1 - R = (1 - R_outside) / n^2: as much light passes a boundary on the way in as on the way out.
TEST(InnerReflectance, IsThatOfTheOutsideByTheIndex) {
    for (const double index : {1.1, 1.33, 1.49, 1.9, 2.419}) {
        const double outside = inner_reflectance_of(1.0 / index);
        EXPECT_NEAR(1.0 - inner_reflectance_of(index), (1.0 - outside) / (index * index), 2e-6) << index;
    }
    EXPECT_NEAR(inner_reflectance_of(1.5), 0.596346, 5e-6);  // 1 - (1 - 0.0917780) / 1.5^2
    for (const double index : {1.1, 1.33, 1.49, 1.9}) {
        EXPECT_NEAR(fitted_inner_reflectance_of(index) / inner_reflectance_of(index), 1.0, 7e-3) << index;
        EXPECT_NEAR(fitted_inner_reflectance_of(1.0 / index), inner_reflectance_of(1.0 / index), 3e-3) << index;
    }
}

TEST(RoughPlastic, WithANearlySmoothCoatIsPlastic) {
    const Material rough = rough_plastic({FacetSlopes::Beckmann, 1e-3f}, Color(0.5f));
    for (const double degrees : {0.0, 40.0, 70.0}) {
        const Vector outgoing = at_angle(degrees);
        const Vector aside = at_angle(30.0, 2.0);
        EXPECT_NEAR(evaluate(rough.bsdf, outgoing, aside).x / plastic_of(Color(0.5f)).evaluate(outgoing, aside).x, 1.0,
                    4e-3)
            << degrees;
    }
}

TEST(RoughPlastic, WithAWhiteBaseLosesLittle) {
    for (const float alpha : {0.01f, 0.1f, 0.3f})
        for (const double degrees : {0.0, 40.0, 70.0}) {
            const double all = albedo(rough_plastic({FacetSlopes::Ggx, alpha}, Color(1.0f)).bsdf, at_angle(degrees)).x;
            EXPECT_LT(all, 1.02) << alpha << " " << degrees;
            EXPECT_GT(all, 0.9) << alpha << " " << degrees;
        }
}

TEST(ThinGlass, IsTheSumOverAllReflectionsInside) {
    const ThinDielectric pane;
    for (const double degrees : {0.0, 45.0, 80.0}) {
        const Vector outgoing = at_angle(degrees);
        const double face = fresnel_dielectric(outgoing.z, 1.0 / 1.5).reflected;
        double reflected = face, through = 0.0;
        for (double inside = 1.0 - face; inside > 1e-12; inside *= face * face) {
            through += inside * (1.0 - face);
            reflected += inside * face * (1.0 - face);
        }
        const SpecularBranches branches = pane.branches(outgoing, Carried::Radiance);
        ASSERT_EQ(branches.count, 2);
        EXPECT_NEAR(branches.branch[0].weight.x, reflected, 1e-6);
        EXPECT_NEAR(branches.branch[1].weight.x, through, 1e-6);
        EXPECT_EQ(branches.branch[1].incoming, -outgoing);
    }
}

TEST(Phong, ReflectsItsReflectancesAtNormalIncidence) {
    // The lobe's integral with the cosine: (n + 2) / (2 pi) 2 pi / (n + 2) = 1.
    const Phong phong{.exponent = 30.0f,
                      .colors = {.diffuse_reflectance = Color(0.3f), .specular_reflectance = Color(0.5f)}};
    EXPECT_NEAR(over_sphere(
                    [&](const Vector& v) {
                        return phong.evaluate({0, 0, 1}, v).x * v.z;
                    },
                    0.0, 1.0),
                0.8, 1e-3);
}

TEST(RoughDiffuse, WithoutRoughnessIsLamberts) {
    const RoughDiffuse flat{.reflectance = Color(0.6f), .alpha = 0.0f};
    EXPECT_NEAR(flat.evaluate(at_angle(50.0), at_angle(20.0, 2.0)).x, 0.6 / pi, 1e-6);
}

// Equations 27 to 30 of Oren & Nayar 1994, worked out by hand in another program: angles of 60 and 30 degrees, seen
// from above 0, 60 and 120 degrees apart, and 75 and 20 degrees on opposite sides. sigma = alpha / sqrt(2).
TEST(RoughDiffuse, IsOrenAndNayars) {
    const auto alpha_of = [](double sigma) { return static_cast<float>(sigma * std::sqrt(2.0)); };
    const RoughDiffuse cloth{.reflectance = Color(0.5f), .alpha = alpha_of(0.3)};
    RoughDiffuse qualitative = cloth;
    qualitative.is_qualitative = true;
    const Vector outgoing = at_angle(60.0);
    const double known[] = {0.164926893, 0.156527496, 0.139620349};
    const double known_qualitative[] = {0.160007559, 0.151055093, 0.142102628};
    for (int i = 0; i < 3; ++i) {
        const Vector incoming = at_angle(30.0, pi / 3.0 * i);
        EXPECT_NEAR(cloth.evaluate(outgoing, incoming).x, known[i], 1e-6) << i;
        EXPECT_NEAR(qualitative.evaluate(outgoing, incoming).x, known_qualitative[i], 1e-6) << i;
    }
    const RoughDiffuse rough{.reflectance = Color(0.8f), .alpha = alpha_of(0.5)};
    EXPECT_NEAR(rough.evaluate(at_angle(75.0), at_angle(20.0, pi)).x, 0.194390262, 1e-6);
}

// With an index of its surroundings there is no coat; with nothing absorbed and a diffuse base it is a plastic whose
// light never returns to the base.
TEST(Coating, IsWhatItIsMadeOf) {
    Material same = coated(grey);
    std::get<Coating>(same.bsdf).index_inside = 1.0f;
    std::get<Coating>(same.bsdf).index_outside = 1.0f;
    EXPECT_NEAR(evaluate(same.bsdf, at_angle(50.0), at_angle(20.0, 2.0)).x, 0.6 / pi, 1e-6);
    Plastic plastic{.index_inside = 1.5f, .diffuse_reflectance = Color(0.6f)};
    EXPECT_NEAR(evaluate(coated(grey).bsdf, at_angle(50.0), at_angle(20.0, 2.0)).x,
                plastic.evaluate(at_angle(50.0), at_angle(20.0, 2.0)).x, 1e-6);
    const double way = 2.0;  // straight in and out
    EXPECT_NEAR(evaluate(coated(grey, Color(0.3f)).bsdf, {0, 0, 1}, {0, 0, 1}).x /
                    evaluate(coated(grey).bsdf, {0, 0, 1}, {0, 0, 1}).x,
                std::exp(-0.3 * way), 1e-5);
}

TEST(Coating, OverAMirrorReflectsByBoth) {
    const Material mirror{.id = "mirror", .bsdf = Conductor{}};
    const SpecularBranches branches = specular_branches(coated(mirror).bsdf, at_angle(40.0), Carried::Radiance);
    const double coat = fresnel_dielectric(std::cos(40.0 * pi / 180.0), 1.0 / 1.5).reflected;
    ASSERT_EQ(branches.count, 2);
    EXPECT_NEAR(branches.branch[0].weight.x, coat, 1e-6);
    EXPECT_NEAR(branches.branch[1].weight.x, (1.0 - coat) * (1.0 - coat), 1e-6);
    EXPECT_NEAR((branches.branch[0].incoming - branches.branch[1].incoming).length(), 0.0, 1e-6);
}

TEST(Mask, LetsThroughWhatIsNotOpaque) {
    const Material mask = masked(grey, Color(0.7f));
    const Vector outgoing = at_angle(30.0);
    const SpecularBranches branches = specular_branches(mask.bsdf, outgoing, Carried::Flux);
    ASSERT_EQ(branches.count, 1);
    EXPECT_EQ(branches.branch[0].incoming, -outgoing);
    EXPECT_NEAR(branches.branch[0].weight.x, 0.3, 1e-6);
    EXPECT_NEAR(evaluate(mask.bsdf, outgoing, at_angle(10.0)).x, 0.7 * 0.6 / pi, 1e-6);
    EXPECT_NEAR(albedo(mask.bsdf, outgoing).x, 0.3 + 0.7 * 0.6, 5e-3);
    // From behind a one-sided material is black, and the holes are still there.
    const Bsdf behind = bsdf_at(mask, {0, 0}, true);
    EXPECT_FALSE(is_scattering(behind));
    EXPECT_NEAR(specular_branches(behind, outgoing, Carried::Flux).branch[0].weight.x, 0.3, 1e-6);
    EXPECT_FALSE(is_specular(masked(grey, Color(1.0f)).bsdf));
    EXPECT_FALSE(is_scattering(masked(grey, Color(0.0f)).bsdf));
}

TEST(Blend, IsBothByTheirShares) {
    const Material blend = blended(grey, {.id = "mirror", .bsdf = Conductor{}}, 0.3f);
    EXPECT_TRUE(is_specular(blend.bsdf) && is_scattering(blend.bsdf));
    EXPECT_NEAR(evaluate(blend.bsdf, at_angle(30.0), at_angle(10.0)).x, 0.7 * 0.6 / pi, 1e-6);
    EXPECT_NEAR(specular_branches(blend.bsdf, at_angle(30.0), Carried::Flux).branch[0].weight.x, 0.3, 1e-6);
    EXPECT_FALSE(is_specular(blended(grey, {.id = "mirror", .bsdf = Conductor{}}, 0.0f).bsdf));
}

TEST(Parts, ThatGoOnInTooManyDirectionsAreRefused) {
    const Material glass{.id = "glass", .bsdf = Dielectric{}};
    const Material four = blended(glass, glass, 0.5f);
    EXPECT_NO_THROW(require_valid(blended(four, four, 0.5f)));
    EXPECT_THROW(require_valid(masked(blended(four, four, 0.5f), Color(0.5f))), std::exception);
    EXPECT_THROW(require_valid(coated(glass)), std::exception);
}

}  // namespace
}  // namespace photonlab
