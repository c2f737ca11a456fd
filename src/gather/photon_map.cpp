#include "gather/photon_map.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>
#include <string>

#include "core/error.h"
#include "core/morton.h"

namespace photonlab {

namespace {

constexpr int leaf_max_size = 8;

/// A place along a curve in the upper half, the photon's index in the lower.
using SortKey = std::uint64_t;

std::size_t index_of(SortKey key) {
    return static_cast<std::size_t>(key & 0xffffffffu);
}

/// By place, then by index, by which they are sorted already: a stable least-significant-digit radix sort, or for few
/// keys an ordinary one.
void sort_keys(std::span<SortKey> keys) {
    constexpr std::size_t few = 2048;
    if (keys.size() <= few) return std::sort(keys.begin(), keys.end());
    constexpr unsigned digit_bits = MortonCurve::bits_per_axis;
    constexpr std::size_t buckets = std::size_t{1} << digit_bits;
    std::vector<SortKey> other(keys.size());
    std::span<SortKey> from = keys;
    std::span<SortKey> to = other;
    for (unsigned shift = 32; shift < 32 + 3 * digit_bits; shift += digit_bits) {
        std::array<std::size_t, buckets> starts{};
        for (const SortKey key : from) ++starts[key >> shift & (buckets - 1)];
        std::size_t next = 0;
        for (std::size_t& start : starts) {
            const std::size_t count = start;
            start = next;
            next += count;
        }
        for (const SortKey key : from) to[starts[key >> shift & (buckets - 1)]++] = key;
        std::swap(from, to);
    }
    std::copy(from.begin(), from.end(), keys.begin());  // three digits: they are in `other`
}

/// Puts the keys into the order of their photons along a Morton curve, and those that share a place on it along a finer
/// one of their own: a caustic may be smaller than a cell of the scene.
void sort_along_curve(const std::vector<Photon>& photons, std::span<SortKey> keys) {
    Box box;
    for (const SortKey key : keys) box.include(photons[index_of(key)].position);
    const MortonCurve curve(box);
    for (SortKey& key : keys)
        key = std::uint64_t{curve.place_of(photons[index_of(key)].position)} << 32 | index_of(key);
    sort_keys(keys);
    for (std::size_t first = 0; first < keys.size();) {
        std::size_t end = first + 1;
        while (end < keys.size() && keys[end] >> 32 == keys[first] >> 32) ++end;
        const std::size_t count = end - first;
        // As many as there are: all of them at one point.
        if (count > PhotonGroups::capacity && count < keys.size())
            sort_along_curve(photons, keys.subspan(first, count));
        first = end;
    }
}

/// Puts the photons into the order of the keys, in place: a second copy of them would be the peak of memory.
void permute(std::vector<Photon>& photons, std::vector<SortKey>& keys) {
    const auto source = [&](std::size_t place) { return index_of(keys[place]); };
    for (std::size_t start = 0; start < photons.size(); ++start) {
        const Photon first = photons[start];
        std::size_t place = start;
        while (source(place) != start) {
            const std::size_t from = source(place);
            photons[place] = photons[from];
            keys[place] = place;
            place = from;
        }
        photons[place] = first;
        keys[place] = place;
    }
}

/// Keeps the k nearest accepted photons: in order for small k, which is faster there, as a heap for large.
class NearestSink {
public:
    /// `neighbours` is the caller's buffer, emptied here. k >= 1.
    NearestSink(const Vector& position, const Vector& normal, std::size_t k, double max_squared_radius,
                std::vector<Neighbour>& neighbours)
        : position_(position),
          normal_(normal),
          k_(k),
          ordered_(k <= 256),
          squared_radius_(max_squared_radius),
          neighbours_(neighbours) {
        neighbours_.clear();
    }

    double reach() const { return std::sqrt(squared_radius_); }
    bool take(const Vector& position, std::size_t index, const Photon& photon) {
        const Neighbour neighbour{squared_distance_between(position, position_), static_cast<std::uint32_t>(index)};
        if (neighbour.squared_distance > squared_radius_ || !is_accepted(photon, normal_)) return false;
        if (neighbours_.size() == k_) {
            if (!(neighbour < farthest())) return false;
            if (!ordered_) std::pop_heap(neighbours_.begin(), neighbours_.end());
            neighbours_.pop_back();
        }
        if (ordered_) {
            neighbours_.insert(std::upper_bound(neighbours_.begin(), neighbours_.end(), neighbour), neighbour);
        } else {
            neighbours_.push_back(neighbour);
            std::push_heap(neighbours_.begin(), neighbours_.end());
        }
        if (neighbours_.size() < k_) return false;
        squared_radius_ = farthest().squared_distance;
        return true;
    }

    /// Nearest first, once the search is over.
    void finish() {
        if (!ordered_) std::sort_heap(neighbours_.begin(), neighbours_.end());
    }

private:
    const Neighbour& farthest() const { return ordered_ ? neighbours_.back() : neighbours_.front(); }

    const Vector position_;
    const Vector normal_;
    const std::size_t k_;
    const bool ordered_;
    double squared_radius_;  // shrinks to the k-th distance once there are k
    std::vector<Neighbour>& neighbours_;
};

}  // namespace

PhotonMap::PhotonMap(std::vector<Photon> photons) {
    const std::size_t given = photons.size();
    // What FLANN cannot square would cost *other* queries their photons.
    std::erase_if(photons, [](const Photon& photon) { return !is_squarable(photon.position); });
    nonfinite_ = given - photons.size();
    if (photons.empty()) return;
    if (photons.size() > 0x7fffffff)
        throw InputError("photon map: expected fewer than 2^31 photons in one map, got " +
                         std::to_string(photons.size()));

    const std::uint64_t count = photons.size();
    const std::uint64_t photon_bytes = count * sizeof(Photon);
    {
        std::vector<SortKey> keys(photons.size());
        std::iota(keys.begin(), keys.end(), SortKey{0});
        sort_along_curve(photons, keys);
        permute(photons, keys);
    }
    photons_ = std::move(photons);

    groups_ = PhotonGroups(photons_);
    // FLANN reports its nodes and permutation, in an int that wraps at 2 GB, and not its pointer to each point nor its
    // reordered copy of the positions.
    std::uint64_t index_bytes = groups_.list().size() * (sizeof(float*) + 3 * sizeof(float));
    for (const GroupTier& tier : groups_.tiers()) {
        // FLANN takes what it is given as not const, and only reads it.
        auto* first_centre = const_cast<float*>(&groups_.list()[tier.first].centre.x);
        const flann::Matrix<float> centres(first_centre, tier.end - tier.first, 3, sizeof(PhotonGroup));
        indices_.push_back(std::make_unique<Index>(centres, flann::KDTreeSingleIndexParams(leaf_max_size, true)));
        indices_.back()->buildIndex();
        index_bytes += static_cast<std::uint32_t>(indices_.back()->usedMemory());
    }
    bytes_ = photon_bytes + std::max(2 * count * sizeof(SortKey), groups_.bytes() + index_bytes);
}

void PhotonMap::find_nearest(const Vector& position, const Vector& normal, std::size_t k, double max_squared_radius,
                             double eps, std::vector<Neighbour>& neighbours) const {
    neighbours.clear();
    if (k == 0) return;
    NearestSink sink(position, normal, k, max_squared_radius, neighbours);
    search(position, eps, sink);
    sink.finish();
}

}  // namespace photonlab
