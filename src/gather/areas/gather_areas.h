// What the density estimates of a method divide by, point by point: kept for hit points that stay, measured anew for
// those of one pass.
//
// Whole discs are told by the triangles around them and pay nothing more. Where the rest is flat the area follows from
// the triangles as well (flat_area.h); around all other points it is measured by lines (seen_area.h), when a radius
// first needs it. Everything here is a function of the point, its place in the list and the radius, never of what was
// asked before: any method, seed and continuation of a run has the same.

#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "gather/areas/area_weights.h"
#include "gather/areas/flat_area.h"
#include "gather/areas/in_reach.h"
#include "gather/areas/seen_area.h"
#include "gather/kernel.h"
#include "scene/surroundings.h"

namespace photonlab {

/// At one point, for one radius. By default of a whole disc, which most are: of the others the rest lies elsewhere, so
/// that the areas of many points are close together.
class GatherArea {
public:
    GatherArea() = default;
    /// In flat surroundings; where something is hidden, `walls` has what hides it.
    GatherArea(const SurfaceEnd& point, double radius, const AreaWeights& weights,
               std::shared_ptr<const FlatSurroundings> walls);
    /// Elsewhere. `tests_reach`: something is out of reach.
    GatherArea(const SurfaceEnd& point, double radius, const AreaWeights& weights, bool tests_reach);

    /// Every accepted photon counts by the kernel alone.
    bool is_whole() const { return !part_; }

    /// What a photon's kernel weight is multiplied by; empty for one out of reach, which is not accepted.
    std::optional<double> weight(const Scene& scene, const Photon& photon) const {
        if (is_whole()) return 1.0;
        const Vector offset = photon.position - part_->point.position;
        const Imath::V2d in_plane(offset.dot(part_->frame.tangent), offset.dot(part_->frame.bitangent));
        if (part_->walls && is_hidden(*part_->walls, in_plane)) return std::nullopt;
        if (part_->tests_reach && !is_in_reach(scene, part_->point, photon)) return std::nullopt;
        return part_->constant + part_->slope.dot(in_plane);
    }

    static std::uint64_t most_bytes() { return sizeof(GatherArea) + sizeof(Part); }

private:
    struct Part {
        std::shared_ptr<const FlatSurroundings> walls;
        bool tests_reach;
        SurfaceEnd point;
        Frame frame;
        double constant;
        Imath::V2d slope;  // per unit of length
    };
    std::shared_ptr<const Part> part_;
};

struct GatherAreaSettings {
    AreaMode mode = AreaMode::Seen;
    Kernel kernel = Kernel::Disc;
    int lines = default_area_lines;  ///< a ring of seen_area.h
};

class GatherAreas {
public:
    /// Of `points` hit points that stay.
    GatherAreas(const Scene& scene, const GatherAreaSettings& settings, std::size_t points);
    ~GatherAreas();

    /// The area of the disc is taken whatever is there, so that no point need be told.
    bool are_discs() const { return settings_.mode == AreaMode::Disc; }

    /// Of the hit point `index`, which is `point`. Different ones may be asked for at the same time.
    GatherArea at(const SurfaceEnd& point, std::size_t index, double radius);

    /// Of a point that is there in pass `pass` alone: an eighth of the lines, since as many passes have others.
    GatherArea of_pass(const SurfaceEnd& point, std::uint64_t index, std::uint64_t pass, double radius) const;

    std::uint64_t bytes() const;

private:
    /// Radii of one step, without those so near its ends that rounding might count them to the next.
    struct RadiusRange {
        float above = 0.0f;
        float below = 0.0f;
        bool holds(double radius) const { return radius > above && radius < below; }
    };
    static RadiusRange range_of_step(int step, int steps);

    /// What was last asked around a hit point; its radius stays in a step for many passes.
    struct Known {
        RadiusRange range;
        bool is_whole = false;
    };
    struct Around;

    /// The area of the disc is taken whatever is there: so that of points that gather from two sides, of which each has
    /// surroundings of its own.
    bool is_of_disc(const SurfaceEnd& point) const { return are_discs() || point.has_other_side; }
    bool is_whole(const SurfaceEnd& point, Known& known, double radius) const;
    AreaWeights weights_of(const AreaMoments& moments) const;
    GatherArea area_of(const SurfaceEnd& point, const FlatArea& flat,
                       const std::shared_ptr<const FlatSurroundings>& surroundings, double radius) const;
    GatherArea area_of(const SurfaceEnd& point, const SeenArea& measured, double radius) const;

    const Scene& scene_;
    const GatherAreaSettings settings_;
    std::vector<Known> known_;                     // none where the disc's area will do
    std::vector<std::unique_ptr<Around>> around_;  // what was last needed around points that are not whole
};

}  // namespace photonlab
