// Mirrors, glass and textures alone: Fresnel's and Snell's laws against closed forms and an evaluation of its own by
// std::complex, the weights of the branches, and what a texture answers between its pixels.
//
// Fresnel's formulas are computed in double and compared to 1e-12; directions and weights are float32 and compared to
// 1e-6, some ten roundings. Frequencies of choices are compared within four standard errors; the seed is fixed.

#include <gtest/gtest.h>

#include <complex>
#include <fstream>

#include "core/error.h"
#include "image/png.h"
#include "scene/loader.h"
#include "scene/materials/material.h"
#include "tests/image/scratch_folder.h"
#include "tests/scene/described.h"

namespace photonlab {
namespace {

constexpr double glass_index = 1.5;
constexpr double rounding = 1e-12;       // of a few operations in double
constexpr double float_rounding = 1e-6;  // of a few operations in float32

double cosine_of(double degrees) {
    return std::cos(degrees * pi / 180.0);
}

/// Squared amplitude ratios across an interface by complex arithmetic: [0] perpendicular, [1] parallel.
/// `index` is that of the far side relative to the near one.
std::array<double, 2> reflected_by_complex_arithmetic(double cosine, std::complex<double> index) {
    const double sine = std::sqrt(1.0 - cosine * cosine);
    const std::complex<double> inside = std::sqrt(1.0 - (sine / index) * (sine / index));  // cosine of refraction
    const std::complex<double> perpendicular = (cosine - index * inside) / (cosine + index * inside);
    const std::complex<double> parallel = (index * cosine - inside) / (index * cosine + inside);
    return {std::norm(perpendicular), std::norm(parallel)};
}

// ---------------------------------------------------------------------------------------------------------------------

TEST(FresnelDielectric, ReflectsFourPercentOfGlassAtNormalIncidence) {
    EXPECT_NEAR(fresnel_dielectric(1.0, 1.0 / glass_index).reflected, 0.04, rounding);
    EXPECT_NEAR(fresnel_dielectric(1.0, glass_index).reflected, 0.04, rounding);
    EXPECT_NEAR(fresnel_dielectric(1.0, 1.0 / 1.33).reflected, 0.33 * 0.33 / (2.33 * 2.33), rounding);
}

// At Brewster's angle, tan = n, reflection and refraction are at right angles and the parallel part vanishes: what is
// left is half of the perpendicular part, ((n^2 - 1) / (n^2 + 1))^2.
TEST(FresnelDielectric, HasNoParallelPartAtBrewstersAngle) {
    const double n2 = glass_index * glass_index;
    const double perpendicular = (n2 - 1.0) * (n2 - 1.0) / ((n2 + 1.0) * (n2 + 1.0));
    EXPECT_NEAR(fresnel_dielectric(1.0 / std::sqrt(1.0 + n2), 1.0 / glass_index).reflected, 0.5 * perpendicular,
                rounding);
    const double from_glass = 1.0 / std::sqrt(1.0 + 1.0 / n2);  // tan = 1 / n
    EXPECT_NEAR(fresnel_dielectric(from_glass, glass_index).reflected, 0.5 * perpendicular, rounding);
}

TEST(FresnelDielectric, ReflectsAllBeyondTheCriticalAngle) {
    EXPECT_NEAR(std::asin(1.0 / glass_index) * 180.0 / pi, 41.810, 5e-4);
    for (const double degrees : {41.811, 42.0, 60.0, 89.9}) {
        const FresnelDielectric beyond = fresnel_dielectric(cosine_of(degrees), glass_index);
        EXPECT_EQ(beyond.reflected, 1.0) << degrees;
        EXPECT_EQ(beyond.cos_beyond, 0.0) << degrees;
    }
    // Just before it, to first order in c = cos_beyond, 1 - R = 2 c (1 / (n cos) + n / cos); the second order is some
    // 6 c of it.
    const double cosine = cosine_of(41.810);
    const FresnelDielectric before = fresnel_dielectric(cosine, glass_index);
    const double refracted = 2.0 * before.cos_beyond * (1.0 / glass_index + glass_index) / cosine;
    EXPECT_GT(before.cos_beyond, 0.0);
    EXPECT_NEAR((1.0 - before.reflected) / refracted, 1.0, 6.0 * before.cos_beyond);
}

TEST(FresnelDielectric, IsTheSameFromBothSidesOfARay) {
    for (const double index : {1.33, 1.5, 2.419})
        for (double degrees = 0.0; degrees < 89.5; degrees += 1.0) {
            const FresnelDielectric outside = fresnel_dielectric(cosine_of(degrees), 1.0 / index);
            const FresnelDielectric inside = fresnel_dielectric(outside.cos_beyond, index);
            EXPECT_NEAR(inside.reflected, outside.reflected, 1e-10);  // 1 / cos amplifies rounding near grazing
            EXPECT_NEAR(inside.cos_beyond, cosine_of(degrees), 1e-10);
        }
}

TEST(FresnelDielectric, FollowsSnellsLaw) {
    for (const double eta : {1.0 / 1.5, 1.0 / 1.33, 1.33, 1.5})
        for (double degrees = 0.0; degrees < 40.0; degrees += 2.0) {
            const double sine = std::sin(degrees * pi / 180.0);
            const double cosine = fresnel_dielectric(cosine_of(degrees), eta).cos_beyond;
            EXPECT_NEAR(std::sqrt(1.0 - cosine * cosine), eta * sine, 1e-10);
        }
}

TEST(FresnelDielectric, AgreesWithComplexArithmetic) {
    for (const double index : {0.5, 1.0 / 1.5, 1.33, 1.5, 2.419})  // below 1: from inside, total reflection included
        for (double degrees = 0.0; degrees < 90.0; degrees += 0.7) {
            const auto [perpendicular, parallel] = reflected_by_complex_arithmetic(cosine_of(degrees), index);
            EXPECT_NEAR(fresnel_dielectric(cosine_of(degrees), 1.0 / index).reflected, 0.5 * (perpendicular + parallel),
                        1e-10)
                << index << ", " << degrees << " degrees";
        }
}

// 1 - R falls with cos: to first order 2 cos (1 + n^2) / sqrt(n^2 - 1) at grazing incidence.
TEST(FresnelDielectric, ReflectsAllAtGrazingIncidence) {
    for (const double cosine : {1e-3, 1e-5, 1e-8}) {
        const double n2 = glass_index * glass_index;
        const double refracted = 2.0 * cosine * (1.0 + n2) / std::sqrt(n2 - 1.0);
        EXPECT_NEAR((1.0 - fresnel_dielectric(cosine, 1.0 / glass_index).reflected) / refracted, 1.0,
                    10.0 * cosine + 1e-6);
    }
    EXPECT_EQ(fresnel_dielectric(0.0, 1.0 / glass_index).reflected, 1.0);
}

// ---------------------------------------------------------------------------------------------------------------------

TEST(FresnelConductor, IsTheDielectricsWithoutAbsorption) {
    for (const double index : {1.33, 1.5, 2.419})
        for (double degrees = 0.0; degrees <= 90.0; degrees += 1.0)
            EXPECT_NEAR(fresnel_conductor(cosine_of(degrees), index, 0.0),
                        fresnel_dielectric(cosine_of(degrees), 1.0 / index).reflected, 1e-10);
    for (const double degrees : {42.0, 60.0, 80.0})  // total reflection
        EXPECT_NEAR(fresnel_conductor(cosine_of(degrees), 1.0 / 1.5, 0.0), 1.0, rounding);
}

TEST(FresnelConductor, OfTheNameNoneReflectsEverything) {
    for (double degrees = 0.0; degrees <= 90.0; degrees += 1.0)
        EXPECT_NEAR(fresnel_conductor(cosine_of(degrees), 0.0, 1.0), 1.0, rounding) << degrees;
    EXPECT_NEAR(fresnel_conductor(0.0, 0.0, 1.0), 1.0, rounding);
}

TEST(FresnelConductor, HasTheClosedFormAtNormalIncidence) {
    for (const NamedConductor& metal : named_conductors())
        for (int channel = 0; channel < 3; ++channel) {
            const double eta = metal.eta[channel];
            const double k = metal.k[channel];
            EXPECT_NEAR(fresnel_conductor(1.0, eta, k),
                        ((eta - 1.0) * (eta - 1.0) + k * k) / ((eta + 1.0) * (eta + 1.0) + k * k), rounding)
                << metal.name;
        }
}

TEST(FresnelConductor, AgreesWithComplexArithmetic) {
    for (const NamedConductor& metal : named_conductors())
        for (int channel = 0; channel < 3; ++channel)
            for (double degrees = 0.0; degrees < 90.0; degrees += 0.7) {
                const auto [perpendicular, parallel] =
                    reflected_by_complex_arithmetic(cosine_of(degrees), {metal.eta[channel], metal.k[channel]});
                EXPECT_NEAR(fresnel_conductor(cosine_of(degrees), metal.eta[channel], metal.k[channel]),
                            0.5 * (perpendicular + parallel), 1e-10)
                    << metal.name << ", " << degrees << " degrees";
            }
}

// ---------------------------------------------------------------------------------------------------------------------

/// Unit directions above the surface, of some inclinations and azimuths.
std::vector<Vector> directions_above() {
    std::vector<Vector> result;
    for (const double degrees : {0.0, 10.0, 30.0, 41.0, 43.0, 60.0, 80.0, 89.0})
        for (const double azimuth : {0.0, 1.1, 2.9, 4.6}) {
            const double sine = std::sin(degrees * pi / 180.0);
            result.emplace_back(static_cast<float>(sine * std::cos(azimuth)),
                                static_cast<float>(sine * std::sin(azimuth)), static_cast<float>(cosine_of(degrees)));
        }
    return result;
}

std::optional<SpecularBranch> reflected_of(const SpecularBranches& branches) {
    for (const SpecularBranch& branch : branches)
        if (branch.incoming.z > 0.0f) return branch;
    return std::nullopt;
}

std::optional<SpecularBranch> refracted_of(const SpecularBranches& branches) {
    for (const SpecularBranch& branch : branches)
        if (branch.incoming.z < 0.0f) return branch;
    return std::nullopt;
}

void expect_direction(const Vector& direction, const Vector& expected) {
    EXPECT_LT((direction - expected).length(), float_rounding);
    EXPECT_NEAR(direction.length(), 1.0, float_rounding);
}

TEST(Dielectric, SendsLightWhereTheLawsOfReflectionAndRefractionSay) {
    const Dielectric glass{.index_here = 1.1f, .index_beyond = 1.6f};
    for (const Dielectric& side : {glass, glass.turned_over()})
        for (const Vector& outgoing : directions_above()) {
            const SpecularBranches branches = side.branches(outgoing, Carried::Flux);
            const auto reflected = reflected_of(branches);
            ASSERT_TRUE(reflected);
            expect_direction(reflected->incoming, {-outgoing.x, -outgoing.y, outgoing.z});

            const double eta = static_cast<double>(side.index_here) / static_cast<double>(side.index_beyond);
            const double sine = eta * std::hypot(outgoing.x, outgoing.y);
            EXPECT_EQ(branches.count, sine < 1.0 ? 2 : 1);
            if (sine >= 1.0) {
                EXPECT_EQ(reflected->weight, Color(1.0f));
                continue;
            }
            const auto refracted = refracted_of(branches);
            ASSERT_TRUE(refracted);
            // In the plane of incidence, on the other side of the normal.
            expect_direction(refracted->incoming,
                             Vector(VectorD(-eta * outgoing.x, -eta * outgoing.y, -std::sqrt(1.0 - sine * sine))));
        }
}

TEST(Dielectric, LosesNoFlux) {
    const Dielectric glass;
    for (const Dielectric& side : {glass, glass.turned_over()})
        for (const Vector& outgoing : directions_above()) {
            double sum = 0.0;
            for (const SpecularBranch& branch : side.branches(outgoing, Carried::Flux)) sum += branch.weight.y;
            EXPECT_NEAR(sum, 1.0, float_rounding);
        }
}

TEST(Dielectric, CompressesRefractedRadianceByTheSquareOfTheIndex) {
    const Dielectric glass{.index_here = 1.1f, .index_beyond = 1.6f};
    for (const Dielectric& side : {glass, glass.turned_over()})
        for (const Vector& outgoing : directions_above()) {
            const SpecularBranches flux = side.branches(outgoing, Carried::Flux);
            const SpecularBranches radiance = side.branches(outgoing, Carried::Radiance);
            ASSERT_EQ(flux.count, radiance.count);
            EXPECT_EQ(reflected_of(flux)->weight, reflected_of(radiance)->weight);
            if (flux.count == 1) continue;
            const double eta = static_cast<double>(side.index_here) / static_cast<double>(side.index_beyond);
            EXPECT_NEAR(refracted_of(radiance)->weight.x / refracted_of(flux)->weight.x, eta * eta, float_rounding);
        }
}

TEST(Dielectric, GivesBackWhatItTookOfRadianceOnTheWayOut) {
    const Dielectric glass;
    for (const Vector& outgoing : directions_above()) {
        const auto in = refracted_of(glass.branches(outgoing, Carried::Radiance));
        const auto in_flux = refracted_of(glass.branches(outgoing, Carried::Flux));
        ASSERT_TRUE(in && in_flux);
        // Seen from inside, the ray comes back along its direction: outgoing is the reverse of where it went.
        const Vector from_inside(in->incoming.x, in->incoming.y, -in->incoming.z);
        const auto out = refracted_of(glass.turned_over().branches(from_inside, Carried::Radiance));
        const auto out_flux = refracted_of(glass.turned_over().branches(from_inside, Carried::Flux));
        ASSERT_TRUE(out && out_flux);
        // cos on the way out has the rounding of sqrt(1 - sin^2): 1e-7 / cos.
        EXPECT_NEAR(out->weight.x * in->weight.x / (out_flux->weight.x * in_flux->weight.x), 1.0, float_rounding);
        EXPECT_NEAR(std::abs(out->incoming.z), outgoing.z, float_rounding / outgoing.z);
    }
}

TEST(Dielectric, LetsLightPassStraightBetweenEqualMedia) {
    const Dielectric nothing{.index_here = 1.3f, .index_beyond = 1.3f, .transmittance = Color(0.2f, 0.5f, 1.0f)};
    for (const Vector& outgoing : directions_above()) {
        const SpecularBranches branches = nothing.branches(outgoing, Carried::Radiance);
        ASSERT_EQ(branches.count, 1);
        EXPECT_EQ(branches.branch[0].incoming, -outgoing);
        EXPECT_EQ(branches.branch[0].weight, Color(0.2f, 0.5f, 1.0f));
    }
}

TEST(Dielectric, HasFactorsOfItsOwnForReflectionAndRefraction) {
    const Dielectric tinted{.reflectance = Color(0.2f, 0.5f, 1.0f), .transmittance = Color(0.9f, 0.4f, 0.1f)};
    const Dielectric clear;
    const Vector outgoing(0.6f, 0.0f, 0.8f);
    for (const Carried carried : {Carried::Flux, Carried::Radiance}) {
        const SpecularBranches ours = tinted.branches(outgoing, carried);
        const SpecularBranches all = clear.branches(outgoing, carried);
        for (int channel = 0; channel < 3; ++channel) {
            EXPECT_FLOAT_EQ(reflected_of(ours)->weight[channel],
                            reflected_of(all)->weight[channel] * tinted.reflectance[channel]);
            EXPECT_FLOAT_EQ(refracted_of(ours)->weight[channel],
                            refracted_of(all)->weight[channel] * tinted.transmittance[channel]);
        }
    }
}

/// Expects that sample() draws the branches of `bsdf` with the right mean weights, within four standard errors.
void expect_samples_follow_branches(const Bsdf& bsdf, const Vector& outgoing, Carried carried) {
    constexpr int count = 40'000;
    const SpecularBranches branches = specular_branches(bsdf, outgoing, carried);
    double strength_of_all = 0.0;
    for (const SpecularBranch& branch : branches) strength_of_all += max_channel(branch.weight);
    RandomStream random = stream_of_scenes();
    std::array<int, 2> drawn{};
    std::array<ColorD, 2> sum{ColorD(0.0), ColorD(0.0)};
    for (int i = 0; i < count; ++i) {
        const auto way = sample(bsdf, outgoing, carried, random.next_2d());
        ASSERT_TRUE(way);
        EXPECT_EQ(way->density, 0.0f);
        const std::size_t which = branches.count > 1 && way->incoming == branches.branch[1].incoming ? 1 : 0;
        EXPECT_EQ(way->incoming, branches.branch[which].incoming);
        ++drawn[which];
        sum[which] += ColorD(way->weight);
    }
    for (std::size_t which = 0; which < static_cast<std::size_t>(branches.count); ++which) {
        const Color& weight = branches.branch[which].weight;
        const double probability = max_channel(weight) / strength_of_all;
        const double error = std::sqrt(probability * (1.0 - probability) / count);
        EXPECT_NEAR(drawn[which] / static_cast<double>(count), probability, 4.0 * error + float_rounding);
        // Every sample of a branch weighs weight / probability.
        for (int channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(sum[which][channel] / count, weight[channel],
                        weight[channel] * (4.0 * error / probability + float_rounding));
    }
}

TEST(Dielectric, SamplesItsBranchesByTheirStrength) {
    const Dielectric glass{.reflectance = Color(0.9f, 0.5f, 0.7f), .transmittance = Color(0.3f, 0.8f, 0.6f)};
    for (const Dielectric& side : {glass, glass.turned_over()})
        for (const Carried carried : {Carried::Flux, Carried::Radiance})
            for (const Vector& outgoing : {Vector(0, 0, 1), Vector(0.6f, 0, 0.8f), Vector(0, 0.96f, 0.28f)})
                expect_samples_follow_branches(side, outgoing, carried);
}

TEST(SpecularMaterials, AreFoundByNoOtherTechnique) {
    const Vector outgoing(0.6f, 0.0f, 0.8f);
    for (const Bsdf& bsdf : {Bsdf(Dielectric{}), Bsdf(Conductor{})}) {
        EXPECT_TRUE(is_specular(bsdf));
        EXPECT_FALSE(is_black(bsdf));
        for (const SpecularBranch& branch : specular_branches(bsdf, outgoing, Carried::Radiance)) {
            EXPECT_EQ(evaluate(bsdf, outgoing, branch.incoming), Color(0.0f));
            EXPECT_EQ(density(bsdf, outgoing, branch.incoming), 0.0f);
        }
        EXPECT_EQ(specular_branches(bsdf, {0.6f, 0.0f, -0.8f}, Carried::Radiance).count, 0);
        EXPECT_FALSE(sample(bsdf, {0.6f, 0.0f, -0.8f}, Carried::Radiance, {0.3f, 0.3f}));
    }
    EXPECT_EQ(specular_branches(Diffuse{}, outgoing, Carried::Radiance).count, 0);
    EXPECT_TRUE(is_transmissive(Dielectric{}));
    EXPECT_FALSE(is_transmissive(Conductor{}));
}

TEST(Conductor, ReflectsInOneDirectionByFresnel) {
    Conductor copper;
    for (const NamedConductor& metal : named_conductors())
        if (metal.name == "Cu") copper = {metal.eta, metal.k, Color(0.5f, 0.7f, 0.9f)};
    ASSERT_NE(copper.eta, Color(0.0f));
    for (const Vector& outgoing : directions_above())
        for (const Carried carried : {Carried::Flux, Carried::Radiance}) {
            const SpecularBranches branches = copper.branches(outgoing, carried);
            ASSERT_EQ(branches.count, 1);
            expect_direction(branches.branch[0].incoming, {-outgoing.x, -outgoing.y, outgoing.z});
            for (int channel = 0; channel < 3; ++channel)
                EXPECT_NEAR(
                    branches.branch[0].weight[channel],
                    copper.reflectance[channel] * fresnel_conductor(outgoing.z, copper.eta[channel], copper.k[channel]),
                    float_rounding);
        }
    expect_samples_follow_branches(copper, {0.6f, 0.0f, 0.8f}, Carried::Flux);
}

// ---------------------------------------------------------------------------------------------------------------------
// In a scene: sides, and a ray's whole way through a ball of glass.

std::optional<Surface> seen_from(const Scene& scene, const Vector& origin, const Vector& direction) {
    const auto hit = intersect(scene, {origin, direction});
    if (!hit) return std::nullopt;
    return orient(scene, *hit, -direction);
}

TEST(SpecularSurfaces, AreBlackBehindAMirrorUnlessItIsTwoSided) {
    for (const bool two_sided : {false, true}) {
        SceneDescription description = describe({floor_of_eight()});
        description.materials = {{.id = "mirror", .bsdf = Conductor{}, .two_sided = two_sided}};
        const Scene scene = build_scene(description);
        for (const float side : {1.0f, -1.0f}) {
            const Vector down(0.6f, 0.0f, -0.8f * side);
            const auto surface = seen_from(scene, {0.0f, 0.0f, 0.2f * side}, down);
            ASSERT_EQ(surface.has_value(), side > 0.0f || two_sided);
            if (!surface) continue;
            const SpecularBranches branches =
                specular_branches(surface->bsdf, surface->frame.to_local(-down), Carried::Flux);
            ASSERT_EQ(branches.count, 1);
            expect_direction(surface->frame.to_world(branches.branch[0].incoming), {0.6f, 0.0f, 0.8f * side});
        }
    }
}

TEST(SpecularSurfaces, OfGlassAreTurnedOverWhenSeenFromBehind) {
    SceneDescription description = describe({floor_of_eight()});
    description.materials = {{.id = "glass", .bsdf = Dielectric{.index_here = 1.1f, .index_beyond = 1.7f}}};
    const Scene scene = build_scene(description);
    for (const float side : {1.0f, -1.0f}) {
        const auto surface = seen_from(scene, {0.0f, 0.0f, 0.2f * side}, {0.0f, 0.0f, -side});
        ASSERT_TRUE(surface);
        EXPECT_EQ(std::get<Dielectric>(surface->bsdf).index_here, side > 0.0f ? 1.1f : 1.7f);
        EXPECT_EQ(std::get<Dielectric>(surface->bsdf).index_beyond, side > 0.0f ? 1.7f : 1.1f);
    }
}

// A ray that meets a ball of radius R at distance b from its centre line: sin(theta_i) = b / R, sin(theta_t) = b / (n
// R). Each of the two refractions turns it by theta_i - theta_t, and each reflection inside by pi - 2 theta_t. Its
// points are off by the step of offset_from_surface, 32 roundings or 2e-6 of the box, which 1 / cos(theta_i) <= 3
// amplifies.
TEST(SpecularSurfaces, OfAGlassBallTurnARayByTheClosedForm) {
    SceneDescription description =
        describe({{.geometry = SphereDescription{{2.0, -1.0, 7.0}, 3.0}, .radiance = std::nullopt, .place = "test:1"}});
    description.materials = {{.id = "glass", .bsdf = Dielectric{}}};
    const Scene scene = build_scene(description);
    for (const int reflections : {0, 1, 2})
        for (const double share : {0.0, 0.1, 0.3, 0.5, 0.7, 0.9, 0.94}) {
            const Vector start = to_box(scene, VectorD(2.0 + 3.0 * share, -1.0, 0.0));
            Ray ray{start, {0.0f, 0.0f, 1.0f}};
            double flux = 1.0;
            for (int surfaces = 0; surfaces < 2 + reflections; ++surfaces) {
                const auto surface = seen_from(scene, ray.origin, ray.direction);
                ASSERT_TRUE(surface);
                const SpecularBranches branches =
                    specular_branches(surface->bsdf, surface->frame.to_local(-ray.direction), Carried::Flux);
                const bool reflect = surfaces > 0 && surfaces <= reflections;
                const auto way = reflect ? reflected_of(branches) : refracted_of(branches);
                ASSERT_TRUE(way) << share;
                flux *= way->weight.x;
                const Vector direction = surface->frame.to_world(way->incoming);
                EXPECT_TRUE(sides_agree(*surface, direction));
                ray = {offset_from_surface(surface->position, surface->geometric_normal, direction), direction};
            }
            EXPECT_FALSE(intersect(scene, ray));
            const double outside = std::asin(share);
            const double inside = std::asin(share / glass_index);
            const double turned = 2.0 * (outside - inside) + reflections * (pi - 2.0 * inside);
            // Towards the axis: the ray started at +x and turns to -x.
            EXPECT_NEAR(ray.direction.z, std::cos(turned), 2e-5) << share;
            EXPECT_NEAR(ray.direction.x, -std::sin(turned), 2e-5) << share;
            EXPECT_NEAR(ray.direction.y, 0.0, 2e-5) << share;
            const double reflected = fresnel_dielectric(std::cos(outside), 1.0 / glass_index).reflected;
            EXPECT_NEAR(flux, (1.0 - reflected) * (1.0 - reflected) * std::pow(reflected, reflections), 2e-5);
        }
}

// ---------------------------------------------------------------------------------------------------------------------

/// 3 x 2 pixels, each of a value of its own; exact in float32.
Bitmap small_texture(const Matrix& to_uv = Matrix()) {
    ColorImage image{3, 2, std::vector<Color>(6)};
    const float values[] = {0.0f, 0.25f, 1.0f, 0.5f, 0.75f, 0.125f};
    for (std::size_t i = 0; i < 6; ++i) image.pixels[i] = Color(values[i], 1.0f - values[i], 0.5f * values[i]);
    return {std::make_shared<const ColorImage>(std::move(image)), to_uv};
}

TEST(Texture, HasItsPixelsAtTheirCentresAndItsFirstRowAtZero) {
    const Bitmap texture = small_texture();
    for (int row = 0; row < 2; ++row)
        for (int column = 0; column < 3; ++column) {
            const Color& pixel = texture.image->pixels[static_cast<std::size_t>(row * 3 + column)];
            const Color found =
                texture.color_at({(static_cast<float>(column) + 0.5f) / 3.0f, (static_cast<float>(row) + 0.5f) / 2.0f});
            for (int channel = 0; channel < 3; ++channel) EXPECT_NEAR(found[channel], pixel[channel], float_rounding);
        }
}

TEST(Texture, IsBilinearBetweenPixelCentres) {
    const Bitmap texture = small_texture();
    // A third of the way from column 0 to 1, a quarter from row 0 to 1.
    const double x = 1.0 / 3.0;
    const double y = 0.25;
    const double expected = (0.0 * (1 - x) + 0.25 * x) * (1 - y) + (0.5 * (1 - x) + 0.75 * x) * y;
    const Color found = texture.color_at({static_cast<float>((0.5 + x) / 3.0), static_cast<float>((0.5 + y) / 2.0)});
    EXPECT_NEAR(found.x, expected, float_rounding);
    EXPECT_NEAR(found.y, 1.0 - expected, float_rounding);
    EXPECT_NEAR(found.z, 0.5 * expected, float_rounding);
}

TEST(Texture, RepeatsAndBlendsAcrossItsEdges) {
    const Bitmap texture = small_texture();
    // On the corner all four pixels of the image's corners meet: (0 + 1 + 0.5 + 0.125) / 4.
    for (const Imath::V2f& corner : {Imath::V2f(0, 0), Imath::V2f(1, 0), Imath::V2f(0, 1), Imath::V2f(-3, 5)})
        EXPECT_NEAR(texture.color_at(corner).x, (0.0 + 1.0 + 0.5 + 0.125) / 4.0, float_rounding);
    RandomStream random = stream_of_scenes();
    for (int i = 0; i < 200; ++i) {
        const Imath::V2f uv = random.next_2d();
        const Color here = texture.color_at(uv);
        for (const Imath::V2f& repeat : {Imath::V2f(1, 0), Imath::V2f(0, -1), Imath::V2f(-7, 12)}) {
            const Color there = texture.color_at(uv + repeat);
            // The sum rounds to 2^-21; the steepest slope is some 3 a unit of u.
            for (int channel = 0; channel < 3; ++channel) EXPECT_NEAR(there[channel], here[channel], 1e-5);
        }
    }
}

TEST(Texture, IsLookedUpWhereToUvSends) {
    Matrix to_uv;
    to_uv.setScale(VectorD(2.0, 3.0, 1.0));
    to_uv *= Matrix().setTranslation(VectorD(0.25, -0.5, 0.0));
    const Bitmap moved = small_texture(to_uv);
    const Bitmap plain = small_texture();
    for (const Imath::V2f& uv : {Imath::V2f(0.1f, 0.2f), Imath::V2f(0.7f, 0.35f), Imath::V2f(-0.4f, 1.3f)}) {
        const Color expected = plain.color_at({2.0f * uv.x + 0.25f, 3.0f * uv.y - 0.5f});
        for (int channel = 0; channel < 3; ++channel) EXPECT_NEAR(moved.color_at(uv)[channel], expected[channel], 1e-5);
    }
}

TEST(Texture, TakesThePlaceOfTheReflectanceInAScene) {
    SceneDescription description = describe({floor_of_eight()});
    auto& mesh = std::get<MeshDescription>(description.shapes[0].geometry);
    mesh.texture_coordinates = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    description.materials[0].textures = {textured(&Diffuse::reflectance, std::make_shared<Texture>(small_texture()))};
    const Scene scene = build_scene(description);
    // The floor is [-4, 4]^2: (u, v) = (1/6, 3/4) is the centre of row 1, column 0.
    const auto surface = seen_from(scene, to_box(scene, {-4.0 + 8.0 / 6.0, 2.0, 3.0}), {0.0f, 0.0f, -1.0f});
    ASSERT_TRUE(surface);
    EXPECT_NEAR(std::get<Diffuse>(surface->bsdf).reflectance.x, 0.5, 1e-5);
}

class BitmapFile : public ::testing::Test {
protected:
    /// The texture of a scene file with one diffuse bitmap; `options` goes inside the <texture>.
    std::optional<Bitmap> load(const std::string& file, const std::string& options = "") const {
        std::ofstream(folder_ / "scene.xml")
            << "<scene version='3.0.0'><sensor type='perspective'/>\n"
               "<shape type='rectangle'><bsdf type='diffuse'><texture type='bitmap' name='reflectance'>\n"
               "<string name='filename' value='"
            << file << "'/>" << options << "</texture></bsdf></shape></scene>";
        const SceneDescription description = load_scene_file(folder_ / "scene.xml");
        const Material& material = description.materials.at(description.shapes.at(0).material);
        if (material.textures.empty()) return std::nullopt;
        return std::get<Bitmap>(*material.textures.front().texture);
    }

    ScratchFolder folder_;
};

// Eight bits of sRGB hold a linear value v to half a step: 1 / 510 in the encoded value, and the decoding's slope is at
// most 2.4 / 1.055.
TEST_F(BitmapFile, OfEightBitsIsDecodedFromSrgb) {
    const std::vector<ColorD> pixels{{0.0, 0.002, 0.02}, {0.2, 0.5, 1.0}, {0.9, 0.1, 0.4}, {0.7, 0.3, 0.05}};
    write_png(folder_ / "colours.png", 2, 2, pixels);
    const auto texture = load("colours.png");
    ASSERT_TRUE(texture);
    ASSERT_EQ(texture->image->width, 2);
    ASSERT_EQ(texture->image->height, 2);
    for (std::size_t i = 0; i < 4; ++i)
        for (int channel = 0; channel < 3; ++channel) {
            EXPECT_NEAR(texture->image->pixels[i][channel], pixels[i][channel], 2.4 / 1.055 / 510.0);
            EXPECT_EQ(srgb_byte(texture->image->pixels[i][channel]), srgb_byte(pixels[i][channel]));
        }
}

TEST_F(BitmapFile, IsNotDecodedWhenItIsRaw) {
    const std::vector<ColorD> pixels{{0.0, 0.002, 0.02}, {0.2, 0.5, 1.0}};
    write_png(folder_ / "colours.png", 2, 1, pixels);
    const auto texture = load("colours.png", "<boolean name='raw' value='true'/>");
    ASSERT_TRUE(texture);
    for (std::size_t i = 0; i < 2; ++i)
        for (int channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(texture->image->pixels[i][channel], srgb_byte(pixels[i][channel]) / 255.0, float_rounding);
}

TEST_F(BitmapFile, IsRepeatedByScaleAndMovedByTranslate) {
    write_png(folder_ / "colours.png", 2, 2, {ColorD(0.0), ColorD(1.0), ColorD(1.0), ColorD(0.0)});
    const auto texture =
        load("colours.png", "<transform name='to_uv'><scale x='4' y='2'/><translate x='0.5' y='0'/></transform>");
    ASSERT_TRUE(texture);
    // u = 1/16 -> 0.25 + 0.5: the second column, v = 1/8 -> 0.25: the first row.
    EXPECT_NEAR(texture->color_at({1.0f / 16.0f, 1.0f / 8.0f}).x, 1.0, float_rounding);
    EXPECT_NEAR(texture->color_at({1.0f / 16.0f, 3.0f / 8.0f}).x, 0.0, float_rounding);
    EXPECT_NEAR(texture->color_at({5.0f / 16.0f, 1.0f / 8.0f}).x, 1.0, float_rounding);  // one repeat further
}

TEST_F(BitmapFile, ThatIsNoImageIsRefused) {
    std::ofstream(folder_ / "words.png") << "no image";
    for (const std::string file : {"words.png", "absent.png"}) try {
            load(file);
            ADD_FAILURE() << file;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find(file), std::string::npos) << error.what();
        }
}

}  // namespace
}  // namespace photonlab
