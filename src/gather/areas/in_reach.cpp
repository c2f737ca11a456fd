#include "gather/areas/in_reach.h"

#include <array>
#include <bit>
#include <cassert>

namespace photonlab {

namespace {

constexpr float rise_share = 1.0f / 6.0f;  // of the distance between the two

/// The ends of the way from a point to a photon, on their surfaces and lifted.
struct Way {
    Vector from;  ///< off the point's surface by more than rounding
    Vector to;    ///< off the photon's
    Vector from_normal;
    Vector to_normal;
    float rise;

    Way(const SurfaceEnd& point, const Photon& photon)
        : from_normal(point.geometric_normal),
          to_normal(photon.normal.unit()),
          rise(rise_share * (photon.position - point.position).length()) {
        from = offset_from_surface(point.position, from_normal, from_normal);
        to = offset_from_surface(photon.position, to_normal, to_normal);
    }
    Vector risen_from() const { return from + from_normal * rise; }
    Vector risen_to() const { return to + to_normal * rise; }
};

bool is_free(const Scene& scene, const Vector& from, const Vector& to) {
    return from == to || !is_occluded(scene, {from, to});
}

bool is_free_over_a_bulge(const Scene& scene, const Way& way) {
    return is_free(scene, way.risen_from(), way.risen_to()) && is_free(scene, way.from, way.risen_from()) &&
           is_free(scene, way.to, way.risen_to());
}

}  // namespace

bool is_in_reach(const Scene& scene, const SurfaceEnd& point, const Photon& photon) {
    const Way way(point, photon);
    return is_free(scene, way.from, way.to) || is_free_over_a_bulge(scene, way);
}

unsigned in_reach_of_eight(const Scene& scene, const SurfaceEnd& point, std::span<const Photon> photons) {
    assert(photons.size() <= 8);
    std::array<Segment, 8> segments;
    for (std::size_t i = 0; i < photons.size(); ++i) {
        const Way way(point, photons[i]);
        segments[i] = {way.from, way.to};
    }
    const unsigned all = (1u << photons.size()) - 1u;
    const unsigned occluded = occluded_of_eight(scene, std::span(segments).first(photons.size())) & all;
    unsigned in_reach = all & ~occluded;
    for (unsigned left = occluded; left != 0; left &= left - 1) {
        const auto i = static_cast<std::size_t>(std::countr_zero(left));
        const Way way(point, photons[i]);
        if (way.from == way.to || is_free_over_a_bulge(scene, way)) in_reach |= 1u << i;
    }
    return in_reach;
}

}  // namespace photonlab
