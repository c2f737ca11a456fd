// Sums over passes of what each gave to a point or a pixel: in double, or, where passes can be taken apart and joined,
// exactly, so that any split of them gives the bits of none (core/exact_sum.h).

#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "core/exact_sum.h"
#include "core/files/state_archive.h"

namespace photonlab {

class PassSums {
public:
    PassSums() = default;
    PassSums(std::size_t count, bool are_exact)
        : sums_(count, ColorD(0.0)), rests_(are_exact ? count : 0, ColorD(0.0)) {}

    /// Adds what a pass gave; different places on different threads.
    void add(std::size_t place, const ColorD& value) {
        if (rests_.empty()) {
            sums_[place] += value;
            return;
        }
        if (const unsigned inexact = add_exactly(sums_[place], rests_[place], rounded_to_float_bits(value)))
            std::atomic_ref(inexact_).fetch_add(inexact, std::memory_order_relaxed);
    }

    /// Nearest to the sum.
    const ColorD& operator[](std::size_t place) const { return sums_[place]; }
    std::size_t size() const { return sums_.size(); }

    std::uint64_t inexact_additions() const { return inexact_; }  ///< of channels
    std::uint64_t bytes() const { return (sums_.size() + rests_.size()) * sizeof(ColorD); }

    void exchange(StateArchive& archive) {
        if (!archive.joins()) return exchange_all(archive);
        PassSums read(sums_.size(), !rests_.empty());
        read.exchange_all(archive);
        inexact_ += read.inexact_;
        for (std::size_t i = 0; i < rests_.size(); ++i)
            for (const ColorD& part : {read.sums_[i], read.rests_[i]})
                inexact_ += add_exactly(sums_[i], rests_[i], part);
    }

private:
    void exchange_all(StateArchive& archive) {
        archive.exchange_as_many(sums_);
        archive.exchange_as_many(rests_);
        archive.exchange(inexact_);
    }

    std::vector<ColorD> sums_;
    std::vector<ColorD> rests_;  // what the sums are short of; none where they are not exact
    std::uint64_t inexact_ = 0;
};

}  // namespace photonlab
