// What is kept of a method's seeds so that bias and variance can be told apart later: not every image, but sums of
// images in a fixed number of slots. The first seeds of the experiment have a slot each, further ones are added to the
// slots in turn, whoever is made first. So disk and memory stay bounded however many seeds there are, seeds can be
// added later without the old ones, and slots are independent groups for a jackknife.
//
// The order in which images are added changes no bit: a sum of several is kept as the nearest float and what that
// leaves, a second float. Both hold 48 bits, in which sums of floats are exact unless one of them is millions of times
// another. An addition that was not exact is counted.
//
//     RESULTS/ensembles/POINT/ensemble.json    what the sums are of, with its checksum (kept_files.h);
//                                              `analysis decomposition` reads it
//     RESULTS/ensembles/POINT/slot-00.exr      layers: "emission", and pass-000128-direct, pass-000128-gathered, ... of
//                                              every recorded pass; with several seeds emission-rest, ... of each,
//                                              which belongs to the sum
//
// A slot is one file, replaced at once: a seed is in all of its sums or in none. What a slot holds it says itself, so
// that there is nothing to be out of step with it when a process is killed. Its attributes:
//
//     photonlab.key         that of ensemble.json; the sums of another key are of other settings
//     photonlab.seeds       "3 19 35": whose images were added
//     photonlab.inexact     of how many additions to a colour channel something was lost; then the order of seeds
//     counts photonlab.bytes       how long the file is, 20 digits photonlab.checksum    32 hexadecimal digits: the
//     hash (core/hash.h) of the whole file with these digits as zeros.
//                           They stand behind "photonlab.checksum\0string\0" and four bytes, once in the file.
//
// A slot that is missing or damaged is as empty: its seeds are made again.

#pragma once

#include <cstdint>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "core/files/json.h"
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
    /// Reads which seeds are in the sums. Those of another key, which are of other settings, are removed at the first
    /// add(). `description` becomes ensemble.json, with schema, key and slots.
    Ensemble(std::filesystem::path folder, std::string key, Json description);

    /// True when the seed is in the sums.
    bool contains(std::uint64_t seed) const { return seeds_.contains(seed); }

    /// What is wrong with slots of this key, one line each that begins with the file's name.
    const std::vector<std::string>& faults() const { return faults_; }

    /// Reads all of every slot; those whose checksum is wrong are then as empty, and in faults().
    void check_slots();

    /// Writes ensemble.json anew when there are sums and it says something else: what is not part of the key (regions).
    void describe() const;

    /// Adds the images of a seed, number `place` of the experiment's from 0 on; nothing when it is there. Throws
    /// InputError when its slot's file is damaged.
    void add(std::uint64_t seed, std::size_t place, const std::vector<PassImage>& images);

private:
    std::filesystem::path slot_file(std::size_t slot) const;
    void set_slot(std::size_t slot, std::vector<std::uint64_t> seeds);

    std::filesystem::path folder_;
    std::string key_;
    Json description_;
    std::vector<std::vector<std::uint64_t>> slots_;  // seeds
    std::set<std::uint64_t> seeds_;                  // of all slots
    bool is_of_others_ = false;                      // the folder holds sums of another key
    std::vector<std::string> faults_;
};

/// Whose images a slot holds.
struct SlotContent {
    std::string key;
    std::vector<std::uint64_t> seeds;
    std::uint64_t inexact = 0;  ///< additions
};

/// Throws InputError when the file is no slot, or not as long as it says.
SlotContent read_slot_content(const std::filesystem::path& file);

}  // namespace photonlab
