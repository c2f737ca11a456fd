// Measured materials alone: where a number of a file is looked up, what is drawn against its density, and which files
// are refused. Tables come from formulas, which look-ups are compared with.
//
// Each chi-square fails by chance with probability 1e-4; the seeds are fixed.

#include "scene/materials/rough/merl.h"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <limits>

#include "core/error.h"
#include "core/random.h"
#include "core/sampling.h"
#include "scene/loader.h"
#include "tests/image/scratch_folder.h"
#include "tests/support/chi_square.h"
#include "tests/support/merl_numbers.h"
#include "tests/support/test_stream.h"

namespace photonlab::test {
namespace {

constexpr std::size_t bins = 90 * 90 * 180;

/// Shiny, and made once.
const Formula& shiny() {
    static const Formula formula = shiny_formula({0.2, 0.1, 0.05}, 1.0, 60.0);
    return formula;
}
const Material& shiny_material() {
    static const Material material = measured(shiny());
    return material;
}

VectorD at_degrees(double degrees) {
    return {std::sin(degrees * pi / 180.0), 0.0, std::cos(degrees * pi / 180.0)};
}

// ---------------------------------------------------------------------------------------------------------------------

// Every number of the file is its own place, so that any wrong axis, order, stride or scale shows.
TEST(Merl, FindsANumberOfTheFileByItsAngles) {
    std::vector<double> numbers(3 * bins);
    for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = static_cast<double>(i + 1);
    const Material material = measured(make_merl_table(numbers, "test"));
    RandomStream random = test_stream(0, 17);
    int found = 0;
    for (int i = 0; i < 100'000; ++i) {
        const Imath::V2f u = random.next_2d();
        const Imath::V2f v = random.next_2d();
        const auto half = static_cast<std::size_t>(u.x * 90.0f);
        const auto difference = static_cast<std::size_t>(u.y * 90.0f);
        const auto azimuth = static_cast<std::size_t>(v.x * 360.0f);  // to 2 pi: beyond pi is the same place again
        const double root = (static_cast<double>(half) + 0.5) / 90.0;
        const double theta_h = root * root * pi / 2.0;
        const double theta_d = (static_cast<double>(difference) + 0.5) / 90.0 * pi / 2.0;
        const DirectionPair at =
            directions_at(theta_h, theta_d, (static_cast<double>(azimuth) + 0.5) / 180.0 * pi, v.y * 2.0 * pi);
        if (at.outgoing.z < 1e-6 || at.incoming.z < 1e-6) continue;
        // Rounding to float32 turns the half vector around the normal by up to 1e-7 / (cos(theta_d) theta_h): this must
        // be well below half a bin of phi_d, 9e-3.
        if (std::cos(theta_d) * theta_h < 1e-7 / 4e-3) continue;
        const Color value = evaluate(material.bsdf, Vector(at.outgoing), Vector(at.incoming));
        const std::size_t place = azimuth % 180 + 180 * (difference + 90 * half);
        ASSERT_FLOAT_EQ(value.x, static_cast<float>(numbers[place] / 1500.0))
            << half << " " << difference << " " << azimuth;
        ASSERT_FLOAT_EQ(value.y, static_cast<float>(numbers[bins + place] * 1.15 / 1500.0));
        ASSERT_FLOAT_EQ(value.z, static_cast<float>(numbers[2 * bins + place] * 1.66 / 1500.0));
        ++found;
    }
    EXPECT_GT(found, 60'000);
}

TEST(Merl, IsNearTheFormulaBetweenTheBinsMiddles) {
    RandomStream random = test_stream(1, 17);
    double deviation = 0.0;
    double sum = 0.0;
    for (int i = 0; i < 200'000; ++i) {
        const Vector outgoing = sample_cosine_hemisphere(random.next_2d());
        const Vector incoming = sample_cosine_hemisphere(random.next_2d());
        if (outgoing.z < 0.05f || incoming.z < 0.05f) continue;  // some bins there have their middles below the horizon
        const ColorD exact = shiny()(VectorD(outgoing), VectorD(incoming));
        const Color value = evaluate(shiny_material().bsdf, outgoing, incoming);
        deviation += std::abs(value.x - exact.x);
        sum += exact.x;
        // Half a bin of theta_h is at most 0.017 sqrt(theta_h), over which the lobe falls by a factor of
        // exp(60 theta_h^1.5 0.017 1.25): 1.4 where it is a tenth of its height. Far out only the body is left.
        EXPECT_NEAR(value.x / exact.x, 1.0, 0.5);
    }
    EXPECT_LT(deviation / sum, 0.02);
}

TEST(Merl, IsReciprocalToTheBit) {
    RandomStream random = test_stream(2, 17);
    for (int i = 0; i < 100'000; ++i) {
        const Vector a = sample_cosine_hemisphere(random.next_2d());
        const Vector b = sample_cosine_hemisphere(random.next_2d());
        ASSERT_EQ(evaluate(shiny_material().bsdf, a, b), evaluate(shiny_material().bsdf, b, a)) << a << " " << b;
    }
}

TEST(Merl, TakesTheSameValueForBothDirectionsAlongTheNormal) {
    const Vector normal(0, 0, 1);
    const Color value = evaluate(shiny_material().bsdf, normal, normal);
    EXPECT_NEAR(value.x, shiny()(VectorD(normal), VectorD(normal)).x, 0.01);
    const Vector grazing(1.0f, 0.0f, 1e-7f);
    for (const Vector& other : {normal, grazing, Vector(-1.0f, 0.0f, 1e-7f)})
        EXPECT_TRUE(is_finite(evaluate(shiny_material().bsdf, grazing, other)));
}

TEST(Merl, IsBlackWhereAnyChannelIsNegative) {
    for (const std::size_t channel : {0, 1, 2}) {
        std::vector<double> numbers(3 * bins, 100.0);
        const std::size_t place = 70 + 180 * (30 + 90 * 20);
        numbers[channel * bins + place] = -1e-3;
        const auto table = make_merl_table(numbers, "test");
        EXPECT_TRUE(is_black(table->values[place]));
        EXPECT_FALSE(is_black(table->values[place + 1]));
        EXPECT_FALSE(is_black(table->values[place - 1]));
    }
}

TEST(Merl, IsBlackBelowTheSurface) {
    const Bsdf& bsdf = shiny_material().bsdf;
    const Vector above(0.6f, 0.0f, 0.8f);
    const Vector below(0.6f, 0.0f, -0.8f);
    EXPECT_TRUE(is_black(evaluate(bsdf, above, below)));
    EXPECT_TRUE(is_black(evaluate(bsdf, below, above)));
    EXPECT_EQ(density(bsdf, above, below), 0.0f);
    EXPECT_EQ(density(bsdf, below, above), 0.0f);
    EXPECT_FALSE(sample(bsdf, below, Carried::Radiance, {0.3f, 0.3f}));
}

// ---------------------------------------------------------------------------------------------------------------------

/// Share of samples that are no directions, by the midpoint rule: rings of half vectors in parts of equal solid angle.
double share_of_half_vectors_reflecting_below(const MerlTable& table, const VectorD& outgoing) {
    constexpr int parts = 16;
    constexpr int azimuths = 1000;
    double below = 0.0;
    for (std::size_t ring = 0; ring < 90; ++ring) {
        const double ring_width = table.half_edges[ring + 1] - table.half_edges[ring];
        for (int part = 0; part < parts; ++part) {
            const double z = 1.0 - table.half_edges[ring] - ring_width * (part + 0.5) / parts;
            const double sine = std::sqrt(1.0 - z * z);
            int count = 0;
            for (int i = 0; i < azimuths; ++i) {
                const VectorD half(sine * std::cos(2.0 * pi * (i + 0.5) / azimuths),
                                   sine * std::sin(2.0 * pi * (i + 0.5) / azimuths), z);
                count += 2.0 * half.dot(outgoing) * half.z <= outgoing.z;
            }
            below += table.half_density[ring] * 2.0 * pi * ring_width * count / (parts * azimuths);
        }
    }
    return below * table.half_share;
}

// Samples by angle from the normal and azimuth. What is not a direction (half vectors that reflect below the surface)
// is counted in a column of its own, left of zero, whose expectation is what the density lacks to one.
TEST(Merl, SamplesByItsDensity) {
    const Material dull = measured(Formula([](const VectorD&, const VectorD&) { return ColorD(0.25); }));
    const Material very_shiny = measured(shiny_formula({0.02, 0.02, 0.02}, 3.0, 400.0));
    std::uint64_t index = 10;
    for (const Material* material : {&dull, &shiny_material(), &very_shiny})
        for (const double degrees : {0.0, 30.0, 65.0, 85.0}) {
            SCOPED_TRACE(std::to_string(degrees) + " degrees, " + (material == &dull ? "dull" : "shiny"));
            const Vector outgoing(at_degrees(degrees));
            const auto by_angles = [&](double theta, double phi) {
                const double sine = std::sin(theta);
                return sine * density(material->bsdf, outgoing,
                                      Vector(VectorD(sine * std::cos(phi), sine * std::sin(phi), std::cos(theta))));
            };
            const double lost =
                share_of_half_vectors_reflecting_below(*std::get<Merl>(material->bsdf).table, at_degrees(degrees));
            const double column = pi / 2.0 / 11.0;
            RandomStream random = test_stream(index++, 17);
            expect_distributed(
                [&]() -> std::pair<double, double> {
                    const auto drawn = sample(material->bsdf, outgoing, Carried::Radiance, random.next_2d());
                    if (!drawn) return {-0.5 * column, (2.0 * random.next_2d().x - 1.0) * pi};
                    const VectorD incoming(drawn->incoming);
                    return {std::acos(incoming.z), std::atan2(incoming.y, incoming.x)};
                },
                [&](double theta, double phi) {
                    return theta > 0.0 ? by_angles(theta, phi) : lost / (2.0 * pi * column);
                },
                -column, pi / 2.0, -pi, pi, 200'000, 96);
        }
}

TEST(Merl, WeighsASampleByValueTimesCosineOverDensity) {
    RandomStream random = test_stream(3, 17);
    const Vector outgoing(at_degrees(50.0));
    for (int i = 0; i < 10'000; ++i) {
        const auto drawn = sample(shiny_material().bsdf, outgoing, Carried::Flux, random.next_2d());
        if (!drawn) continue;
        ASSERT_NEAR(drawn->incoming.length(), 1.0, 1e-6);
        const Color value = evaluate(shiny_material().bsdf, outgoing, drawn->incoming);
        const float share = drawn->incoming.z / density(shiny_material().bsdf, outgoing, drawn->incoming);
        for (int channel = 0; channel < 3; ++channel)
            ASSERT_NEAR(drawn->weight[channel], value[channel] * share, 1e-5 * drawn->weight[channel]);
        ASSERT_EQ(drawn->density, density(shiny_material().bsdf, outgoing, drawn->incoming));
    }
}

// Second moments of the reflected share of even light, the standard use of both: what noise is left in an image.
TEST(Merl, SamplesShinyDataBetterThanTheCosineDoes) {
    const Material very_shiny = measured(shiny_formula({0.02, 0.02, 0.02}, 3.0, 400.0));
    struct Case {
        const Material& material;
        double least_gain;
    };
    for (const Case& at : {Case{shiny_material(), 1.5}, Case{very_shiny, 20.0}})
        for (const double degrees : {0.0, 30.0, 60.0, 80.0}) {
            const Vector outgoing(at_degrees(degrees));
            RandomStream random = test_stream(4, 17);
            double sums[2] = {};
            double squares[2] = {};
            constexpr int samples = 100'000;
            for (int i = 0; i < samples; ++i) {
                const auto drawn = sample(at.material.bsdf, outgoing, Carried::Radiance, random.next_2d());
                const double by_table = drawn ? drawn->weight.x : 0.0;
                const Vector incoming = sample_cosine_hemisphere(random.next_2d());
                const double by_cosine = evaluate(at.material.bsdf, outgoing, incoming).x * pi;
                sums[0] += by_table;
                sums[1] += by_cosine;
                squares[0] += by_table * by_table;
                squares[1] += by_cosine * by_cosine;
            }
            const auto variance = [&](int which) {
                const double mean = sums[which] / samples;
                return squares[which] / samples - mean * mean;
            };
            EXPECT_GT(variance(1) / variance(0), at.least_gain) << degrees << " degrees";
            const double error = std::sqrt((variance(0) + variance(1)) / samples);
            EXPECT_NEAR(sums[0] / samples, sums[1] / samples, 4.0 * error) << degrees << " degrees";
        }
}

TEST(Merl, KnowsHowMuchItReflects) {
    for (const MerlTable::Albedo& at : std::get<Merl>(shiny_material().bsdf).table->albedos) {
        const ColorD exact = albedo_of(shiny(), at_degrees(at.degrees));
        // Bins across the horizon are black when their middles are below it: at 85 degrees that takes a per cent.
        for (int channel = 0; channel < 3; ++channel)
            EXPECT_NEAR(at.albedo[channel], exact[channel], (at.degrees > 70.0 ? 0.03 : 0.005) * exact[channel])
                << at.degrees << " degrees";
    }
}

TEST(Merl, BoundsEveryWeight) {
    // A tenth of the samples at least are drawn by the cosine: no weight is above 10 pi f.
    std::vector<double> numbers(3 * bins, 100.0);
    for (std::size_t i = 0; i < 20 * 90 * 180; ++i) numbers[i] = numbers[bins + i] = numbers[2 * bins + i] = 1e5;
    const Material material = measured(make_merl_table(numbers, "test"));
    RandomStream random = test_stream(5, 17);
    for (int i = 0; i < 100'000; ++i) {
        const Vector outgoing = sample_cosine_hemisphere(random.next_2d());
        const auto drawn = sample(material.bsdf, outgoing, Carried::Radiance, random.next_2d());
        if (!drawn) continue;
        const double bound = 10.0 * pi * evaluate(material.bsdf, outgoing, drawn->incoming).x;
        ASSERT_LE(drawn->weight.x, bound * (1.0 + 1e-5));
    }
}

// ---------------------------------------------------------------------------------------------------------------------

class MerlFiles : public ::testing::Test {
protected:
    ScratchFolder folder;

    static std::string file_bytes(std::array<std::int32_t, 3> dimensions, const std::vector<double>& numbers) {
        std::string bytes(sizeof(dimensions) + numbers.size() * sizeof(double), '\0');
        std::memcpy(bytes.data(), dimensions.data(), sizeof(dimensions));
        std::memcpy(bytes.data() + sizeof(dimensions), numbers.data(), numbers.size() * sizeof(double));
        return bytes;
    }

    void write(const std::string& name, const std::string& bytes) const {
        std::ofstream(folder / name, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    }

    SceneDescription load(const std::string& bsdf) const {
        write("scene.xml", "<scene version='3.0.0'><sensor type='perspective'/>\n" + bsdf + "\n</scene>");
        return load_scene_file(folder / "scene.xml");
    }

    void expect_refused(const std::string& bytes, const std::string& message) const {
        write("table.binary", bytes);
        try {
            load("<bsdf type='merl' id='m'>\n<string name='filename' value='table.binary'/></bsdf>");
            FAIL() << "expected: " << message;
        } catch (const InputError& error) {
            EXPECT_NE(std::string(error.what()).find("scene.xml:3: "), std::string::npos) << error.what();
            EXPECT_NE(std::string(error.what()).find("table.binary"), std::string::npos) << error.what();
            EXPECT_NE(std::string(error.what()).find(message), std::string::npos) << error.what();
        }
    }
};

TEST_F(MerlFiles, AreReadIntoAMaterial) {
    write("table.binary", file_bytes({90, 90, 180}, numbers_of(shiny())));
    const SceneDescription scene =
        load("<bsdf type='merl' id='m'><string name='filename' value='table.binary'/></bsdf>");
    ASSERT_EQ(scene.materials.size(), 1U);
    const Vector outgoing(at_degrees(20.0));
    const Vector incoming(at_degrees(-25.0));
    EXPECT_EQ(evaluate(scene.materials[0].bsdf, outgoing, incoming),
              evaluate(shiny_material().bsdf, outgoing, incoming));
    EXPECT_EQ(material_kind(scene.materials[0]), std::string("merl"));
    EXPECT_FALSE(is_specular(scene.materials[0].bsdf));
    EXPECT_TRUE(scene.notes.empty());
}

TEST_F(MerlFiles, ChangeTheScenesHash) {
    const std::string bsdf = "<bsdf type='merl' id='m'><string name='filename' value='table.binary'/></bsdf>";
    std::vector<double> numbers(3 * bins, 100.0);
    write("table.binary", file_bytes({90, 90, 180}, numbers));
    const std::string hash = load(bsdf).hash;
    numbers.back() = 101.0;
    write("table.binary", file_bytes({90, 90, 180}, numbers));
    EXPECT_NE(load(bsdf).hash, hash);
}

TEST_F(MerlFiles, AreSaidToReflectMoreThanTheyGet) {
    const std::string bsdf = "<bsdf type='merl' id='m'><string name='filename' value='table.binary'/></bsdf>";
    const auto notes_for = [&](double reflectance) {
        write("table.binary", file_bytes({90, 90, 180}, numbers_of([=](const VectorD&, const VectorD&) {
                                             return ColorD(0.1, reflectance, 0.1) / pi;
                                         })));
        return load(bsdf).notes;
    };
    EXPECT_TRUE(notes_for(0.99).empty());
    const std::vector<std::string> notes = notes_for(1.2);
    ASSERT_EQ(notes.size(), 1U);
    EXPECT_EQ(notes[0].find("merl \"table.binary\": reflects more light than it gets: 1.2"), 0U) << notes[0];
}

TEST_F(MerlFiles, OfOtherSizesOrDimensionsAreRefused) {
    const std::vector<double> numbers(3 * bins, 100.0);
    const std::string expected = "expected a MERL BRDF, 34992012 bytes with the dimensions 90 90 180, got ";
    const std::string whole = file_bytes({90, 90, 180}, numbers);
    ASSERT_EQ(whole.size(), 34'992'012U);
    expect_refused("", expected + "0 bytes");
    expect_refused(whole.substr(0, 11), expected + "11 bytes");
    expect_refused(whole.substr(0, whole.size() - 1), expected + "34992011 bytes with the dimensions 90 90 180");
    expect_refused(whole + " ", expected + "34992013 bytes with the dimensions 90 90 180");
    expect_refused(file_bytes({90, 180, 90}, numbers), expected + "34992012 bytes with the dimensions 90 180 90");
    expect_refused(file_bytes({180, 90, 90}, numbers), expected + "34992012 bytes with the dimensions 180 90 90");
    expect_refused(file_bytes({-90, -90, 180}, numbers), expected + "34992012 bytes with the dimensions -90 -90 180");
}

TEST_F(MerlFiles, WithNumbersThatAreNotFiniteAreRefused) {
    std::vector<double> numbers(3 * bins, 100.0);
    numbers[bins + 7 + 180 * (8 + 90 * 9)] = std::numeric_limits<double>::quiet_NaN();
    numbers[2 * bins] = std::numeric_limits<double>::infinity();
    expect_refused(file_bytes({90, 90, 180}, numbers),
                   "expected finite numbers, got 2 of 4374000 that are not; the first is number 1605247, green of "
                   "theta_h 9, theta_d 8, phi_d 7, counted from 0");
    numbers.assign(3 * bins, 100.0);
    numbers[0] = 1e300;  // finite, but not in the float32 that it is kept in
    expect_refused(file_bytes({90, 90, 180}, numbers), "expected finite numbers, got 1 of 4374000");
}

TEST_F(MerlFiles, NeedAName) {
    EXPECT_THROW(load("<bsdf type='merl' id='m'/>"), InputError);
    const std::string missing = "<bsdf type='merl' id='m'><string name='filename' value='missing.binary'/></bsdf>";
    const auto message = [&] {
        try {
            load(missing);
        } catch (const InputError& error) {
            return std::string(error.what());
        }
        return std::string("no error");
    };
    const std::string table = (folder / "missing.binary").string(), script = (folder / "make_table.py").string();
    EXPECT_NE(message().find(table + ": is not there; expected a table of the MERL database"), std::string::npos)
        << message();
    write("make_table.py", "");
    EXPECT_NE(message().find("`/usr/bin/python3 " + script + " " + table + "` writes it"), std::string::npos)
        << message();
}

}  // namespace
}  // namespace photonlab::test
