#include "core/hash.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <fmt/format.h>

#include <cstdint>
#include <limits>

#include "core/files.h"

namespace photonlab {

namespace {

std::string in_hexadecimal(XXH128_hash_t hash) {
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

}  // namespace

std::string hash_text(std::string_view text) {
    return in_hexadecimal(XXH3_128bits(text.data(), text.size()));
}

struct RunningHash::State {
    XXH3_state_t hash;
};

RunningHash::RunningHash() : state_(std::make_unique<State>()) {
    XXH3_128bits_reset(&state_->hash);
}

RunningHash::~RunningHash() = default;
RunningHash::RunningHash(RunningHash&&) noexcept = default;
RunningHash& RunningHash::operator=(RunningHash&&) noexcept = default;

void RunningHash::add(const void* bytes, std::size_t count) {
    XXH3_128bits_update(&state_->hash, bytes, count);
}

std::string RunningHash::text() const {
    return in_hexadecimal(XXH3_128bits_digest(&state_->hash));
}

std::string hash_file(const std::filesystem::path& file) {
    return hash_text(read_text_file(file, std::numeric_limits<std::uintmax_t>::max()));
}

}  // namespace photonlab
