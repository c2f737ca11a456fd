#include "scene/materials/smooth/conductor.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/error.h"
#include "scene/materials/material_reader.h"

namespace photonlab {

SpecularBranches Conductor::branches(const Vector& outgoing, Carried) const {
    SpecularBranches result;
    if (outgoing.z <= 0.0f) return result;
    Color weight = reflectance;
    for (int channel = 0; channel < 3; ++channel)
        weight[channel] *= static_cast<float>(fresnel_conductor(outgoing.z, eta[channel], k[channel]));
    result.add(mirror_direction(outgoing), weight);
    return result;
}

double fresnel_conductor(double cos_theta, double eta, double k) {
    const double cos2 = std::min(1.0, cos_theta * cos_theta);
    const double sin2 = 1.0 - cos2;
    // a + i b is the index times the cosine inside: (a + i b)^2 = (eta + i k)^2 - sin^2.
    const double real = eta * eta - k * k - sin2;
    const double a2_plus_b2 = std::sqrt(real * real + 4.0 * eta * eta * k * k);
    const double a = std::sqrt(std::max(0.0, 0.5 * (a2_plus_b2 + real)));
    const double perpendicular = (a2_plus_b2 + cos2 - 2.0 * a * cos_theta) / (a2_plus_b2 + cos2 + 2.0 * a * cos_theta);
    const double far = a2_plus_b2 * cos2 + sin2 * sin2;
    const double near = 2.0 * a * cos_theta * sin2;
    const double parallel = far + near > 0.0 ? perpendicular * (far - near) / (far + near) : perpendicular;
    return 0.5 * (perpendicular + parallel);
}

// Measured indices (Palik 1985; Rakic et al. 1998) integrated against the CIE 1931 observer and brought to linear sRGB,
// as several renderers publish them (Mitsuba, Tungsten). What comes out below 0, outside sRGB's gamut, is 0.
const std::vector<NamedConductor>& named_conductors() {
    static const std::vector<NamedConductor> conductors{
        {"none", Color(0.0f), Color(1.0f)},
        {"Ag", {0.155265f, 0.116723f, 0.138381f}, {4.828343f, 3.122246f, 2.147050f}},
        {"Al", {1.657460f, 0.880369f, 0.521229f}, {9.223869f, 6.269523f, 4.837001f}},
        {"Au", {0.143119f, 0.374957f, 1.442479f}, {3.983160f, 2.385721f, 1.603215f}},
        {"Cr", {4.369683f, 2.916702f, 1.654701f}, {5.206434f, 4.231365f, 3.754947f}},
        {"Cu", {0.200438f, 0.924033f, 1.102212f}, {3.912949f, 2.452848f, 2.142188f}},
        {"a-C", {2.9440f, 2.2271f, 1.9682f}, {0.8875f, 0.7993f, 0.8153f}},
        {"AlAs", {3.6052f, 3.2330f, 2.2159f}, {0.0007f, 0.0000f, 0.0075f}},
        {"Be", {4.1850f, 3.1850f, 2.7841f}, {3.8355f, 3.0101f, 2.8690f}},
        {"CsI", {2.1449f, 1.7023f, 1.6624f}, {0.0000f, 0.0000f, 0.0000f}},
        {"Cu2O", {3.5518f, 2.9499f, 2.7519f}, {0.1142f, 0.1939f, 0.6061f}},
        {"CuO", {3.2475f, 2.4478f, 2.2102f}, {0.5211f, 0.5700f, 0.7222f}},
        {"d-C", {2.7098f, 2.3187f, 2.2289f}, {0.0000f, 0.0000f, 0.0000f}},
        {"Hg", {2.3989f, 1.4400f, 0.9096f}, {6.3276f, 4.3719f, 3.4218f}},
        {"HgTe", {4.7790f, 3.2312f, 2.6599f}, {1.6316f, 1.5808f, 1.7293f}},
        {"Ir", {3.0863f, 2.0822f, 1.6179f}, {5.5922f, 4.0671f, 3.2673f}},
        {"K", {0.0640f, 0.0464f, 0.0382f}, {2.1042f, 1.3489f, 0.9131f}},
        {"Li", {0.2658f, 0.1956f, 0.2209f}, {3.5402f, 2.3111f, 1.6686f}},
        {"MgO", {2.0896f, 1.6507f, 1.5949f}, {0.0000f, 0.0000f, 0.0000f}},
        {"Mo", {4.4840f, 3.5251f, 2.7763f}, {4.1114f, 3.4208f, 3.1506f}},
        {"Na_palik", {0.0603f, 0.0561f, 0.0620f}, {3.1793f, 2.1125f, 1.5790f}},
        {"Nb", {3.4201f, 2.7901f, 2.3956f}, {3.4414f, 2.7377f, 2.5797f}},
        {"Ni_palik", {2.3673f, 1.6634f, 1.4671f}, {4.4988f, 3.0502f, 2.3454f}},
        {"Rh", {2.5858f, 1.8602f, 1.5543f}, {6.7823f, 4.7030f, 3.9761f}},
        {"Se", {4.0586f, 2.8429f, 2.8208f}, {0.7541f, 0.6384f, 0.5218f}},
        {"SiC", {3.1723f, 2.5260f, 2.4794f}, {0.0000f, 0.0000f, 0.0000f}},
        {"SnTe", {4.5243f, 1.9816f, 1.2816f}, {0.0000f, 0.0000f, 0.0000f}},
        {"Ta", {2.0627f, 2.3929f, 2.6279f}, {2.4084f, 1.7415f, 1.9470f}},
        {"Te", {7.3903f, 4.4821f, 2.6371f}, {3.2560f, 3.5271f, 3.2920f}},
        {"ThF4", {1.8307f, 1.4422f, 1.3876f}, {0.0000f, 0.0000f, 0.0000f}},
        {"TiC", {3.7005f, 2.8374f, 2.5823f}, {3.2656f, 2.3516f, 2.1728f}},
        {"TiN", {1.6485f, 1.1505f, 1.3798f}, {3.3683f, 1.9435f, 1.1021f}},
        {"TiO2", {3.4566f, 2.8017f, 2.9052f}, {0.0001f, 0.0000f, 0.0007f}},
        {"VC", {3.6576f, 2.7527f, 2.5327f}, {3.0683f, 2.1987f, 1.9632f}},
        {"V_palik", {4.2776f, 3.5130f, 2.7611f}, {3.4913f, 2.8895f, 3.1115f}},
        {"VN", {2.8656f, 2.1192f, 1.9401f}, {3.0322f, 2.0561f, 1.6163f}},
        {"W", {4.3708f, 3.3002f, 2.9984f}, {3.5006f, 2.6049f, 2.2732f}},
    };
    return conductors;
}

// ---------------------------------------------------------------------------------------------------------------------

namespace {

/// A metal's index per channel, or `missing`. In 0.6 what is below 0 is read as 0, which a note says.
ColorD read_metal_index(MaterialReader& reader, const std::string& name, const Color& missing) {
    ColorD index = reader.properties.index_of_refraction(name).value_or(ColorD(missing));
    if (std::min({index.x, index.y, index.z}) >= 0.0) return index;
    const std::string& place = reader.properties.place_of(name);
    if (!reader.is_version_06())
        throw InputError(
            place, fmt::format("{}: expected values of at least 0, got {} {} {}", name, index.x, index.y, index.z));
    reader.source.note(
        fmt::format("{}: {} of {} {} {}: what is below 0 is read as 0", place, name, index.x, index.y, index.z));
    return {std::max(0.0, index.x), std::max(0.0, index.y), std::max(0.0, index.z)};
}

/// The metal that a conductor names; where it names none, copper in 0.6 and the perfect mirror in 3.
const NamedConductor& read_named_metal(Properties& properties) {
    const bool is_version_06 = properties.family() == MitsubaFamily::Version06;
    const std::string wanted = properties.text("material").value_or(is_version_06 ? "Cu" : "none");
    const auto& known = named_conductors();
    const auto found =
        std::find_if(known.begin(), known.end(), [&](const auto& metal) { return metal.name == wanted; });
    if (found != known.end()) return *found;
    std::vector<std::string> names;
    for (const NamedConductor& metal : known) names.push_back(metal.name);
    throw InputError(
        properties.place_of("material"),
        fmt::format("unknown material \"{}\"; known here: {}; or eta and k", wanted, fmt::join(names, ", ")));
}

}  // namespace

/// In 0.6 eta and k replace those of the metal, and both are relative to the medium around it. Mitsuba 3 has either the
/// one or the other.
MetalIndex read_metal(MaterialReader& reader) {
    Properties& properties = reader.properties;
    const NamedConductor& metal = read_named_metal(properties);
    if (metal.name != "none" && (properties.has("eta") || properties.has("k")) && !reader.is_version_06())
        throw InputError(reader.element.place, fmt::format("{}: expected a material's name or eta and k, got both",
                                                           reader.element.attribute("type")));
    const double outside = reader.is_version_06() ? reader.index("ext_eta", "air") : 1.0;
    return {Color(read_metal_index(reader, "eta", metal.eta) / outside),
            Color(read_metal_index(reader, "k", metal.k) / outside)};
}

void require_metal(const MaterialCheck& check, const Color& eta, const Color& k) {
    for (const Color& index : {eta, k})
        check.require(is_finite(index) && std::min({index.x, index.y, index.z}) >= 0.0f, "eta and k of at least 0");
}

Conductor Conductor::read(MaterialReader& reader) {
    const MetalIndex metal = read_metal(reader);
    reader.pass_over_roughness();
    return {.eta = metal.eta,
            .k = metal.k,
            .reflectance = reader.factor_or_texture("specular_reflectance", 1.0, &Conductor::reflectance)};
}

void Conductor::check(const MaterialCheck& check) const {
    check.in_unit_range("reflectance", reflectance);
    require_metal(check, eta, k);
}

}  // namespace photonlab
