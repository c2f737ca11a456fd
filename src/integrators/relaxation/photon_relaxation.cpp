#include "integrators/relaxation/photon_relaxation.h"

#include <cassert>

#include "core/parallel.h"

namespace photonlab {

namespace {

constexpr std::size_t photons_per_block = 256;
constexpr double lift = 0.5;  // of the length of a move: how far above and below its end the surface is looked for
constexpr float least_agreement = 0.5f;  // of normals, as where photons are gathered

GatherQuery query_of(const Photon& photon) {
    return {photon.position, photon.normal.unit(), largest_length};
}

/// Where the photon goes in one step; the same place where it stays.
VectorD target_of(const PhotonMap& map, std::size_t index, bool protects_features) {
    const Photon& photon = map.photons()[index];
    const GatherQuery query = query_of(photon);
    const VectorD normal(query.normal);
    const VectorD position(photon.position);
    std::vector<Neighbour> neighbours;
    const std::size_t asked = protects_features ? feature_neighbours : pushing_neighbours;
    neighbours.reserve(asked + 1);
    // Itself is found too, and the last that is asked for is not shown but sets the radius.
    const NearestPhotons nearest = map.nearest(query, asked + 2, [&](const Photon& other, double, double) {
        const VectorD offset = VectorD(other.position) - position;
        const double flux = mean_channel(ColorD(other.power));
        if (&other != &photon && flux > 0.0) neighbours.push_back({offset - normal * offset.dot(normal), flux});
    });
    if (neighbours.size() < pushing_neighbours) return position;
    VectorD force = relaxation_force({neighbours.data(), pushing_neighbours}, mean_channel(ColorD(photon.power)));
    if (protects_features)
        if (const std::optional<VectorD> gradient = significant_gradient(neighbours, std::sqrt(nearest.squared_radius)))
            force -= *gradient * gradient->dot(force);
    return position + force * 0.5;
}

/// The photon at the surface below or above `target`, if there is one that can hold it.
std::optional<Photon> moved_to(const Scene& scene, const Photon& photon, const VectorD& target) {
    const Vector normal = photon.normal.unit();
    const float reach = static_cast<float>(lift * (target - VectorD(photon.position)).length());
    if (!(reach > 0.0f)) return std::nullopt;
    const std::optional<Hit> hit =
        intersect_between(scene, {Vector(target) + normal * reach, -normal}, 0.0f, 2.0f * reach);
    if (!hit) return std::nullopt;
    const std::optional<Surface> surface = orient_to_gather(scene, *hit, normal);
    if (!surface || !is_scattering(surface->bsdf) || surface->frame.normal.dot(normal) <= least_agreement)
        return std::nullopt;
    Photon moved = photon;
    moved.position = surface->position;
    moved.incoming = PackedDirection(surface->frame.normal);
    moved.normal = CoarseDirection(surface->frame.normal);
    moved.from_back = surface->from_back;
    return moved;
}

PhotonMap after_a_step(const Scene& scene, const PhotonMap& map, bool protects_features, int threads) {
    std::vector<Photon> photons(map.photons().begin(), map.photons().end());
    parallel_for(block_count(photons.size(), photons_per_block), threads, [&](std::size_t block) {
        const BlockRange range = block_range(block, photons.size(), photons_per_block);
        for (std::size_t i = range.begin; i < range.end; ++i)
            if (const std::optional<Photon> moved = moved_to(scene, photons[i], target_of(map, i, protects_features)))
                photons[i] = *moved;
    });
    return PhotonMap(std::move(photons));
}

}  // namespace

VectorD relaxation_force(std::span<const Neighbour> nearest, double own_flux) {
    double flux = own_flux;
    double reach = 0.0;
    for (const Neighbour& neighbour : nearest) {
        flux += neighbour.flux;
        reach = std::max(reach, neighbour.offset.length());
    }
    VectorD force(0.0);
    if (!(flux > 0.0)) return force;
    const auto count = static_cast<double>(nearest.size());
    for (const Neighbour& neighbour : nearest) {
        const double distance = neighbour.offset.length();
        const double weight = neighbour.flux * (count + 1.0) / flux;
        if (distance > 0.0) force -= neighbour.offset * (weight * (reach / distance - 1.0) / count);
    }
    return force;
}

std::optional<VectorD> significant_gradient(std::span<const Neighbour> neighbours, double radius) {
    VectorD sum(0.0);
    double squares = 0.0;
    for (const Neighbour& neighbour : neighbours) {
        sum += neighbour.offset * neighbour.flux;
        squares += neighbour.flux * neighbour.flux;
    }
    if (!(4.0 * sum.length2() > gradient_threshold * radius * radius * squares)) return std::nullopt;
    return sum.normalized();
}

PhotonMap relaxed(const Scene& scene, const PhotonMap& map, const RelaxationSettings& settings, int threads) {
    PhotonMap moved(std::vector<Photon>(map.photons().begin(), map.photons().end()));
    for (int step = 0; step < settings.steps; ++step)
        moved = after_a_step(scene, moved, settings.protects_features, threads);
    return moved;
}

std::uint64_t add_to_nearest(const PhotonMap& primal, const PhotonMap& photons, int threads,
                             std::vector<ColorD>& sums) {
    assert(sums.size() == primal.size());
    constexpr std::size_t none = static_cast<std::size_t>(-1);
    std::vector<std::size_t> owner(photons.size(), none);
    parallel_for(block_count(owner.size(), photons_per_block), threads, [&](std::size_t block) {
        const BlockRange range = block_range(block, owner.size(), photons_per_block);
        for (std::size_t i = range.begin; i < range.end; ++i)
            // The nearest alone, since the second carries nothing.
            primal.nearest(query_of(photons.photons()[i]), 2, [&](const Photon& nearest, double, double) {
                if (owner[i] == none) owner[i] = primal.index_of(nearest);
            });
    });
    std::uint64_t left_out = 0;
    for (std::size_t i = 0; i < owner.size(); ++i) {
        if (owner[i] == none)
            ++left_out;
        else
            sums[owner[i]] += ColorD(photons.photons()[i].power);
    }
    return left_out;
}

PhotonMap with_power(const PhotonMap& primal, const std::vector<ColorD>& sums, double paths) {
    std::vector<Photon> photons(primal.photons().begin(), primal.photons().end());
    for (std::size_t i = 0; i < photons.size(); ++i) {
        photons[i].power = Color(sums[i] / paths);
        photons[i].edges = 1;
    }
    return PhotonMap(std::move(photons));
}

}  // namespace photonlab
