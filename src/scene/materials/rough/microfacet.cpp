#include "scene/materials/rough/microfacet.h"

#include "core/sampling.h"

namespace photonlab {

namespace {

double tangent_squared(const Vector& v) {
    const double z = v.z;
    return (static_cast<double>(v.x) * v.x + static_cast<double>(v.y) * v.y) / (z * z);
}

/// The squared slope of a normal, in units of alpha along both axes.
double squared_in_alphas(const Vector& normal, const Microfacets& facets) {
    const double squared = static_cast<double>(facets.alpha_u) * facets.alpha_u;
    if (!facets.is_anisotropic()) return tangent_squared(normal) / squared;
    const double x = static_cast<double>(normal.x) / facets.alpha_u;
    const double y = static_cast<double>(normal.y) / facets.alpha_v;
    const double z = normal.z;
    return (x * x + y * y) / (z * z);
}

/// The squared tangent of a direction, as from the surface that is stretched to alpha 1.
double squared_times_alphas(const Vector& direction, const Microfacets& facets) {
    const double alpha_u = facets.alpha_u;
    if (!facets.is_anisotropic()) return alpha_u * alpha_u * tangent_squared(direction);
    const double x = alpha_u * direction.x;
    const double y = static_cast<double>(facets.alpha_v) * direction.y;
    const double z = direction.z;
    return (x * x + y * y) / (z * z);
}

/// The power whose lobe is as wide as Beckmann's. [Walter et al. 2007, after equation 31]
double phong_exponent(double alpha) {
    return std::max(0.0, 2.0 / (alpha * alpha) - 2.0);
}

/// Smith's Lambda: 1 / (1 + Lambda) is the share that is seen. [Heitz 2014, equations 68 and 72]
double smith_lambda(const Microfacets& facets, const Vector& direction) {
    const double scaled = squared_times_alphas(direction, facets);  // 1 / a^2
    if (facets.slopes == FacetSlopes::Ggx) return 0.5 * (std::sqrt(1.0 + scaled) - 1.0);
    if (!(scaled > 0.0)) return 0.0;
    const double a = 1.0 / std::sqrt(scaled);
    if (a > 6.0) return 0.0;  // below 1e-17
    return 0.5 * (std::exp(-a * a) / (a * std::sqrt(pi)) - std::erfc(a));
}

/// A slope along the view's direction among those that a Beckmann surface of alpha 1 shows to a view `cosine` above it:
/// the density is proportional to max(0, cosine - sine x) exp(-x^2), whose integral from -infinity is inverted by
/// Newton's steps in a bracket. Positive x leans away. [Heitz & d'Eon 2014, "Importance Sampling Microfacet-Based BSDFs
/// using the Distribution of Visible Normals"]
double beckmann_slope(double cosine, double u) {
    const double sine = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
    const double half_root = 0.5 * std::sqrt(pi);
    const double end = sine > 0.0 ? std::min(cosine / sine, 6.0) : 6.0;
    const auto integral = [&](double x) { return cosine * half_root * std::erfc(-x) + 0.5 * sine * std::exp(-x * x); };
    const double wanted = u * integral(end);
    double low = -6.0;
    double high = end;
    double x = std::clamp(0.0, low, high);
    for (int step = 0; step < 60; ++step) {
        const double error = integral(x) - wanted;
        (error > 0.0 ? high : low) = x;
        const double slope = (cosine - sine * x) * std::exp(-x * x);
        double next = x - error / slope;
        if (!(next > low && next < high)) next = 0.5 * (low + high);
        if (std::abs(next - x) < 1e-12) return next;
        x = next;
    }
    return x;
}

/// The inverse of erf, by Newton's steps from a rational start. [Giles 2010, "Approximating the erfinv function"]
double inverse_erf(double y) {
    double x = 0.0;
    const double w = std::log(std::max(1e-300, (1.0 - y) * (1.0 + y)));
    const double a = 2.0 / (pi * 0.147) + 0.5 * w;
    x = std::copysign(std::sqrt(std::max(0.0, std::sqrt(a * a - w / 0.147) - a)), y);
    for (int step = 0; step < 3; ++step) x -= (std::erf(x) - y) / (2.0 / std::sqrt(pi) * std::exp(-x * x));
    return x;
}

/// The direction as a surface of alpha 1 is seen that is stretched with it.
VectorD stretched_direction(const Vector& direction, const Microfacets& facets) {
    const double alpha_u = facets.alpha_u;
    const double alpha_v = facets.alpha_v;
    return VectorD(alpha_u * direction.x, alpha_v * direction.y, direction.z).normalized();
}

Vector sample_beckmann(const Vector& direction, const Microfacets& facets, const Imath::V2f& u) {
    const VectorD stretched = stretched_direction(direction, facets);
    const double along = beckmann_slope(stretched.z, std::clamp(static_cast<double>(u.x), 1e-9, 1.0 - 1e-9));
    const double across = inverse_erf(std::clamp(2.0 * u.y - 1.0, -1.0 + 1e-7, 1.0 - 1e-7));
    const double sine = std::hypot(stretched.x, stretched.y);
    const double x = sine > 0.0 ? stretched.x / sine : 1.0;
    const double y = sine > 0.0 ? stretched.y / sine : 0.0;
    // `along` is the slope in the direction of view: a facet that leans away from it has one above 0.
    const double slope_x = facets.alpha_u * (along * x - across * y);
    const double slope_y = facets.alpha_v * (along * y + across * x);
    return Vector(VectorD(-slope_x, -slope_y, 1.0).normalized());
}

/// [Heitz 2018, "Sampling the GGX Distribution of Visible Normals"]
Vector sample_ggx(const Vector& direction, const Microfacets& facets, const Imath::V2f& u) {
    const VectorD stretched = stretched_direction(direction, facets);
    const double sine = std::hypot(stretched.x, stretched.y);
    const VectorD first = sine > 0.0 ? VectorD(-stretched.y, stretched.x, 0.0) / sine : VectorD(1.0, 0.0, 0.0);
    const VectorD second = stretched.cross(first);
    const Imath::V2f disc = sample_unit_disc(u);
    const double share = 0.5 * (1.0 + stretched.z);
    const double a = disc.x;
    const double rest = std::sqrt(std::max(0.0, 1.0 - a * a));
    const double b = (1.0 - share) * rest + share * disc.y;
    const VectorD normal = first * a + second * b + stretched * std::sqrt(std::max(0.0, 1.0 - a * a - b * b));
    return Vector(
        VectorD(facets.alpha_u * normal.x, facets.alpha_v * normal.y, std::max(1e-12, normal.z)).normalized());
}

/// The exponent in the direction of (x, y).
double phong_exponent_along(double x, double y, const Microfacets& facets) {
    const double along_u = phong_exponent(facets.alpha_u);
    const double squared = x * x + y * y;
    if (!facets.is_anisotropic() || !(squared > 0.0)) return along_u;
    return (along_u * x * x + phong_exponent(facets.alpha_v) * y * y) / squared;
}

Vector sample_phong(const Microfacets& facets, const Imath::V2f& u) {
    double angle = 2.0 * pi * u.y;
    if (facets.is_anisotropic())  // more of them where the exponent is low
        angle = std::atan2(std::sqrt(phong_exponent(facets.alpha_u) + 2.0) * std::sin(angle),
                           std::sqrt(phong_exponent(facets.alpha_v) + 2.0) * std::cos(angle));
    const double exponent = phong_exponent_along(std::cos(angle), std::sin(angle), facets);
    const double cosine = std::pow(1.0 - static_cast<double>(u.x), 1.0 / (exponent + 2.0));
    const double sine = std::sqrt(std::max(0.0, (1.0 - cosine) * (1.0 + cosine)));
    return Vector(VectorD(sine * std::cos(angle), sine * std::sin(angle), cosine));
}

}  // namespace

double Microfacets::distribution(const Vector& normal) const {
    if (!(normal.z > 0.0f)) return 0.0;
    const double z = normal.z;
    const double squared = static_cast<double>(alpha_u) * alpha_v;
    if (slopes == FacetSlopes::Phong) {
        const double along_u = phong_exponent(alpha_u) + 2.0;
        const double both = is_anisotropic() ? std::sqrt(along_u * (phong_exponent(alpha_v) + 2.0)) : along_u;
        return both / (2.0 * pi) * std::pow(z, phong_exponent_along(normal.x, normal.y, *this));
    }
    const double slope = squared_in_alphas(normal, *this);
    if (slopes == FacetSlopes::Beckmann) return std::exp(-slope) / (pi * squared * z * z * z * z);
    return 1.0 / (pi * squared * z * z * z * z * (1.0 + slope) * (1.0 + slope));
}

double Microfacets::unhidden(const Vector& direction, const Vector& normal) const {
    // A facet turned away from the direction's side of the surface is not seen from there.
    if (!(direction.dot(normal) * direction.z > 0.0f)) return 0.0;
    return 1.0 / (1.0 + smith_lambda(*this, direction));
}

double Microfacets::reflected(const Vector& outgoing, const Vector& incoming, const Vector& normal) const {
    return distribution(normal) * unhidden(outgoing, normal) * unhidden(incoming, normal) /
           (4.0 * outgoing.z * incoming.z);
}

double Microfacets::density(const Vector& direction, const Vector& normal) const {
    if (slopes == FacetSlopes::Phong) return distribution(normal) * normal.z;
    const double seen = unhidden(direction, normal) * std::abs(static_cast<double>(direction.dot(normal)));
    return distribution(normal) * seen / std::abs(static_cast<double>(direction.z));
}

Vector Microfacets::sample(const Vector& direction, const Imath::V2f& u) const {
    if (slopes == FacetSlopes::Phong) return sample_phong(*this, u);
    return slopes == FacetSlopes::Ggx ? sample_ggx(direction, *this, u) : sample_beckmann(direction, *this, u);
}

double Microfacets::weight(const Vector& outgoing, const Vector& incoming, const Vector& normal) const {
    const double unhidden_on_leaving = unhidden(incoming, normal);
    if (slopes != FacetSlopes::Phong) return unhidden_on_leaving;
    return unhidden(outgoing, normal) * unhidden_on_leaving * std::abs(static_cast<double>(outgoing.dot(normal))) /
           (std::abs(static_cast<double>(outgoing.z)) * normal.z);
}

}  // namespace photonlab
