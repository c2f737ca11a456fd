// What is kept of a method's seeds so that bias and variance can be told apart later: not every image, but sums of
// images in a fixed number of slots. Up to that many seeds each has a slot of its own; further ones are added to the
// slots in turn. So disk and memory stay bounded however many seeds there are, seeds can be added later without the old
// ones, and slots are independent groups for a jackknife.
//
//     RESULTS/ensembles/POINT/ensemble.json    what the sums are of; analysis/decomposition.py reads it
//     RESULTS/ensembles/POINT/slot-00.exr      layers: "emission", and pass-000128-direct, pass-000128-gathered, ... of
//                                              every recorded pass; the attribute photonlab.seeds says whose sums
//
// A slot is one file, replaced at once: a seed is in all of its sums or in none.

#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "experiment/settings_io.h"
#include "image/image.h"

namespace photonlab {

inline constexpr std::size_t ensemble_slots = 16;

/// An image of a run after `pass` passes.
struct PassImage {
    std::uint64_t pass = 0;
    Image image;
};

/// The sums of one point of an experiment, in a folder of its own.
class Ensemble {
public:
    /// Sums of another key, which are of other settings, are removed at the first add(). `description` becomes
    /// ensemble.json, with schema, key and slots.
    Ensemble(std::filesystem::path folder, std::string key, Json description);

    /// True when the seed is in the sums.
    bool contains(std::uint64_t seed) const;

    /// Writes ensemble.json anew when there are sums, so that it holds what is not part of the key (regions).
    void describe() const;

    /// Adds the images of a seed to the slot with the fewest seeds; nothing when it is there. Throws InputError when
    /// the slot's file is damaged or of other passes.
    void add(std::uint64_t seed, const std::vector<PassImage>& images);

private:
    std::filesystem::path slot_file(std::size_t slot) const;

    std::filesystem::path folder_;
    std::string key_;
    Json description_;
    std::vector<std::vector<std::uint64_t>> seeds_;  // by slot
    bool is_described_ = false;                      // ensemble.json is there, with this key
};

}  // namespace photonlab
