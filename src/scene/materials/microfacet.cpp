#include "scene/materials/microfacet.h"

#include "core/sampling.h"

namespace photonlab {

namespace {

double tangent_squared(const Vector& v) {
    const double z = v.z;
    return (static_cast<double>(v.x) * v.x + static_cast<double>(v.y) * v.y) / (z * z);
}

/// The power whose lobe is as wide as Beckmann's. [Walter et al. 2007, after equation 31]
double phong_exponent(double alpha) {
    return std::max(0.0, 2.0 / (alpha * alpha) - 2.0);
}

/// Smith's Lambda: 1 / (1 + Lambda) is the share that is seen. [Heitz 2014, equations 68 and 72]
double smith_lambda(FacetSlopes slopes, double alpha, double squared_tangent) {
    const double scaled = alpha * alpha * squared_tangent;  // 1 / a^2
    if (slopes == FacetSlopes::Ggx) return 0.5 * (std::sqrt(1.0 + scaled) - 1.0);
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

Vector sample_beckmann(const Vector& direction, double alpha, const Imath::V2f& u) {
    // Slopes of a surface of alpha 1, seen from the direction that is stretched with it.
    const VectorD stretched = VectorD(alpha * direction.x, alpha * direction.y, direction.z).normalized();
    const double along = beckmann_slope(stretched.z, std::clamp(static_cast<double>(u.x), 1e-9, 1.0 - 1e-9));
    const double across = inverse_erf(std::clamp(2.0 * u.y - 1.0, -1.0 + 1e-7, 1.0 - 1e-7));
    const double sine = std::hypot(stretched.x, stretched.y);
    const double x = sine > 0.0 ? stretched.x / sine : 1.0;
    const double y = sine > 0.0 ? stretched.y / sine : 0.0;
    // `along` is the slope in the direction of view: a facet that leans away from it has one above 0.
    const double slope_x = alpha * (along * x - across * y);
    const double slope_y = alpha * (along * y + across * x);
    return Vector(VectorD(-slope_x, -slope_y, 1.0).normalized());
}

/// [Heitz 2018, "Sampling the GGX Distribution of Visible Normals"]
Vector sample_ggx(const Vector& direction, double alpha, const Imath::V2f& u) {
    const VectorD stretched = VectorD(alpha * direction.x, alpha * direction.y, direction.z).normalized();
    const double sine = std::hypot(stretched.x, stretched.y);
    const VectorD first = sine > 0.0 ? VectorD(-stretched.y, stretched.x, 0.0) / sine : VectorD(1.0, 0.0, 0.0);
    const VectorD second = stretched.cross(first);
    const Imath::V2f disc = sample_unit_disc(u);
    const double share = 0.5 * (1.0 + stretched.z);
    const double a = disc.x;
    const double rest = std::sqrt(std::max(0.0, 1.0 - a * a));
    const double b = (1.0 - share) * rest + share * disc.y;
    const VectorD normal = first * a + second * b + stretched * std::sqrt(std::max(0.0, 1.0 - a * a - b * b));
    return Vector(VectorD(alpha * normal.x, alpha * normal.y, std::max(1e-12, normal.z)).normalized());
}

Vector sample_phong(double alpha, const Imath::V2f& u) {
    const double cosine = std::pow(1.0 - static_cast<double>(u.x), 1.0 / (phong_exponent(alpha) + 2.0));
    const double sine = std::sqrt(std::max(0.0, (1.0 - cosine) * (1.0 + cosine)));
    const double angle = 2.0 * pi * u.y;
    return Vector(VectorD(sine * std::cos(angle), sine * std::sin(angle), cosine));
}

}  // namespace

double Microfacets::distribution(const Vector& normal) const {
    if (!(normal.z > 0.0f)) return 0.0;
    const double z = normal.z;
    const double squared = static_cast<double>(alpha) * alpha;
    if (slopes == FacetSlopes::Phong) {
        const double exponent = phong_exponent(alpha);
        return (exponent + 2.0) / (2.0 * pi) * std::pow(z, exponent);
    }
    const double slope = tangent_squared(normal) / squared;
    if (slopes == FacetSlopes::Beckmann) return std::exp(-slope) / (pi * squared * z * z * z * z);
    return 1.0 / (pi * squared * z * z * z * z * (1.0 + slope) * (1.0 + slope));
}

double Microfacets::unhidden(const Vector& direction, const Vector& normal) const {
    // A facet turned away from the direction's side of the surface is not seen from there.
    if (!(direction.dot(normal) * direction.z > 0.0f)) return 0.0;
    return 1.0 / (1.0 + smith_lambda(slopes, alpha, tangent_squared(direction)));
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
    if (slopes == FacetSlopes::Phong) return sample_phong(alpha, u);
    return slopes == FacetSlopes::Ggx ? sample_ggx(direction, alpha, u) : sample_beckmann(direction, alpha, u);
}

double Microfacets::weight(const Vector& outgoing, const Vector& incoming, const Vector& normal) const {
    const double unhidden_on_leaving = unhidden(incoming, normal);
    if (slopes != FacetSlopes::Phong) return unhidden_on_leaving;
    return unhidden(outgoing, normal) * unhidden_on_leaving * std::abs(static_cast<double>(outgoing.dot(normal))) /
           (std::abs(static_cast<double>(outgoing.z)) * normal.z);
}

}  // namespace photonlab
