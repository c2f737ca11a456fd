// Checkpoints: the state of a run between two passes, in one file that is whole or not there.
//
//     "photonlab state\n", format, identity, state, checksum of all that (XXH3 of 128 bits, in hexadecimal)
//
// A checkpoint is read only by the run that wrote it: its identity is a hash of everything that decides what the run
// records, and of the program's version.

#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <iosfwd>
#include <string>

#include "core/files/state_archive.h"

namespace photonlab {

inline constexpr std::uint32_t checkpoint_format = 7;          ///< to be raised when a state's exchange() changes
inline constexpr double default_seconds_between_saves = 30.0;  ///< of all long work

/// Where a run keeps its state.
struct Checkpoint {
    std::filesystem::path file;  ///< empty: it keeps none
    std::string identity;
    std::string advice;  ///< what to do when it is refused, closing its message
};

/// Replaces the file at once. Throws InputError when it cannot be written.
void save(const Checkpoint& checkpoint, const StateExchange& state);

/// Reads the state back; false when there is no such file. Throws InputError when it is damaged, truncated, of another
/// run or of another program.
bool load(const Checkpoint& checkpoint, const StateExchange& state);

/// load() without reading the state itself.
bool is_usable(const Checkpoint& checkpoint);

/// Whose state is in the file. Throws InputError where it is no checkpoint, damaged or of another format.
std::string read_identity(const std::filesystem::path& file);

/// Throws InputError unless it is a checkpoint, whosever, as it was written.
void require_whole_checkpoint(const std::filesystem::path& file);

/// What load() does with the file's content; `place` is its name in messages.
void load_checkpoint(std::istream& stream, const std::string& place, const Checkpoint& checkpoint,
                     const StateExchange& state);

/// Renames the file, if it is there, to checkpoint.old.
void set_aside(const Checkpoint& checkpoint);

/// Removes the file of a run that is finished, and what killed processes left beside it.
void discard(const Checkpoint& checkpoint);

/// Says when it is time to save, so that no more work is lost than that of so many seconds, or of one pass.
class CheckpointClock {
public:
    explicit CheckpointClock(double seconds) : seconds_(seconds) {}

    /// Asked at the end of every pass: true when another one as long would go beyond the seconds.
    bool is_due_after_pass();
    void saved();

private:
    using Clock = std::chrono::steady_clock;
    const double seconds_;
    Clock::time_point saved_ = Clock::now();
    Clock::time_point pass_began_ = Clock::now();
};

}  // namespace photonlab
