// Two other ways to find the photons within a radius, to measure the gather layer against: a uniform grid, whose cells
// are as wide as the mean diameter, and nanoflann's k-d tree. Both search each query alone, over photons in the order
// of their own structure, and count the photons that PhotonMap would.

#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <nanoflann.hpp>
#include <utility>
#include <vector>

#include "core/morton.h"
#include "gather/map/photon_map.h"
#include "gather/map/photon_order.h"

namespace photonlab::benchmarks {

/// True when the photon counts: as PhotonMap decides it.
inline bool counts(const Photon& photon, const GatherQuery& query) {
    return squared_distance_between(photon.position, query.position) <= query.radius * query.radius &&
           PhotonSide(photon).is_accepted_at(query);
}

/// Photons sorted by the cell they lie in. [Teschner et al. 2003, without the hash]
class UniformGrid {
public:
    /// `cell` is the wanted width of a cell; they are widened until there are no more than four a photon.
    UniformGrid(std::vector<Photon> photons, double cell) : cell_(cell) {
        Box box;
        for (const Photon& photon : photons) box.include(photon.position);
        lower_ = box.lower;
        for (;; cell_ *= 1.25) {
            for (int axis = 0; axis < 3; ++axis)
                cells_[static_cast<std::size_t>(axis)] =
                    static_cast<std::int64_t>((static_cast<double>(box.upper[axis]) - lower_[axis]) / cell_) + 1;
            if (cells_[0] * cells_[1] * cells_[2] <= 4 * static_cast<std::int64_t>(photons.size())) break;
        }
        starts_.assign(static_cast<std::size_t>(cells_[0] * cells_[1] * cells_[2]) + 1, 0);
        const auto index_of = [&](const Photon& photon) {
            return index(cell_at(photon.position.x, 0), cell_at(photon.position.y, 1), cell_at(photon.position.z, 2));
        };
        for (const Photon& photon : photons) ++starts_[index_of(photon) + 1];
        for (std::size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
        std::vector<std::uint32_t> next(starts_.begin(), starts_.end() - 1);
        photons_.resize(photons.size());
        for (const Photon& photon : photons) photons_[next[index_of(photon)]++] = photon;
    }

    template <typename Visit>
    void within(const GatherQuery& query, const Visit& visit) const {
        std::array<std::int64_t, 3> first;
        std::array<std::int64_t, 3> last;
        for (int axis = 0; axis < 3; ++axis) {
            // A hair wider, so that rounding loses nothing at the rim; the exact test follows.
            const double reach = query.radius * (1.0 + 1e-6) + 1e-9;
            first[static_cast<std::size_t>(axis)] = cell_at(query.position[axis] - reach, axis);
            last[static_cast<std::size_t>(axis)] = cell_at(query.position[axis] + reach, axis);
        }
        for (std::int64_t z = first[2]; z <= last[2]; ++z)
            for (std::int64_t y = first[1]; y <= last[1]; ++y)  // cells along x lie side by side
                for (std::uint32_t i = starts_[index(first[0], y, z)]; i < starts_[index(last[0], y, z) + 1]; ++i)
                    if (counts(photons_[i], query)) visit(photons_[i]);
    }

    std::uint64_t bytes() const { return photons_.size() * sizeof(Photon) + starts_.size() * sizeof(std::uint32_t); }

private:
    std::int64_t cell_at(double position, int axis) const {
        const auto cell = static_cast<std::int64_t>(std::floor((position - lower_[axis]) / cell_));
        return std::clamp<std::int64_t>(cell, 0, cells_[static_cast<std::size_t>(axis)] - 1);
    }
    std::size_t index(std::int64_t x, std::int64_t y, std::int64_t z) const {
        return static_cast<std::size_t>((z * cells_[1] + y) * cells_[0] + x);
    }

    std::vector<Photon> photons_;
    std::vector<std::uint32_t> starts_;
    std::array<std::int64_t, 3> cells_{};
    Vector lower_;
    double cell_;
};

/// nanoflann's static tree, given the photons along a Morton curve, as FLANN is.
class NanoflannMap {
public:
    explicit NanoflannMap(std::vector<Photon> photons) : photons_{sorted(std::move(photons))} {
        index_ = std::make_unique<Index>(3, photons_, nanoflann::KDTreeSingleIndexAdaptorParams(32));
        index_->buildIndex();
    }

    template <typename Visit>
    void within(const GatherQuery& query, const Visit& visit) const {
        // A hair wider, so that float loses nothing at the rim; the exact test follows.
        const auto bound = static_cast<float>(query.radius * query.radius * (1.0 + 1e-5));
        Visitor<Visit> visitor{photons_.list, query, bound, visit};
        index_->findNeighbors(visitor, &query.position.x, {});
    }

    std::uint64_t bytes() const { return photons_.list.size() * sizeof(Photon) + index_->usedMemory(*index_); }

private:
    struct Photons {
        std::vector<Photon> list;
        std::size_t kdtree_get_point_count() const { return list.size(); }
        float kdtree_get_pt(std::size_t i, std::size_t axis) const { return list[i].position[static_cast<int>(axis)]; }
        template <typename Box>
        bool kdtree_get_bbox(Box&) const {
            return false;
        }
    };
    using Index =
        nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Photons>, Photons, 3, std::uint32_t>;

    template <typename Visit>
    struct Visitor {
        using DistanceType = float;
        const std::vector<Photon>& photons;
        const GatherQuery& query;
        float bound;
        const Visit& visit;
        std::size_t size() const { return 0; }
        bool full() const { return true; }
        float worstDist() const { return bound; }
        bool addPoint(float, std::uint32_t index) const {
            if (counts(photons[index], query)) visit(photons[index]);
            return true;
        }
    };

    static std::vector<Photon> sorted(std::vector<Photon> photons) {
        PhotonNotes none;
        sort_along_curve(photons, none);
        return photons;
    }

    Photons photons_;
    std::unique_ptr<Index> index_;
};

}  // namespace photonlab::benchmarks
