// Hit points as they are kept: packed, since an image has millions. A point takes 20 bytes in place of 76 where it is
// seen directly on a flat diffuse surface, and 20 to 43 in the scenes here; with PPM's statistics that is 89 in place
// of 145 in the Cornell box. What neighbours share is stored once, what a scene has no use for is not stored.

#pragma once

#include <cstdint>
#include <vector>

#include "core/math.h"
#include "scene/scene.h"

namespace photonlab {

/// A point to gather at. Const once made; what changes from pass to pass is in the statistics of a method.
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
    float turn = 0.0f;       ///< of its frame about `normal`, as make_frame() takes it; 0 where no f depends on it
    bool from_back = false;  ///< `outgoing` is on the shape's inside
    bool is_after_glossy = false;  ///< the path was spread on its way here: direct light is of the layer gathered
};

/// Stored once and read often: elements are made when they are asked for.
class HitPointList {
public:
    /// What the scene makes worth keeping; without it, all points have the same.
    struct Kept {
        bool outgoing = true;  ///< some material that is gathered at is not diffuse
        bool texture_coordinates = true;
        bool turns = true;  ///< some material is anisotropic
    };

    static Kept kept_for(const Scene& scene);

    /// `share`: weight of points that the camera sees directly.
    explicit HitPointList(float share = 1.0f, Kept keeps = {true, true, true}) : share_(share), keeps_(keeps) {}

    void reserve(std::size_t count) { records_.reserve(count); }
    void push_back(const HitPoint& point, bool is_diffuse);
    void append(const HitPointList& other);
    void clear();  ///< keeps the memory

    std::size_t size() const { return records_.size(); }
    bool empty() const { return records_.empty(); }
    /// Inlined, so that nothing is unpacked that is not looked at.
    [[gnu::always_inline]] HitPoint operator[](std::size_t index) const {
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
                       .texture_coordinate = Imath::V2f(0.0f),
                       .from_back = facing.from_back};
        if (!is_plain) {
            const View& view = views_[view_index];
            point.weight = view.weight;
            point.camera_edges = view.camera_edges;
            point.is_after_glossy = view.is_after_glossy;
            if (keeps_.outgoing) point.outgoing = outgoing_[view_index];
        }
        if (keeps_.texture_coordinates) point.texture_coordinate = texture_coordinates_[index];
        if (keeps_.turns) point.turn = turns_[index];
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
        bool from_back;
        bool operator==(const Facing&) const = default;
    };
    /// Of points that are seen by mirrors or glass, or whose material is not diffuse: all others are seen in the same
    /// way.
    struct View {
        Color weight;
        std::uint32_t facing;  // into facings_
        std::uint16_t camera_edges;
        bool is_after_glossy;
    };

    float share_;
    Kept keeps_;
    std::vector<Record> records_;
    std::vector<Facing> facings_;
    std::vector<View> views_;
    std::vector<Vector> outgoing_;                 // one a view, or none
    std::vector<Imath::V2f> texture_coordinates_;  // one a point, or none
    std::vector<float> turns_;                     // one a point, or none
};

inline constexpr std::size_t hit_points_per_block = 256;  ///< handed to a thread at a time

/// The hit point as a surface to be shaded.
Surface surface_at(const Scene& scene, const HitPoint& point);

}  // namespace photonlab
