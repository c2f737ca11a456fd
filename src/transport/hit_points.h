// The camera pass: where each sample position of the image sees a non-specular surface. Every integrator, PM, PPM and
// the path tracer alike, starts from these same points, so what differs between them is what they estimate there
// and nothing else.
//
// Mirrors and glass are followed into all their branches, without chance, until a branch meets a surface that can be
// gathered at, or carries too little to be seen.
//
// [Hachisuka et al. 2008, "Progressive Photon Mapping": the eye pass]

#pragma once

#include <cstdint>
#include <vector>

#include "core/math.h"
#include "scene/scene.h"

namespace photonlab {

/// A point to gather at. Const once made; what changes from pass to pass is in GatherStatistics.
struct HitPoint {
    Vector position;
    Vector normal;               ///< shading normal, unit, facing `outgoing`
    Vector geometric_normal;     ///< unit, facing `outgoing`
    Vector outgoing;             ///< unit, towards the camera's side of the path; the normal where the material is
                                 ///< diffuse and looks the same from everywhere
    Color weight;                ///< path throughput from here to the pixel, times the sample's share of the pixel
    std::uint32_t pixel;         ///< y * width + x
    std::uint16_t material;      ///< index into Scene::materials
    std::uint16_t camera_edges;  ///< edges of the path from the camera to here; 1 when seen directly
    Imath::V2f texture_coordinate;
};

/// Hit points, each in 20 bytes and what it does not share with its neighbours. They are stored once and read often:
/// elements are made when they are asked for.
class HitPointList {
public:
    /// What the scene makes worth keeping; without it, all points have the same.
    struct Kept {
        bool outgoing = true;  ///< some material that is gathered at is not diffuse
        bool texture_coordinates = true;
    };

    static Kept kept_for(const Scene& scene);

    /// `share`: weight of points that the camera sees directly.
    explicit HitPointList(float share = 1.0f, Kept keeps = {true, true}) : share_(share), keeps_(keeps) {}

    void reserve(std::size_t count) { records_.reserve(count); }
    void push_back(const HitPoint& point, bool is_diffuse);
    void append(const HitPointList& other);
    void clear();  ///< keeps the memory

    std::size_t size() const { return records_.size(); }
    bool empty() const { return records_.empty(); }
    HitPoint operator[](std::size_t index) const {
        const Record& record = records_[index];
        const bool is_plain = (record.seen & of_view) == 0;
        const std::uint32_t view_index = record.seen & ~of_view;
        const Facing& facing = facings_[is_plain ? record.seen : views_[view_index].facing];
        HitPoint point{.position = record.position,
                       .normal = facing.normal,
                       .geometric_normal = facing.geometric_normal,
                       .outgoing = facing.normal,
                       .weight = Color(share_),
                       .pixel = record.pixel,
                       .material = facing.material,
                       .camera_edges = 1,
                       .texture_coordinate = Imath::V2f(0.0f)};
        if (!is_plain) {
            const View& view = views_[view_index];
            point.weight = view.weight;
            point.camera_edges = view.camera_edges;
            if (keeps_.outgoing) point.outgoing = outgoing_[view_index];
        }
        if (keeps_.texture_coordinates) point.texture_coordinate = texture_coordinates_[index];
        return point;
    }
    HitPoint at(std::size_t index) const;  ///< std::out_of_range where there is none

    class Iterator {
    public:
        Iterator(const HitPointList& list, std::size_t index) : list_(list), index_(index) {}
        HitPoint operator*() const { return list_[index_]; }
        Iterator& operator++() {
            ++index_;
            return *this;
        }
        bool operator!=(const Iterator& other) const { return index_ != other.index_; }

    private:
        const HitPointList& list_;
        std::size_t index_;
    };
    Iterator begin() const { return {*this, 0}; }
    Iterator end() const { return {*this, size()}; }

    std::uint64_t bytes() const;

private:
    static constexpr std::uint32_t of_view = 1u << 31;

