#include "gather/map/photon_order.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <memory>
#include <numeric>
#include <span>
#include <utility>

#include "core/morton.h"
#include "core/parallel.h"
#include "gather/map/photon_groups.h"

namespace photonlab {

namespace {

/// A place along a curve in the upper half, the photon's index in the lower.
using SortKey = std::uint64_t;
static_assert(sort_bytes_per_photon == sizeof(SortKey) + std::max(sizeof(SortKey), part_bytes_of_photon));

std::size_t index_of(SortKey key) {
    return static_cast<std::size_t>(key & 0xffffffffu);
}

/// Calls `body` for pieces of `count` items. Where other threads of a parallel loop wait for its end, as beside
/// PassLoop's, they take pieces too.
template <typename Body>
void in_pieces(std::size_t count, std::size_t piece_size, const Body& body) {
    const auto pieces = static_cast<std::int64_t>(block_count(count, piece_size));
    if (pieces <= 1) return body(BlockRange{0, count});
#pragma omp taskloop grainsize(1) default(shared)
    for (std::int64_t piece = 0; piece < pieces; ++piece)
        body(block_range(static_cast<std::size_t>(piece), count, piece_size));
}

constexpr std::size_t photons_in_piece = 16384;

/// By place, then by index, by which they are sorted already: a stable least-significant-digit radix sort, or for few
/// keys an ordinary one. Each piece of the keys has places of its own among those of a digit.
void sort_keys(std::span<SortKey> keys) {
    constexpr std::size_t few = 2048;
    if (keys.size() <= few) return std::sort(keys.begin(), keys.end());
    constexpr unsigned digit_bits = MortonCurve::bits_per_axis;
    constexpr std::size_t buckets = std::size_t{1} << digit_bits;
    std::vector<SortKey> other(keys.size());
    std::span<SortKey> from = keys;
    std::span<SortKey> to = other;
    constexpr std::size_t most_pieces = 64;
    const std::size_t piece_size = std::max(photons_in_piece, keys.size() / most_pieces + 1);
    std::vector<std::array<std::uint32_t, buckets>> starts(block_count(keys.size(), piece_size));
    for (unsigned shift = 32; shift < 32 + 3 * digit_bits; shift += digit_bits) {
        in_pieces(keys.size(), piece_size, [&](const BlockRange& piece) {
            auto& own = starts[piece.begin / piece_size];
            own.fill(0);
            for (const SortKey key : from.subspan(piece.begin, piece.end - piece.begin))
                ++own[key >> shift & (buckets - 1)];
        });
        std::uint32_t next = 0;
        for (std::size_t bucket = 0; bucket < buckets; ++bucket)
            for (auto& of_piece : starts) next += std::exchange(of_piece[bucket], next);
        in_pieces(keys.size(), piece_size, [&](const BlockRange& piece) {
            std::array<std::uint32_t, buckets> own = starts[piece.begin / piece_size];
            for (const SortKey key : from.subspan(piece.begin, piece.end - piece.begin))
                to[own[key >> shift & (buckets - 1)]++] = key;
        });
        std::swap(from, to);
    }
    std::copy(from.begin(), from.end(), keys.begin());  // three digits: they are in `other`
}

/// Puts the keys into the order of their photons along a curve, and those that share a place on it along one of theirs.
void sort_along_curve(const std::vector<Photon>& photons, std::span<SortKey> keys) {
    Box box;
    for (const SortKey key : keys) box.include(photons[index_of(key)].position);
    const MortonCurve curve(box);
    in_pieces(keys.size(), photons_in_piece, [&](const BlockRange& piece) {
        for (SortKey& key : keys.subspan(piece.begin, piece.end - piece.begin))
            key = std::uint64_t{curve.place_of(photons[index_of(key)].position)} << 32 | index_of(key);
    });
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

/// What is moved of every photon at once: plain numbers, as all of it.
using Part = std::array<std::byte, part_bytes_of_photon>;
static_assert(sizeof(Photon) % sizeof(Part) == 0);

/// Puts the photons into the order of the keys, part by part: copied out in the new order, then back. A second copy of
/// them all would be the peak of memory; following cycles in place needs none and misses the cache at every step.
void permute(std::vector<Photon>& photons, const std::vector<SortKey>& keys) {
    const std::span<std::byte> bytes = std::as_writable_bytes(std::span(photons));
    const auto spare = std::make_unique_for_overwrite<Part[]>(photons.size());
    for (std::size_t offset = 0; offset < sizeof(Photon); offset += sizeof(Part)) {
        in_pieces(keys.size(), photons_in_piece, [&](const BlockRange& piece) {
            for (std::size_t i = piece.begin; i < piece.end; ++i)
                std::memcpy(&spare[i], &bytes[index_of(keys[i]) * sizeof(Photon) + offset], sizeof(Part));
        });
        in_pieces(keys.size(), photons_in_piece, [&](const BlockRange& piece) {
            for (std::size_t i = piece.begin; i < piece.end; ++i)
                std::memcpy(&bytes[i * sizeof(Photon) + offset], &spare[i], sizeof(Part));
        });
    }
}

void permute(std::vector<std::uint32_t>& notes, const std::vector<SortKey>& keys) {
    if (notes.empty()) return;
    std::vector<std::uint32_t> permuted(notes.size());
    for (std::size_t place = 0; place < keys.size(); ++place) permuted[place] = notes[index_of(keys[place])];
    notes = std::move(permuted);
}

}  // namespace

void sort_along_curve(std::vector<Photon>& photons, PhotonNotes& notes) {
    std::vector<SortKey> keys(photons.size());
    std::iota(keys.begin(), keys.end(), SortKey{0});
    sort_along_curve(photons, keys);
    permute(notes.path, keys);
    permute(notes.multiplicity, keys);
    permute(photons, keys);
}

}  // namespace photonlab
