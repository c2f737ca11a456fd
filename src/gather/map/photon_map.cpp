#include "gather/map/photon_map.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <string>
#include <utility>

#include "core/error.h"
#include "gather/map/group_search.h"
#include "gather/map/photon_order.h"
#include "gather/map/query_cluster.h"

namespace photonlab {

namespace {

/// What a search gives up for speed.
struct Inexactness {
    double opened_share;          ///< of the reach of a search: within it a group's ball must come to be looked at
    std::size_t queries_at_once;  ///< that a search may answer
};

/// All that `eps` means. An inexact search of a cluster would take the photons of the queries at its edge, so there
/// each query is searched alone.
Inexactness inexactness(double eps) {
    return {1.0 / std::sqrt(1.0 + eps), eps > 0.0 ? 1 : QueryCluster::capacity};
}

/// Gathers the photons that count at the queries of one cluster after the other, and hands them on in runs.
class RunSink {
public:
    RunSink(const std::vector<GatherQuery>& queries, const std::function<void(std::span<const FoundPhoton>)>& take)
        : queries_(queries), take_(take) {}

    void begin(const QueryCluster& cluster) { cluster_ = &cluster; }

    double reach() const { return cluster_->reach(); }
    bool take(const Vector& position, std::size_t index, const Photon& photon) {
        std::array<double, QueryCluster::capacity> squared_distance;
        std::uint64_t inside = cluster_->holding(position, squared_distance);
        if (inside == 0) return false;
        const PhotonSide side(photon);
        for (; inside != 0; inside &= inside - 1) {
            const auto slot = static_cast<std::size_t>(std::countr_zero(inside));
            const std::size_t query = cluster_->first() + slot;
            if (!side.is_accepted_at(queries_[query])) continue;
            if (count_ == capacity) flush();
            run_[count_++] = {squared_distance[slot], static_cast<std::uint32_t>(index),
                              static_cast<std::uint32_t>(query)};
        }
        return false;
    }

    void flush() {
        take_({run_.data(), count_});
        count_ = 0;
    }

private:
    static constexpr std::size_t capacity = 1024;  // 16 KiB: still in the nearest cache when they are handed on

    const std::vector<GatherQuery>& queries_;
    const std::function<void(std::span<const FoundPhoton>)>& take_;
    const QueryCluster* cluster_ = nullptr;
    std::size_t count_ = 0;
    std::array<FoundPhoton, capacity> run_;
};

/// Ties in distance go to the lower index, so that the answer does not depend on the order of the search.
bool is_nearer(const FoundPhoton& a, const FoundPhoton& b) {
    return a.squared_distance != b.squared_distance ? a.squared_distance < b.squared_distance : a.photon < b.photon;
}

/// Keeps the k nearest accepted photons: in order for small k, which is faster there, as a heap for large.
class NearestSink {
public:
    /// `nearest` is the caller's buffer, empty. k >= 1.
    NearestSink(const GatherQuery& query, std::size_t k, double max_squared_radius, std::vector<FoundPhoton>& nearest)
        : query_(query), k_(k), ordered_(k <= 256), squared_radius_(max_squared_radius), nearest_(nearest) {}

    double reach() const { return std::sqrt(squared_radius_); }
    bool take(const Vector& position, std::size_t index, const Photon& photon) {
        const FoundPhoton found{squared_distance_between(position, query_.position), static_cast<std::uint32_t>(index),
                                0};
        if (found.squared_distance > squared_radius_ || !PhotonSide(photon).is_accepted_at(query_)) return false;
        if (nearest_.size() == k_) {
            if (!is_nearer(found, farthest())) return false;
            if (!ordered_) std::pop_heap(nearest_.begin(), nearest_.end(), is_nearer);
            nearest_.pop_back();
        }
        if (ordered_) {
            nearest_.insert(std::upper_bound(nearest_.begin(), nearest_.end(), found, is_nearer), found);
        } else {
            nearest_.push_back(found);
            std::push_heap(nearest_.begin(), nearest_.end(), is_nearer);
        }
        if (nearest_.size() < k_) return false;
        squared_radius_ = farthest().squared_distance;
        return true;
    }

