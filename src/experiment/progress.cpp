#include "experiment/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace photonlab {

Progress::Progress(std::uint64_t total)
    : on_terminal_(::isatty(STDERR_FILENO) == 1),
      total_(std::max<std::uint64_t>(1, total)),
      began_(std::chrono::steady_clock::now()) {}

Progress::~Progress() {
    clear();
}

void Progress::show(std::uint64_t done, const std::string& what) {
    const auto now = std::chrono::steady_clock::now();
    if (!on_terminal_ || (visible_ && now - shown_ < std::chrono::milliseconds(100))) return;
    shown_ = now;
    visible_ = true;
    const double share = std::min(1.0, static_cast<double>(done) / static_cast<double>(total_));
    const double elapsed = std::chrono::duration<double>(now - began_).count();
    const std::string left =
        done > 0 ? describe_duration(elapsed * (1.0 - share) / share) + " left" : "time left not known yet";
    constexpr int width = 24;
    const int filled = static_cast<int>(share * width);
    fmt::print(stderr, "\r\033[K[{:#<{}}{:.<{}}] {:3.0f}%  {}  {}", "", filled, "", width - filled, 100.0 * share, left,
               what);
    std::fflush(stderr);
}

void Progress::finished(const std::string& line) const {
    if (!on_terminal_) fmt::print(stderr, "{}\n", line);
}

void Progress::clear() {
    if (!visible_) return;
    fmt::print(stderr, "\r\033[K");
    std::fflush(stderr);
    visible_ = false;
}

std::string describe_duration(double seconds) {
    if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
    const auto whole = static_cast<std::int64_t>(std::llround(std::min(seconds, 1e15)));
    if (whole < 60) return fmt::format("{} s", whole);
    if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
    return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

}  // namespace photonlab
