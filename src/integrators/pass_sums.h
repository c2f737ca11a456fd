// Sums over passes of what each gave to a point or a pixel: in double, or, where passes can be taken apart and joined,
// exactly, so that any split of them gives the bits of none (core/exact_sum.h).

#pragma once

#include <atomic>
#include <cstdint>
#include <vector>

#include "core/exact_sum.h"
#include "core/files/state_archive.h"

namespace photonlab {

/// What sums over passes, one a place, are short of where they are exact; nothing where they are not. The sums are
/// their owner's.
class SumRests {
public:
    explicit SumRests(std::size_t places) : rests_(places, ColorD(0.0)) {}

    bool are_kept() const { return !rests_.empty(); }

    /// Adds what a pass gave to the sum of a place, exactly; different places on different threads.
    void add(ColorD& sum, std::size_t place, const ColorD& value) {
        if (const unsigned inexact = add_exactly(sum, rests_[place], rounded_to_float_bits(value)))
            std::atomic_ref(inexact_).fetch_add(inexact, std::memory_order_relaxed);
    }

    std::uint64_t inexact_additions() const { return inexact_; }  ///< of channels
    std::uint64_t bytes() const { return rests_.size() * sizeof(ColorD); }

    /// Exchanges `values`, which have the sums, and these. Of states that are joined `join(here, read, add)` joins the
    /// values of a place, and their sums by `add(sum_here, sum_read)`.
    template <typename Value, typename Join>
    void exchange_with(std::vector<Value>& values, StateArchive& archive, const Join& join) {
        if (!archive.joins()) return exchange_all(values, archive);
        std::vector<Value> read_values(values.size());
        SumRests read(rests_.size());
        read.exchange_all(read_values, archive);
        inexact_ += read.inexact_;
        for (std::size_t i = 0; i < rests_.size(); ++i)
            join(values[i], read_values[i], [&](ColorD& sum_here, const ColorD& sum_read) {
                for (const ColorD& part : {sum_read, read.rests_[i]})
                    inexact_ += add_exactly(sum_here, rests_[i], part);
            });
    }

private:
    template <typename Value>
    void exchange_all(std::vector<Value>& values, StateArchive& archive) {
        archive.exchange_as_many(values);
        archive.exchange_as_many(rests_);
        archive.exchange(inexact_);
    }

    std::vector<ColorD> rests_;
    std::uint64_t inexact_ = 0;
};

class PassSums {
public:
    PassSums() = default;
    PassSums(std::size_t count, bool are_exact) : sums_(count, ColorD(0.0)), rests_(are_exact ? count : 0) {}

    /// Adds what a pass gave; different places on different threads.
    void add(std::size_t place, const ColorD& value) {
        if (rests_.are_kept())
            rests_.add(sums_[place], place, value);
        else
            sums_[place] += value;
    }

    /// Nearest to the sum.
    const ColorD& operator[](std::size_t place) const { return sums_[place]; }
    std::size_t size() const { return sums_.size(); }

    std::uint64_t inexact_additions() const { return rests_.inexact_additions(); }  ///< of channels
    std::uint64_t bytes() const { return sums_.size() * sizeof(ColorD) + rests_.bytes(); }

    void exchange(StateArchive& archive) {
        rests_.exchange_with(sums_, archive,
                             [](ColorD& here, const ColorD& read, const auto& add) { add(here, read); });
    }

private:
    std::vector<ColorD> sums_;
    SumRests rests_{0};
};

}  // namespace photonlab