    /// Nearest first, once the search is over.
    void finish() {
        if (!ordered_) std::sort_heap(nearest_.begin(), nearest_.end(), is_nearer);
    }

private:
    const FoundPhoton& farthest() const { return ordered_ ? nearest_.back() : nearest_.front(); }

    const GatherQuery& query_;
    const std::size_t k_;
    const bool ordered_;
    double squared_radius_;  // shrinks to the k-th distance once there are k
    std::vector<FoundPhoton>& nearest_;
};

}  // namespace

PhotonMap::PhotonMap(std::vector<Photon> photons, PhotonNotes notes) {
    const std::size_t given = photons.size();
    // What FLANN cannot square would cost *other* queries their photons.
    for (std::vector<std::uint32_t>* of_photons : {&notes.path, &notes.multiplicity})
        std::erase_if(*of_photons, [&, photon = std::size_t{0}](std::uint32_t) mutable {
            return !is_squarable(photons[photon++].position);
        });
    std::erase_if(photons, [](const Photon& photon) { return !is_squarable(photon.position); });
    nonfinite_ = given - photons.size();
    if (photons.empty()) return;
    if (photons.size() > 0x7fffffff)
        throw InputError("photon map: expected fewer than 2^31 photons in one map, got " +
                         std::to_string(photons.size()));

    const std::uint64_t count = photons.size();
    sort_along_curve(photons, notes);
    photons_ = std::move(photons);
    notes_ = std::move(notes);
    search_ = std::make_unique<const GroupSearch>(photons_);
    bytes_ = count * sizeof(Photon) + (notes_.path.size() + notes_.multiplicity.size()) * sizeof(std::uint32_t) +
             std::max(count * sort_bytes_per_photon, search_->bytes());
}

PhotonMap::PhotonMap(PhotonMap&&) noexcept = default;
PhotonMap& PhotonMap::operator=(PhotonMap&&) noexcept = default;
PhotonMap::~PhotonMap() = default;

void PhotonMap::find_within(const std::vector<GatherQuery>& queries, double eps, const TakeRun& take) const {
    if (!search_) return;
    const Inexactness given_up = inexactness(eps);
    RunSink sink(queries, take);
    for (std::size_t first = 0; first < queries.size();) {
        const QueryCluster cluster(queries, first, given_up.queries_at_once);
        sink.begin(cluster);
        search_->search(photons_, cluster.centre(), given_up.opened_share, sink);
        first = cluster.end();
    }
    sink.flush();
}

NearestPhotons PhotonMap::find_nearest(const GatherQuery& query, std::size_t k, double eps,
                                       const TakeNearest& take) const {
    const double max_radius = std::max(query.radius, minimum_radius);
    NearestPhotons answer{0, max_radius * max_radius};
    if (k == 0 || !search_) return answer;

    // One buffer a thread, so that queries do not allocate. It is borrowed, not shared: `take` may ask the map again.
    thread_local std::vector<FoundPhoton> spare;
    std::vector<FoundPhoton> nearest = std::move(spare);
    nearest.clear();
    NearestSink sink(query, k, answer.squared_radius, nearest);
    search_->search(photons_, query.position, inexactness(eps).opened_share, sink);
    sink.finish();

    answer.found = nearest.size();
    if (nearest.size() == k) {
        // Photons at one and the same position would make this 0, and it is about to be divided by.
        answer.squared_radius = std::max(nearest.back().squared_distance, minimum_radius * minimum_radius);
        nearest.pop_back();
    }
    take(nearest, answer.squared_radius);
    spare = std::move(nearest);
    return answer;
}

}  // namespace photonlab
