#include "scene/materials/conductor.h"

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

}  // namespace photonlab
