// Tables in MERL's layout from formulas: what tests of measured materials compare with. Directions of a table's bin are
// made from its angles by rotating a difference vector to the half vector, the other way round than they are looked up.
//
// [Rusinkiewicz 1998, "A New Change of Variables for Efficient BRDF Representation", equations 1 to 4]

#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "scene/materials/material.h"

namespace photonlab::test {

struct DirectionPair {
    VectorD outgoing;  ///< unit, local frame
    VectorD incoming;
};

/// The pair of directions with these angles, radians; the half vector is turned by phi_h around the normal.
inline DirectionPair directions_at(double theta_h, double theta_d, double phi_d, double phi_h) {
    const auto rotate = [](const VectorD& v, double theta, double phi) {  // about y by theta, then about z by phi
        const double x = v.x * std::cos(theta) + v.z * std::sin(theta);
        const double z = v.z * std::cos(theta) - v.x * std::sin(theta);
        return VectorD(x * std::cos(phi) - v.y * std::sin(phi), x * std::sin(phi) + v.y * std::cos(phi), z);
    };
    const VectorD difference(std::sin(theta_d) * std::cos(phi_d), std::sin(theta_d) * std::sin(phi_d),
                             std::cos(theta_d));
    const VectorD half = rotate(VectorD(0, 0, 1), theta_h, phi_h);
    const VectorD incoming = rotate(difference, theta_h, phi_h);
    return {half * (2.0 * half.dot(incoming)) - incoming, incoming};
}

/// f of two unit directions above the surface, 1/sr.
using Formula = std::function<ColorD(const VectorD& outgoing, const VectorD& incoming)>;

/// A diffuse body and a highlight by Blinn's distribution of half vectors, which grows towards grazing; positive
/// everywhere.
inline Formula shiny_formula(const ColorD& body, double highlight, double exponent) {
    return [=](const VectorD& outgoing, const VectorD& incoming) {
        const VectorD half = (outgoing + incoming).normalized();
        const double fresnel = 0.1 + 0.9 * std::pow(1.0 - half.dot(incoming), 5.0);
        const double lobe = (exponent + 2.0) / (2.0 * pi) * std::pow(half.z, exponent);
        return body / pi + ColorD(highlight * fresnel * lobe / 4.0);
    };
}

/// The numbers of a file whose bins hold the formula at their middles; -1 where a direction is below the horizon.
inline std::vector<double> numbers_of(const Formula& formula) {
    std::vector<double> numbers(3 * static_cast<std::size_t>(MerlTable::bins));
    std::size_t bin = 0;
    for (int half = 0; half < 90; ++half)
        for (int difference = 0; difference < 90; ++difference)
            for (int azimuth = 0; azimuth < 180; ++azimuth, ++bin) {
                const double root = (half + 0.5) / 90.0;
                const DirectionPair at = directions_at(root * root * pi / 2.0, (difference + 0.5) / 90.0 * pi / 2.0,
                                                       (azimuth + 0.5) / 180.0 * pi, 0.0);
                const bool above = at.outgoing.z > 0.0 && at.incoming.z > 0.0;
                const ColorD value = above ? formula(at.outgoing, at.incoming) : ColorD(0.0);
                const double scale[] = {1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0};
                for (int channel = 0; channel < 3; ++channel)
                    numbers[static_cast<std::size_t>(channel) * MerlTable::bins + bin] =
                        above ? value[channel] / scale[channel] : -1.0;
            }
    return numbers;
}

inline Material measured(std::shared_ptr<const MerlTable> table) {
    return {.id = "measured", .bsdf = Merl{table.get()}, .data = table};
}

inline Material measured(const Formula& formula) {
    return measured(make_merl_table(numbers_of(formula), "test"));
}

/// The formula's reflected share of light from `outgoing`: the integral of f cos by the midpoint rule over the square
/// of the sine and the azimuth.
inline ColorD albedo_of(const Formula& formula, const VectorD& outgoing) {
    constexpr int steps = 1000;
    ColorD sum(0.0);
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
            const double sine2 = (i + 0.5) / steps;
            const double phi = 2.0 * pi * (j + 0.5) / steps;
            const double sine = std::sqrt(sine2);
            sum += formula(outgoing, VectorD(sine * std::cos(phi), sine * std::sin(phi), std::sqrt(1.0 - sine2)));
        }
    return sum * (pi / (steps * steps));
}

}  // namespace photonlab::test
