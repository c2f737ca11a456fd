// Counter-based random streams: a number is a function of (seed, purpose, pass, index, how many were drawn), never
// of a thread or of what ran before. So one thread and many give the same bits, any pass can be made again alone,
// and two purposes never share a number.
//
// [Salmon et al. 2011, "Parallel random numbers: as easy as 1, 2, 3": Philox4x32-10]

#pragma once

#include <Imath/ImathVec.h>
#include <Random123/philox.h>

#include <array>
#include <cstdint>

namespace photonlab {

/// What the numbers are used for. A reference's halves are purposes of their own, so that they share no stream
/// with anything that they judge.
enum class RandomPurpose : std::uint8_t {
    PhotonPaths = 1,
    DirectLight = 2,
    CameraPaths = 3,
    ReferenceHalfA = 4,
    ReferenceHalfB = 5,
    Test = 6,
    ReferencePhotonsA = 7,
    ReferencePhotonsB = 8,
    ReferenceDirectA = 9,
    ReferenceDirectB = 10,
};

class RandomStream {
public:
    /// `pass` below 2^32, `index` (of the path or hit point) below 2^56.
    RandomStream(std::uint64_t seed, RandomPurpose purpose, std::uint64_t pass, std::uint64_t index)
        : key_{{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}},
          counter_{{0, static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(pass),
                    static_cast<std::uint32_t>(index >> 32) | static_cast<std::uint32_t>(purpose) << 24}} {}

    std::uint32_t next_bits() {
        if (used_ == numbers_.size()) refill();
        return numbers_[used_++];
    }

    /// Uniform in [0, 1), a multiple of 2^-24.
    float next() { return static_cast<float>(next_bits() >> 8) * 0x1p-24f; }

    /// Uniform in [0, 1) with 53 bits, for choices whose probabilities may be far below 2^-24.
    double next_double() {
        const std::uint64_t high = next_bits();
        const std::uint64_t low = next_bits();
        return static_cast<double>((high << 21) ^ (low >> 11)) * 0x1p-53;
    }

    Imath::V2f next_2d() {
        const float x = next();
        return {x, next()};
    }

private:
    /// Two blocks at a time: a round waits for the one before it, and the other block's fits in between.
    void refill() {
        auto next_counter = counter_;
        ++next_counter[0];
        const auto first = r123::Philox4x32()(counter_, key_);
        const auto second = r123::Philox4x32()(next_counter, key_);
        for (std::size_t i = 0; i < 4; ++i) {
            numbers_[i] = first[i];
            numbers_[i + 4] = second[i];
        }
        counter_[0] += 2;
        used_ = 0;
    }

    r123::Philox4x32::key_type key_;
    r123::Philox4x32::ctr_type counter_;
    std::array<std::uint32_t, 8> numbers_;
    std::size_t used_ = 8;
};

}  // namespace photonlab
