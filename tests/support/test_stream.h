// Random numbers for tests of what is drawn with them.

#pragma once

#include "core/random.h"

namespace photonlab {

inline RandomStream test_stream(std::uint64_t index = 0, std::uint32_t seed = 7) {
    return RandomStream(seed, RandomPurpose::Test, 1, index);
}

}  // namespace photonlab
