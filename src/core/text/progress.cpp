#include "core/text/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>

#include "core/text/messages.h"

namespace photonlab {

namespace {

constexpr std::string_view clear_line = "\r\033[K";
constexpr double seconds_between_lines = 60.0;  // of a log

/// Of the terminal as it is now: its user may have changed its size.
std::size_t terminal_columns() {
    winsize size{};
    const bool is_known = ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0;
    return is_known ? size.ws_col : 80;
}

}  // namespace

void Pace::count(std::uint64_t done, double now) {
    if (done <= done_) return;
    done_here_ += done - done_;
    seconds_here_ += now - counted_;
    done_ = done;
    counted_ = now;
}

void Pace::skip(std::uint64_t done, double now) {
    done_ = std::max(done_, done);
    counted_ = now;
}

double Pace::share() const {
    return total_ == 0 ? 1.0 : std::min(1.0, static_cast<double>(done_) / static_cast<double>(total_));
}

std::optional<double> Pace::seconds_left() const {
    if (done_here_ == 0) return std::nullopt;
    return seconds_here_ / static_cast<double>(done_here_) * static_cast<double>(total_ - std::min(done_, total_));
}

Progress::Progress(std::uint64_t total) : on_terminal_(::isatty(STDERR_FILENO) == 1), pace_(total) {}

Progress::~Progress() {
    clear();
}

double Progress::now() const {
    return std::chrono::duration<double>(Clock::now() - began_).count();
}

void Progress::show(std::uint64_t done, const std::string& what) {
    const double seconds_between = on_terminal_ ? 0.2 : seconds_between_lines;
    pace_.count(done, now());
    what_ = what;
    const bool is_first = on_terminal_ && !visible_;
    if (is_first || now() - drawn_ >= seconds_between) draw();
}

void Progress::skip(std::uint64_t done) {
    pace_.skip(done, now());
}

void Progress::draw() {
    const std::optional<double> seconds = pace_.seconds_left();
    const std::string left = seconds ? describe_duration(*seconds) + " left" : "time left not known yet";
    drawn_ = now();
    if (!on_terminal_) return print_message("{:3.0f}%  {}  {}\n", 100.0 * pace_.share(), left, what_);
    // In the last column of some terminals the cursor is on the next line already.
    write_message(std::string(clear_line) + progress_line(pace_.share(), left, what_, terminal_columns() - 1));
    visible_ = true;
}

void Progress::finished(const std::string& line) {
    const bool was_visible = visible_;
    clear();
    print_message("{}\n", line);
    if (was_visible) draw();
}

void Progress::clear() {
    if (!visible_) return;
    write_message(clear_line);
    visible_ = false;
}

std::string progress_line(double share, const std::string& left, const std::string& what, std::size_t columns) {
    constexpr int width = 24;
    constexpr std::size_t least_columns = 60;
    const int filled = static_cast<int>(share * width);
    const std::string bar =
        columns < least_columns ? "" : fmt::format("[{:#<{}}{:.<{}}] ", "", filled, "", width - filled);
    std::string line = printable(fmt::format("{}{:3.0f}%  {}  {}", bar, 100.0 * share, left, what));
    std::replace(line.begin(), line.end(), '\n', ' ');
    return std::string(first_columns(line, columns));
}

std::string describe_duration(double seconds) {
    if (seconds < 9.95) return fmt::format("{:.1f} s", seconds);
    const auto whole = static_cast<std::int64_t>(std::llround(std::min(seconds, 1e15)));
    if (whole < 60) return fmt::format("{} s", whole);
    if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
    return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
}

}  // namespace photonlab
