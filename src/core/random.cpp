#include "core/random.h"

namespace photonlab {

// Two blocks at a time: a round waits for the one before it, and the other block's fits in between.
void RandomStream::refill() {
    constexpr std::size_t half = capacity / 2;
    auto next_counter = counter_;
    ++next_counter[0];
    const auto first = Philox()(counter_, key_);
    const auto second = Philox()(next_counter, key_);
    for (std::size_t i = 0; i < 4; ++i) {
        numbers_[half + i] = first[i];
        numbers_[half + 4 + i] = second[i];
    }
    counter_[0] += 2;
    used_ = half;
}

void RandomStreams::make(std::uint64_t first) {
    const auto key = RandomStream::key_of(seed_);
    for (std::uint32_t block = 0; block < RandomStream::blocks; ++block)
        for (std::uint64_t i = 0; i < together; ++i) {
            auto counter = RandomStream::counter_of(purpose_, pass_, first + i);
            counter[0] = block;
            const auto made = RandomStream::Philox()(counter, key);
            for (std::size_t word = 0; word < 4; ++word) numbers_[block][4 * i + word] = made[word];
        }
    first_ = first;
}

}  // namespace photonlab
