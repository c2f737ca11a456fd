#include "render/checkpoint.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "core/error.h"
#include "core/files/files.h"
#include "core/files/temporary_file.h"

namespace photonlab {

namespace {

constexpr std::array<char, 16> signature{'p', 'h', 'o', 't', 'o', 'n', 'l', 'a',
                                         'b', ' ', 's', 't', 'a', 't', 'e', '\n'};
constexpr std::uint64_t checksum_length = 32;

InputError refusal(const std::string& place, const std::string& reason, const Checkpoint& checkpoint) {
    return InputError(place, reason + (checkpoint.advice.empty() ? "" : "; " + checkpoint.advice));
}

/// The bytes before the checksum; throws unless it is theirs.
std::uint64_t checked_size(std::istream& stream, const std::string& place, const Checkpoint& checkpoint) {
    RunningHash hash;
    std::array<char, 1 << 16> buffer;
    std::string start;
    std::string tail;  // what may be the checksum
    std::uint64_t size = 0;
    while (stream.read(buffer.data(), buffer.size()) || stream.gcount() > 0) {
        tail.append(buffer.data(), static_cast<std::size_t>(stream.gcount()));
        if (size == 0) start = tail.substr(0, signature.size());
        if (tail.size() <= checksum_length) continue;
        const std::size_t certain = tail.size() - checksum_length;
        hash.add(tail.data(), certain);
        size += certain;
        tail.erase(0, certain);
    }
    if (!std::equal(signature.begin(), signature.end(), start.begin(), start.end()))
        throw refusal(place, "is no checkpoint of photonlab", checkpoint);
    if (tail != hash.text())
        throw refusal(place, "is damaged or truncated: its checksum is not that of its content", checkpoint);
    return size;
}

/// What stands before the state.
std::string read_start(StateArchive& archive, const std::string& place, const Checkpoint& checkpoint) {
    std::uint32_t stored_format = 0;
    std::string identity;
    try {
        archive.exchange(stored_format);
        if (stored_format == checkpoint_format) archive.exchange(identity);
    } catch (const InputError& error) {
        throw refusal(place, std::string("is damaged: ") + error.what(), checkpoint);
    }
    if (stored_format != checkpoint_format)
        throw refusal(place,
                      "is of format " + std::to_string(stored_format) + ", and this program reads " +
                          std::to_string(checkpoint_format),
                      checkpoint);
    return identity;
}

/// Of the bytes between signature and checksum, which are looked at first.
StateArchive checked_archive(std::istream& stream, const std::string& place, const Checkpoint& checkpoint) {
    const std::uint64_t size = checked_size(stream, place, checkpoint);
    stream.clear();
    stream.seekg(signature.size());
    return StateArchive(stream, size - signature.size());
}

}  // namespace

void load_checkpoint(std::istream& stream, const std::string& place, const Checkpoint& checkpoint,
                     const StateExchange& state) {
    StateArchive archive = checked_archive(stream, place, checkpoint);
    if (read_start(archive, place, checkpoint) != checkpoint.identity)
        throw refusal(
            place, "is of another run: its settings, scene, reference, passes or the program's version were different",
            checkpoint);
    if (!state) return;
    try {
        state(archive);
        if (archive.bytes_left() > 0)
            throw InputError("has " + std::to_string(archive.bytes_left()) + " bytes more than its state");
    } catch (const InputError& error) {
        throw refusal(place, std::string("does not fit: ") + error.what(), checkpoint);
    }
}

bool load(const Checkpoint& checkpoint, const StateExchange& state) {
    if (checkpoint.file.empty()) return false;
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(checkpoint.file, error);
    if (status.type() == std::filesystem::file_type::not_found) return false;
    if (!std::filesystem::is_regular_file(status))  // a pipe would be waited for
        throw refusal(checkpoint.file.string(), "cannot be read as a checkpoint", checkpoint);
    std::ifstream stream(checkpoint.file, std::ios::binary);
    // The process that wrote it may have finished, and removed it, since.
    if (!stream && !std::filesystem::exists(checkpoint.file, error)) return false;
    if (!stream) throw refusal(checkpoint.file.string(), "cannot be read as a checkpoint", checkpoint);
    load_checkpoint(stream, checkpoint.file.string(), checkpoint, state);
    return true;
}

std::string read_identity(const std::filesystem::path& file) {
    require_ordinary_file(file);
    std::ifstream stream(file, std::ios::binary);
    const Checkpoint nobodys;
    StateArchive archive = checked_archive(stream, file.string(), nobodys);
    return read_start(archive, file.string(), nobodys);
}

bool is_usable(const Checkpoint& checkpoint) {
    return load(checkpoint, {});
}

void require_whole_checkpoint(const std::filesystem::path& file) {
    require_ordinary_file(file);
    std::ifstream stream(file, std::ios::binary);
    checked_size(stream, file.string(), {file, "", "remove it, or begin anew beside it with --fresh"});
}

void save(const Checkpoint& checkpoint, const StateExchange& state) {
    if (checkpoint.file.empty()) return;
    TemporaryFile temporary(checkpoint.file);
    std::ofstream stream(temporary.path(), std::ios::binary | std::ios::trunc);
    StateArchive archive(stream);
    auto start = signature;
    std::uint32_t stored_format = checkpoint_format;
    std::string identity = checkpoint.identity;
    archive.exchange(start);
    archive.exchange(stored_format);
    archive.exchange(identity);
    state(archive);
    stream << archive.hash();
    stream.close();
    if (!stream) throw InputError(checkpoint.file.string(), std::string("cannot be written: ") + std::strerror(errno));
    temporary.rename();
}

void set_aside(const Checkpoint& checkpoint) {
    if (checkpoint.file.empty()) return;
    std::error_code error;
    std::filesystem::rename(checkpoint.file, checkpoint.file.string() + ".old", error);
    if (error && error != std::errc::no_such_file_or_directory)
        throw InputError(checkpoint.file.string(), "cannot be renamed: " + error.message());
}

void discard(const Checkpoint& checkpoint) {
    if (checkpoint.file.empty()) return;
    remove_if_there(checkpoint.file);
    remove_leftovers(checkpoint.file.parent_path());
}

bool CheckpointClock::is_due_after_pass() {
    const Clock::time_point now = Clock::now();
    const auto seconds_since = [&](Clock::time_point then) {
        return std::chrono::duration<double>(now - then).count();
    };
    const bool is_due = seconds_since(saved_) + seconds_since(pass_began_) >= seconds_;
    pass_began_ = now;
    return is_due;
}

void CheckpointClock::saved() {
    saved_ = pass_began_ = Clock::now();
}

}  // namespace photonlab
