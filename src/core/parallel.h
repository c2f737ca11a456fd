// A loop over independent items on a given number of threads. Results never depend on which thread ran an item:
// every item writes to its own place, and whatever is summed over items is summed afterwards, in their order.

#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <exception>

namespace photonlab {

/// Calls `body(i)` for i in [0, count), items handed out one at a time to `threads` threads (>= 1).
/// The first exception of a body is thrown again here, after the loop.
template <typename Body>
void parallel_for(std::size_t count, int threads, const Body& body) {
    std::exception_ptr failure;
#pragma omp parallel for schedule(dynamic, 1) num_threads(threads)
    for (std::int64_t i = 0; i < static_cast<std::int64_t>(count); ++i) {
        try {
            body(static_cast<std::size_t>(i));
        } catch (...) {
#pragma omp critical(photonlab_parallel_for)
            if (!failure) failure = std::current_exception();
        }
    }
    if (failure) std::rethrow_exception(failure);
}

/// Items [begin, end) of block `block` when `count` items are cut into blocks of `size`.
struct BlockRange {
    std::size_t begin;
    std::size_t end;
};

inline std::size_t block_count(std::size_t count, std::size_t size) {
    return (count + size - 1) / size;
}

inline BlockRange block_range(std::size_t block, std::size_t count, std::size_t size) {
    const std::size_t begin = block * size;
    return {begin, begin + size < count ? begin + size : count};
}

}  // namespace photonlab
