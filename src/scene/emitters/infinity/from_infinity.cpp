#include "scene/emitters/infinity/from_infinity.h"

#include "core/sampling.h"

namespace photonlab {

EntryDiscs::EntryDiscs(const SceneExtent& extent) : centre(extent.centre) {
    constexpr double slack = 1.0 + 1e-4;  // so that rounding leaves nothing outside
    constexpr double widening = 4.0;
    radii.push_back(slack * (extent.radius > 0.0 ? extent.radius : 1.0));
    const double all = slack * ((extent.outer_centre - centre).length() + extent.outer_radius);
    while (radii.back() < all) radii.push_back(std::min(widening * radii.back(), all));
    // A last disc that is hardly wider takes the place of the one before it.
    if (radii.size() == 2 && radii[1] < slack * slack * radii[0]) radii = {all};
}

/// The first gets half of the light's rays, the others share the rest.
double EntryDiscs::share_of(std::size_t disc) const {
    if (radii.size() == 1) return 1.0;
    return disc == 0 ? 0.5 : 0.5 / static_cast<double>(radii.size() - 1);
}

EntryDiscs::Entry EntryDiscs::draw(const Vector& direction, const Imath::V2f& u_position, double u_disc) const {
    std::size_t disc = 0;
    double passed = share_of(0);
    while (disc + 1 < radii.size() && u_disc >= passed) passed += share_of(++disc);
    const Imath::V2f point = sample_unit_disc(u_position);
    const Frame frame = make_frame(direction);
    const double x = point.x * radii[disc];
    const double y = point.y * radii[disc];
    const VectorD across = VectorD(frame.tangent) * x + VectorD(frame.bitangent) * y;
    const double squared_distance = x * x + y * y;
    double density = 0.0;
    for (std::size_t other = disc; other < radii.size(); ++other)
        density += share_of(other) / (pi * radii[other] * radii[other]);
    for (std::size_t other = 0; other < disc; ++other)
        if (squared_distance < radii[other] * radii[other])
            density += share_of(other) / (pi * radii[other] * radii[other]);
    const Vector origin(centre + across - VectorD(direction) * radii[disc]);
    Entry entry{.emission = {.ray = {origin, direction}}, .density = density};
    if (radii.size() > 1) entry.emission.from = Vector(centre + across - VectorD(direction) * radii.back());
    return entry;
}

Vector EntryDiscs::beyond(const Vector& receiver, const Vector& direction) const {
    const double distance = (VectorD(receiver) - centre).length() + 2.0 * radii.back();
    return Vector(VectorD(receiver) + VectorD(direction) * distance);
}

}  // namespace photonlab
