#include "transport/camera/hit_point_list.h"

#include <algorithm>
#include <stdexcept>

#include "core/error.h"

namespace photonlab {

HitPointList::Kept HitPointList::kept_for(const Scene& scene) {
    Kept kept{false, false, false};
    for (const Shape& shape : scene.shapes) {
        const Material& material = scene.materials[shape.material];
        if (may_look_different_from_elsewhere(material)) kept.outgoing = true;
        if (needs_texture_coordinates(material)) kept.texture_coordinates = true;
        if (material.is_anisotropic) kept.turns = true;
    }
    return kept;
}

void HitPointList::push_back(const HitPoint& point, bool is_diffuse) {
    constexpr std::size_t searched = 32;  // surfaces that meet in a tile are few
    const Facing facing{point.normal, point.geometric_normal, point.material, point.from_back};
    std::size_t index = facings_.size();
    for (std::size_t back = 1; back <= std::min(searched, facings_.size()) && index == facings_.size(); ++back)
        if (facings_[facings_.size() - back] == facing) index = facings_.size() - back;
    if (index == facings_.size()) facings_.push_back(facing);

    const bool is_plain = is_diffuse && point.camera_edges == 1 && point.weight == Color(share_);
    const auto facing_index = static_cast<std::uint32_t>(index);
    const auto view_index = static_cast<std::uint32_t>(views_.size());
    records_.push_back(
        {.position = point.position, .pixel = point.pixel, .seen = is_plain ? facing_index : view_index | of_view});
    if (!is_plain) views_.push_back({point.weight, facing_index, point.camera_edges, point.is_after_glossy});
    if (!is_plain && keeps_.outgoing) outgoing_.push_back(is_diffuse ? point.normal : point.outgoing);
    if (keeps_.texture_coordinates) texture_coordinates_.push_back(point.texture_coordinate);
    if (keeps_.turns) turns_.push_back(point.turn);
}

void HitPointList::append(const HitPointList& other) {
    const auto first_facing = static_cast<std::uint32_t>(facings_.size());
    const auto first_view = static_cast<std::uint32_t>(views_.size());
    if (std::max(facings_.size() + other.facings_.size(), views_.size() + other.views_.size()) >= of_view)
        throw InputError("expected fewer than 2^31 hit points in an image");
    for (Record record : other.records_) {
        record.seen += (record.seen & of_view) == 0 ? first_facing : first_view;
        records_.push_back(record);
    }
    facings_.insert(facings_.end(), other.facings_.begin(), other.facings_.end());
    for (View view : other.views_) {
        view.facing += first_facing;
        views_.push_back(view);
    }
    outgoing_.insert(outgoing_.end(), other.outgoing_.begin(), other.outgoing_.end());
    texture_coordinates_.insert(texture_coordinates_.end(), other.texture_coordinates_.begin(),
                                other.texture_coordinates_.end());
    turns_.insert(turns_.end(), other.turns_.begin(), other.turns_.end());
}

void HitPointList::clear() {
    records_.clear();
    facings_.clear();
    views_.clear();
    outgoing_.clear();
    texture_coordinates_.clear();
    turns_.clear();
}

HitPoint HitPointList::at(std::size_t index) const {
    if (index >= size()) throw std::out_of_range("HitPointList::at");
    return (*this)[index];
}

std::uint64_t HitPointList::bytes() const {
    return records_.size() * sizeof(Record) + facings_.size() * sizeof(Facing) + views_.size() * sizeof(View) +
           outgoing_.size() * sizeof(Vector) + texture_coordinates_.size() * sizeof(Imath::V2f) +
           turns_.size() * sizeof(float);
}

Surface surface_at(const Scene& scene, const HitPoint& point) {
    return {.bsdf = bsdf_at(scene.materials[point.material], point.texture_coordinate, point.from_back),
            .material = point.material,
            .texture_coordinate = point.texture_coordinate,
            .frame = make_frame(point.normal, point.turn),
            .geometric_normal = point.geometric_normal,
            .position = point.position,
            .from_back = point.from_back};
}

}  // namespace photonlab
