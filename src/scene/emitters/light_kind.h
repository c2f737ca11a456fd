// What every kind of light speaks in, and what it answers. Power here is power in scene units divided by
// unit_length^2, lengths are those of the unit box.

#pragma once

#include <optional>
#include <vector>

#include "scene/shapes/shape.h"

namespace photonlab {

struct LightReader;

/// A point on a light as seen from a receiver.
struct DirectSample {
    Vector position;   ///< on the light, already moved off its surface towards the receiver
    Vector direction;  ///< unit, from the receiver to `position`
    ColorD radiance;   ///< towards the receiver; of what is met by no ray its irradiance across `direction`: of a point
                       ///< intensity / distance^2
    double density;    ///< per steradian at the receiver, without the choice of light; 1 for what is met by no ray
    bool is_delta;     ///< no other technique can find it
};

/// Random numbers that choose where light leaves, and in which direction.
struct EmissionDraw {
    Imath::V2f u_position;
    double u_triangle;
    Imath::V2f u_direction;
};

/// Light that leaves for somewhere.
struct Emission {
    Ray ray;                          ///< its origin already moved off the emitter's surface
    ColorD share = ColorD(1.0);       ///< power that this ray stands for, in shares of the light's: 1 in the mean
    std::optional<Vector> from = {};  ///< where light from infinity comes from, if not from the ray's origin already:
                                      ///< it begins there when something is between the two
};

/// The scene around its lights.
struct SceneExtent {
    ToUnitBox to_unit_box;
    // Balls, unit box: around the surfaces that the box is made for, and around all.
    VectorD centre = VectorD(0.0);
    double radius = 1.0;
    VectorD outer_centre = VectorD(0.0);
    double outer_radius = 1.0;
};

/// Every light. `is_met_by_rays` is false where no ray from the camera can find the light. power() is all that it
/// emits, or of what comes from infinity all that arrives at the scene; emit() draws a ray by it.
template <typename Kind>
concept LightKind = requires(const Kind& light, const std::vector<Shape>& shapes, const EmissionDraw& draw,
                             const Vector& receiver, const Imath::V2f& u) {
    { Kind::name } -> std::convertible_to<const char*>;
    { Kind::is_met_by_rays } -> std::convertible_to<bool>;
    { light.power(shapes) } -> std::same_as<ColorD>;
    { light.emit(shapes, draw) } -> std::same_as<Emission>;
    { light.sample_direct(shapes, receiver, u, 0.5) } -> std::same_as<std::optional<DirectSample>>;
};

/// A light that no shape bears. read() gives its description in scene units, check() throws InputError for what cannot
/// be rendered, and placed() takes it to the unit box. Its bounds() are empty when it lies at infinity.
template <typename Kind>
concept SceneLightKind = LightKind<Kind> &&
    requires(const typename Kind::Description& description, LightReader& reader, const SceneExtent& extent) {
    { Kind::read(reader) } -> std::same_as<typename Kind::Description>;
    { description.place } -> std::convertible_to<std::string>;
    { description.sampling_weight } -> std::convertible_to<double>;
    { description.check() } -> std::same_as<void>;
    { description.bounds() } -> std::same_as<Bounds>;
    { description.placed(extent) } -> std::same_as<Kind>;
};

/// A light around the scene, which every ray that leaves it finds: its radiance from there, and with which density per
/// steradian sample_direct() draws the direction; both are unit and point away from the scene.
template <typename Kind>
concept EnvironmentKind = requires(const Kind& light, const Vector& direction) {
    { light.radiance_from(direction) } -> std::same_as<ColorD>;
    { light.density_of(direction) } -> std::same_as<double>;
};

template <SceneLightKind... Kinds>
using SceneLightOf = std::variant<Kinds...>;

/// Throws InputError unless the values are finite and at least 0.
void require_light(const ColorD& light, const std::string& place, std::string_view what);

}  // namespace photonlab
