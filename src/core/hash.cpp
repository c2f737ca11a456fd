#include "core/hash.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <fmt/format.h>

#include <cstdint>
#include <fstream>
#include <vector>

#include "core/error.h"
#include "core/files/files.h"

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
    require_ordinary_file(file);
    std::ifstream stream(file, std::ios::binary);
    RunningHash hash;
    std::vector<char> piece(std::size_t{1} << 20);
    while (stream.read(piece.data(), static_cast<std::streamsize>(piece.size())) || stream.gcount() > 0)
        hash.add(piece.data(), static_cast<std::size_t>(stream.gcount()));
    if (stream.bad() || !stream.is_open()) throw InputError(file.string(), "cannot be read to its end");
    return hash.text();
}

}  // namespace photonlab
