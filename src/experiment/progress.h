// Progress of long work on a terminal: a bar with the time left. Not on a terminal it prints nothing of its own;
// callers then print a plain line for each thing they finish.

#pragma once

#include <chrono>
#include <cstdint>
#include <string>

namespace photonlab {

class Progress {
public:
    /// `total` units of work, whatever they are.
    explicit Progress(std::uint64_t total);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// `done` units are finished; `what` names what is being done.
    void show(std::uint64_t done, const std::string& what);

    /// Something is finished: a plain line, unless the bar says enough.
    void finished(const std::string& line) const;

    /// Removes the bar.
    void clear();

private:
    const bool on_terminal_;
    const std::uint64_t total_;
    const std::chrono::steady_clock::time_point began_;
    std::chrono::steady_clock::time_point shown_{};
    bool visible_ = false;
};

/// As a person would say it: "42 s", "7 min 05 s", "3 h 20 min".
std::string describe_duration(double seconds);

}  // namespace photonlab
