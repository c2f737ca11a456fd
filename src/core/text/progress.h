// Progress of long work on a terminal: a line with a bar and the time left, never wider than the terminal is just then.
// Not on a terminal, in the log of a job, it is a plain line a minute at most, beside what is finished.

#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

namespace photonlab {

/// How fast work goes, of the units that were finished in this session alone.
class Pace {
public:
    /// At time 0, in seconds, nothing was done.
    explicit Pace(std::uint64_t total) : total_(total) {}

    /// At this time `done` units are finished.
    void count(std::uint64_t done, double now);

    /// The same, where the last of them were not finished by this session, nor was it at work since the one before.
    void skip(std::uint64_t done, double now);

    double share() const;                        ///< of the work that is done, 0 to 1
    std::optional<double> seconds_left() const;  ///< empty until the first unit is finished

private:
    std::uint64_t total_;
    std::uint64_t done_ = 0;
    std::uint64_t done_here_ = 0;
    double seconds_here_ = 0.0;  // that those took
    double counted_ = 0.0;       // up to here, time is in those seconds or is not to be
};

class Progress {
public:
    /// `total` units of work, whatever they are.
    explicit Progress(std::uint64_t total);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// `done` units are finished; `what` names what is being done.
    void show(std::uint64_t done, const std::string& what);

    /// `done` units are finished, the last of them not by this session.
    void skip(std::uint64_t done);

    /// Prints a plain line, above the bar where there is one.
    void finished(const std::string& line);

    /// Removes the bar.
    void clear();

private:
    using Clock = std::chrono::steady_clock;

    double now() const;  // seconds since it was made
    void draw();

    const bool on_terminal_;
    const Clock::time_point began_ = Clock::now();
    Pace pace_;
    std::string what_;
    double drawn_ = 0.0;
    bool visible_ = false;
};

/// `[####....]  33%  12 s left  pass 20 of 60` in at most so many columns; of less than 60 the bar takes none. `share`
/// is from 0 to 1.
std::string progress_line(double share, const std::string& left, const std::string& what, std::size_t columns);

/// As a person would say it: "42 s", "7 min 05 s", "3 h 20 min".
std::string describe_duration(double seconds);

}  // namespace photonlab
