// What is added up at a hit point beside its flux, for the radius rules and the error estimates that ask
// (gather/moments.h). Each is a policy of the gather loop, so that a method without them pays nothing.

#pragma once

#include <array>
#include <type_traits>

#include "core/math.h"
#include "gather/areas/gather_areas.h"
#include "gather/moments.h"
#include "transport/camera/hit_point_list.h"
#include "transport/light/photons.h"

namespace photonlab {

/// How far a gather looks at one hit point, in the unit box.
struct GatherReach {
    double radius = 0.0;     ///< of the density estimate
    double bandwidth = 0.0;  ///< of the curvature kernel
    GatherArea area = {};    ///< that the density estimate divides by, within the radius
};

/// A photon that was found within the larger of the two.
struct PhotonNear {
    const Photon& photon;
    std::uint32_t times;  ///< that it counts
    double squared_distance;
    ColorD flux;           ///< of all times, times the BRDF, but for what FluxSum::factor() says
    bool is_inside;        ///< the radius
    double kernel_weight;  ///< 0 outside; times the area's
};

/// Sums of which Curvature is made.
class CurvatureSums {
public:
    CurvatureSums(const HitPoint&, const GatherReach& reach)
        : squared_radius_(reach.radius * reach.radius), squared_bandwidth_(reach.bandwidth * reach.bandwidth) {}

    void add(const PhotonNear& near) {
        const ColorD estimate = near.flux * near.kernel_weight;
        squared_estimate_ += estimate * estimate;
        if (!(near.squared_distance < squared_bandwidth_)) return;
        const ColorD bent = near.flux * curvature_kernel(near.squared_distance, squared_bandwidth_);
        laplacian_ += bent;
        squared_laplacian_ += bent * bent;
    }

    /// `factor` on every photon's flux; lengths in units whose square is `squared_unit` in the unit box.
    Curvature of_pass(const ColorD& factor, double paths, double squared_unit) const {
        const double share = 1.0 / (pi * squared_radius_ * paths);
        const double curved = squared_unit / paths;
        return {.squared_estimate = sum(squared_estimate_ * factor * factor) * share * share,
                .laplacian = laplacian_ * factor * curved,
                .squared_laplacian = sum(squared_laplacian_ * factor * factor) * curved * curved};
    }

private:
    static double sum(const ColorD& color) { return color.x + color.y + color.z; }

    double squared_radius_;
    double squared_bandwidth_;
    ColorD squared_estimate_ = ColorD(0.0);
    ColorD laplacian_ = ColorD(0.0);
    ColorD squared_laplacian_ = ColorD(0.0);
};

/// Sums of which Sectors is made.
class SectorSums {
public:
    SectorSums(const HitPoint& point, const GatherReach& reach)
        : centre_(point.position), frame_(make_frame(point.normal)), squared_radius_(reach.radius * reach.radius) {
        flux_.fill(ColorD(0.0));
    }

    void add(const PhotonNear& near) {
        if (!near.is_inside) return;
        const Vector offset = near.photon.position - centre_;
        const std::size_t bin = sector_of(offset.dot(frame_.tangent), offset.dot(frame_.bitangent),
                                          near.squared_distance / squared_radius_);
        count_[bin] += static_cast<double>(near.times);
        flux_[bin] += near.flux;
    }

    Sectors of_pass(const ColorD& factor, double paths) const {
        Sectors sectors{.count = count_, .flux = {}};
        for (std::size_t bin = 0; bin < sector_count; ++bin)
            sectors.flux[bin] = mean_channel(flux_[bin] * factor) / paths;
        return sectors;
    }

private:
    Vector centre_;
    Frame frame_;
    double squared_radius_;
    std::array<double, sector_count> count_{};
    std::array<ColorD, sector_count> flux_;
};

/// In place of sums that nobody asked for.
struct NoSums {
    NoSums(const HitPoint&, const GatherReach&) {}
    void add(const PhotonNear&) {}
};

/// What a pass brings to a region beside its estimate; what was not asked for stays 0.
struct MomentsOfPass {
    Curvature curvature;
    Sectors sectors;

    MomentsOfPass& operator+=(const MomentsOfPass& other) {
        curvature += other.curvature;
        sectors += other.sectors;
        return *this;
    }
};

/// The policy: with either, both or neither.
template <bool with_curvature, bool with_sectors>
class PhotonMoments {
public:
    static constexpr bool has_curvature = with_curvature;
    static constexpr bool are_none = !with_curvature && !with_sectors;

    PhotonMoments(const HitPoint& point, const GatherReach& reach) : curvature_(point, reach), sectors_(point, reach) {}

    void add(const PhotonNear& near) {
        curvature_.add(near);
        sectors_.add(near);
    }

    MomentsOfPass of_pass(const ColorD& factor, double paths, double squared_unit) const {
        MomentsOfPass moments;
        if constexpr (with_curvature) moments.curvature = curvature_.of_pass(factor, paths, squared_unit);
        if constexpr (with_sectors) moments.sectors = sectors_.of_pass(factor, paths);
        return moments;
    }

private:
    [[no_unique_address]] std::conditional_t<with_curvature, CurvatureSums, NoSums> curvature_;
    [[no_unique_address]] std::conditional_t<with_sectors, SectorSums, NoSums> sectors_;
};

using NoMoments = PhotonMoments<false, false>;

/// Calls `call(policy)` with an argument of type std::type_identity<PhotonMoments<...>>: the one that was asked for.
template <typename Call>
void with_moments(bool with_curvature, bool with_sectors, const Call& call) {
    if (with_curvature && with_sectors) return call(std::type_identity<PhotonMoments<true, true>>{});
    if (with_curvature) return call(std::type_identity<PhotonMoments<true, false>>{});
    if (with_sectors) return call(std::type_identity<PhotonMoments<false, true>>{});
    call(std::type_identity<NoMoments>{});
}

}  // namespace photonlab