    struct Record {
        Vector position;
        std::uint32_t pixel;
        std::uint32_t seen;  // index into facings_, or, with the bit of_view, into views_
    };
    /// What neighbours on a flat surface share.
    struct Facing {
        Vector normal;
        Vector geometric_normal;
        std::uint16_t material;
        bool operator==(const Facing&) const = default;
    };
    /// Of points that are seen by mirrors or glass, or whose material is not diffuse: all others are seen in the same
    /// way.
    struct View {
        Color weight;
        std::uint32_t facing;  // into facings_
        std::uint16_t camera_edges;
    };

    float share_;
    Kept keeps_;
    std::vector<Record> records_;
    std::vector<Facing> facings_;
    std::vector<View> views_;
    std::vector<Vector> outgoing_;                 // one a view, or none
    std::vector<Imath::V2f> texture_coordinates_;  // one a point, or none
};

/// Light that the camera sees without a bounce at a hit point.
struct SeenEmission {
    std::uint32_t pixel;
    std::uint32_t edges;  ///< of the path from the camera to the light; 1 when seen directly
    ColorD radiance;      ///< times the path's throughput and the sample's share of the pixel
};

inline constexpr std::size_t hit_points_per_block = 256;  ///< handed to a thread at a time

/// The result of the camera pass.
struct HitPoints {
    int width = 0;
    int height = 0;
    int samples_per_pixel = 1;
    HitPointList points;  ///< tile by tile and along a Morton curve in each, so that neighbours in the list are
                          ///< neighbours in space; those of a pixel follow each other
    std::vector<float>
        footprints;  ///< one a point, unit box: unfolded distance from the camera times the pixel's angle
    std::vector<std::uint8_t> search_order;  ///< of each block of hit_points_per_block points, their indices in it in
                                             ///< the order to search them in, along a Morton curve: neighbours in the
                                             ///< image are neighbours in space only where no edge or mirror is between
    std::vector<SeenEmission> emission;      ///< that of a pixel follows each other
    double weight_cut = 0.0;      ///< throughput of the branches that were ended, mean channel, mean over pixels
    std::uint64_t nonfinite = 0;  ///< camera paths that met a non-finite value
};

/// Where camera branches end unless a method says otherwise, and always those of a reference.
inline constexpr double default_branch_cutoff = 1e-4;

/// Traces the deterministic grid of sample positions: `samples_per_pixel` is a perfect square, 1 is the pixel's centre.
/// Specular branches whose throughput (strongest channel) is below `branch_cutoff`, above 0, end, and so do those of
/// 10,000 edges.
HitPoints trace_hit_points(const Scene& scene, int samples_per_pixel, int threads,
                           double branch_cutoff = default_branch_cutoff);

/// The same through another camera than the scene's: of fewer pixels, to know what is coming.
HitPoints trace_hit_points(const Scene& scene, const Camera& camera, int samples_per_pixel, int threads,
                           double branch_cutoff);

inline std::size_t pixel_count(const HitPoints& hit_points) {
    return static_cast<std::size_t>(hit_points.width) * static_cast<std::size_t>(hit_points.height);
}

/// Of the points and what is kept with them.
inline std::uint64_t hit_point_bytes(const HitPoints& hit_points) {
    return hit_points.points.bytes() + hit_points.footprints.size() * sizeof(float) + hit_points.search_order.size();
}

/// One a pixel: the emission that paths of at most max_depth edges see.
std::vector<ColorD> emission_image(const HitPoints& hit_points, int max_depth);

/// True when a path of `edges` edges from camera to light may count; max_depth -1 is unlimited.
inline bool depth_allows(int max_depth, std::uint32_t edges) {
    return max_depth < 0 || edges <= static_cast<std::uint32_t>(max_depth);
}

/// The hit point as a surface to be shaded.
Surface surface_at(const Scene& scene, const HitPoint& point);

}  // namespace photonlab
