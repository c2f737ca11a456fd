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
    ReferenceCheck = 11,
    CameraPositions = 12,
    ReferencePositionsA = 13,
    ReferencePositionsB = 14,
    SeenArea = 15,
    VisiblePaths = 16,
    LightSequence = 17,
};

class RandomStream {
public:
    /// `pass` below 2^32, `index` (of the path or hit point) below 2^56.
    RandomStream(std::uint64_t seed, RandomPurpose purpose, std::uint64_t pass, std::uint64_t index)
        : key_(key_of(seed)), counter_(counter_of(purpose, pass, index)) {}

    std::uint32_t next_bits() {
        if (used_ == capacity) refill();
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
    friend class RandomStreams;
    using Philox = r123::Philox4x32;
    static constexpr std::uint32_t blocks = 4;  // of four numbers each, that a stream has room for
    static constexpr std::size_t capacity = 4 * blocks;

    static Philox::key_type key_of(std::uint64_t seed) {
        return {{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}};
    }

    static Philox::ctr_type counter_of(RandomPurpose purpose, std::uint64_t pass, std::uint64_t index) {
        return {{0, static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(pass),
                 static_cast<std::uint32_t>(index >> 32) | static_cast<std::uint32_t>(purpose) << 24}};
    }

    void refill();

    Philox::key_type key_;
    Philox::ctr_type counter_;
    std::array<std::uint32_t, capacity> numbers_;
    std::size_t used_ = capacity;
};

/// The streams of all indices, for loops over neighbours: the first numbers of 64 streams are made together, in a plain
/// loop that a compiler turns into vectors, which takes a fifth of the time.
class RandomStreams {
public:
    RandomStreams(std::uint64_t seed, RandomPurpose purpose, std::uint64_t pass)
        : seed_(seed), purpose_(purpose), pass_(pass) {}

    /// Equal to RandomStream(seed, purpose, pass, index).
    RandomStream operator[](std::uint64_t index) {
        const std::uint64_t first = index - index % together;
        if (first != first_) make(first);
        RandomStream stream(seed_, purpose_, pass_, index);
        for (std::size_t block = 0; block < RandomStream::blocks; ++block)
            for (std::size_t word = 0; word < 4; ++word)
                stream.numbers_[4 * block + word] = numbers_[block][4 * (index - first) + word];
        stream.counter_[0] = RandomStream::blocks;
        stream.used_ = 0;
        return stream;
    }

private:
    static constexpr std::uint64_t together = 64;

    void make(std::uint64_t first);

    std::uint64_t seed_;
    RandomPurpose purpose_;
    std::uint64_t pass_;
    std::uint64_t first_ = ~std::uint64_t{0};  // no index: indices are below 2^56
    std::array<std::array<std::uint32_t, 4 * together>, RandomStream::blocks> numbers_;
};

}  // namespace photonlab
