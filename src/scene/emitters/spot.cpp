#include "scene/emitters/spot.h"

#include <fmt/format.h>

#include <cmath>

#include "core/error.h"
#include "core/sampling.h"
#include "scene/emitters/light_reader.h"
#include "scene/mitsuba/transform.h"

namespace photonlab {

namespace {

double one_minus_cosine(double angle) {
    const double sine = std::sin(0.5 * angle);
    return 2.0 * sine * sine;
}

/// What the light sends out, by integration over its cone.
ColorD integrate(const Spot& spot) {
    if (!spot.texture) {
        // 2 pi I (1 - (sin c - sin b) / (c - b)), where c is the cutoff and b the beam, and its limit for b = c.
        const double between = spot.cutoff_angle - spot.beam_angle;
        const double share = between > 1e-6 ? 1.0 - (std::sin(spot.cutoff_angle) - std::sin(spot.beam_angle)) / between
                                            : one_minus_cosine(spot.cutoff_angle);
        return spot.intensity * (2.0 * pi * share);
    }
    constexpr int steps = 256;
    ColorD sum(0.0);
    const double whole = one_minus_cosine(spot.cutoff_angle);
    for (int i = 0; i < steps; ++i)
        for (int j = 0; j < steps; ++j) {
            const double cosine = 1.0 - whole * (i + 0.5) / steps;
            const double sine = std::sqrt(std::max(0.0, (1.0 - cosine) * (1.0 + cosine)));
            const double angle = 2.0 * pi * (j + 0.5) / steps;
            sum += spot.intensity_along(spot.axes[0] * (sine * std::cos(angle)) +
                                        spot.axes[1] * (sine * std::sin(angle)) + spot.axes[2] * cosine);
        }
    return sum * (2.0 * pi * whole / (steps * steps));
}

}  // namespace

ColorD Spot::intensity_along(const VectorD& direction) const {
    const double along = direction.dot(axes[2]);
    const double across_x = direction.dot(axes[0]);
    const double across_y = direction.dot(axes[1]);
    const double angle = std::atan2(std::hypot(across_x, across_y), along);
    if (!(angle < cutoff_angle)) return ColorD(0.0);
    ColorD result = intensity;
    if (texture && along > 0.0) {
        const Imath::V2d uv(0.5 + 0.5 * across_x / (along * texture_tangent),
                            0.5 + 0.5 * across_y / (along * texture_tangent));
        result *= ColorD(color_at(*texture, Imath::V2f(uv)));
    }
    if (angle > beam_angle) result *= (cutoff_angle - angle) / (cutoff_angle - beam_angle);
    return result;
}

Emission Spot::emit(const std::vector<Shape>&, const EmissionDraw& draw) const {
    const double whole = one_minus_cosine(cutoff_angle);
    const Vector local = sample_cone(draw.u_direction, static_cast<float>(whole));
    const VectorD direction = axes[0] * static_cast<double>(local.x) + axes[1] * static_cast<double>(local.y) +
                              axes[2] * static_cast<double>(local.z);
    ColorD share = intensity_along(direction) * (2.0 * pi * whole);
    for (int channel = 0; channel < 3; ++channel)
        share[channel] = all[channel] > 0.0 ? share[channel] / all[channel] : 0.0;
    return {{position, Vector(direction.normalized())}, share};
}

std::optional<DirectSample> Spot::sample_direct(const std::vector<Shape>&, const Vector& receiver, const Imath::V2f&,
                                                double) const {
    const VectorD to_light = VectorD(position) - VectorD(receiver);
    const double squared_distance = to_light.length2();
    if (!(squared_distance > 0.0)) return std::nullopt;
    const VectorD direction = to_light / std::sqrt(squared_distance);
    return DirectSample{.position = position,
                        .direction = Vector(direction),
                        .radiance = intensity_along(-direction) / squared_distance,
                        .density = 1.0,
                        .is_delta = true};
}

SpotDescription Spot::read(LightReader& reader) {
    const auto angle = [&](const std::string& name, double missing, bool may_be_zero) {
        const double degrees = reader.properties.number(name).value_or(missing);
        if (!((degrees > 0.0 || (may_be_zero && degrees == 0.0)) && degrees < 180.0))
            throw InputError(reader.properties.place_of(name), fmt::format("{}: expected degrees in {}0, 180), got {}",
                                                                           name, may_be_zero ? "[" : "(", degrees));
        return degrees;
    };
    SpotDescription spot{
        .position = transform_point(reader.properties.transform("to_world").value_or(Matrix()), VectorD(0.0)),
        .axes = reader.axes(),
        .intensity = reader.light("intensity", ColorD(1.0)),
        .place = reader.element.place};
    const double cutoff = angle("cutoff_angle", 20.0, false);
    const double beam = angle("beam_width", 0.75 * cutoff, true);
    if (beam > cutoff)
        throw InputError(reader.properties.place_of("beam_width"),
                         fmt::format("beam_width: expected at most cutoff_angle, {}, got {}", cutoff, beam));
    spot.cutoff_angle = cutoff * pi / 180.0;
    spot.beam_angle = beam * pi / 180.0;
    for (const XmlElement* object : reader.properties.objects()) {
        const XmlElement& plugin = reader.source.resolve(*object);
        if (plugin.tag != "texture" || object->attribute("name") != "texture" || spot.texture)
            throw InputError(object->place, fmt::format("spot: expected one texture called texture, got <{}> \"{}\"",
                                                        object->tag, object->attribute("name")));
        spot.texture = std::make_shared<const Texture>(read_texture(plugin, reader.source, TextureUse::Number));
    }
    return spot;
}

void SpotDescription::check() const {
    require_light(intensity, place, "intensity");
    if (!is_finite(position)) throw InputError(place, "position is not finite");
    if (texture) require_factor_on_light(*texture, place);
    if (!(cutoff_angle > 0.0 && cutoff_angle < pi && beam_angle >= 0.0 && beam_angle <= cutoff_angle))
        throw InputError(place, "expected a cutoff in (0, 180) degrees and a beam that is not wider");
}

Spot SpotDescription::placed(const SceneExtent& extent) const {
    const double unit_length = extent.to_unit_box.unit_length;
    Spot spot{.position = place_point(position, extent, place),
              .axes = axes,
              .intensity = intensity / (unit_length * unit_length),
              .cutoff_angle = cutoff_angle,
              .beam_angle = beam_angle,
              .texture = texture,
              .texture_tangent = std::tan(cutoff_angle),
              .all = ColorD(0.0)};
    spot.all = integrate(spot);
    return spot;
}

}  // namespace photonlab
