#include "scene/materials/conductor.h"

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
    result.add({-outgoing.x, -outgoing.y, outgoing.z}, weight);
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
// as several renderers publish them (Mitsuba, Tungsten).
const std::vector<NamedConductor>& named_conductors() {
    static const std::vector<NamedConductor> conductors{
        {"none", Color(0.0f), Color(1.0f)},
        {"Ag", {0.155265f, 0.116723f, 0.138381f}, {4.828343f, 3.122246f, 2.147050f}},
        {"Al", {1.657460f, 0.880369f, 0.521229f}, {9.223869f, 6.269523f, 4.837001f}},
        {"Au", {0.143119f, 0.374957f, 1.442479f}, {3.983160f, 2.385721f, 1.603215f}},
        {"Cr", {4.369683f, 2.916702f, 1.654701f}, {5.206434f, 4.231365f, 3.754947f}},
        {"Cu", {0.200438f, 0.924033f, 1.102212f}, {3.912949f, 2.452848f, 2.142188f}},
    };
    return conductors;
}

// ---------------------------------------------------------------------------------------------------------------------

namespace {

/// A metal's index per channel, or `missing`.
ColorD read_metal_index(Properties& properties, const std::string& name, const Color& missing) {
    const ColorD index = properties.index_of_refraction(name).value_or(ColorD(missing));
    if (std::min({index.x, index.y, index.z}) < 0.0)
        throw InputError(properties.place_of(name), fmt::format("{}: expected values of at least 0, got {} {} {}", name,
                                                                index.x, index.y, index.z));
    return index;
}

/// The metal that a conductor names; where it names none, copper in 0.6 and the perfect mirror in 3.
const NamedConductor& read_metal(Properties& properties) {
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
Conductor Conductor::read(MaterialReader& reader) {
    Properties& properties = reader.properties;
    Conductor conductor;
    conductor.reflectance = reader.factor("specular_reflectance", 1.0);
    const NamedConductor& metal = read_metal(properties);
    if (metal.name != "none" && (properties.has("eta") || properties.has("k")) && !reader.is_version_06())
        throw InputError(reader.element.place, "conductor: expected a material's name or eta and k, got both");
    const double outside = reader.is_version_06() ? reader.index("ext_eta", "air") : 1.0;
    conductor.eta = Color(read_metal_index(properties, "eta", metal.eta) / outside);
    conductor.k = Color(read_metal_index(properties, "k", metal.k) / outside);
    return conductor;
}

void Conductor::check(const MaterialCheck& check) const {
    check.in_unit_range("reflectance", reflectance);
    for (const Color& index : {eta, k})
        check.require(is_finite(index) && std::min({index.x, index.y, index.z}) >= 0.0f, "eta and k of at least 0");
}

}  // namespace photonlab
