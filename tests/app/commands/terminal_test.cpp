// What a person at a terminal sees: a bar that stays on one line however narrow the terminal is, and above it a line
// for every run that ends. The program runs on a pseudo terminal, and what it sends is put on a screen of that width.

#include <sys/ioctl.h>

#include <cstdlib>

#include "tests/app/program.h"

namespace photonlab {
namespace {

/// The lines that a terminal of so many columns shows, all that scrolled away among them.
class Screen {
public:
    explicit Screen(std::size_t columns) : columns_(columns) {}

    void put(const std::string& sent) {
        for (std::size_t i = 0; i < sent.size(); ++i) {
            if (sent.compare(i, 3, "\033[K") == 0) {
                lines_.back().resize(std::min(lines_.back().size(), column_));
                i += 2;
            } else if (sent[i] == '\r') {
                column_ = 0;
            } else if (sent[i] == '\n') {
                lines_.emplace_back();
                column_ = 0;
            } else {
                put_character(sent[i]);
            }
        }
    }

    void resize(std::size_t columns) { columns_ = columns; }
    const std::vector<std::string>& lines() const { return lines_; }
    std::size_t wrapped() const { return wrapped_; }        ///< lines that went on in the next
    std::size_t widest_bar() const { return widest_bar_; }  ///< columns of what was overwritten later

private:
    void put_character(char c) {
        if (column_ == columns_) {
            lines_.emplace_back();
            column_ = 0;
            ++wrapped_;
        }
        lines_.back().resize(std::max(lines_.back().size(), column_ + 1), ' ');
        lines_.back()[column_++] = c;
        widest_bar_ = std::max(widest_bar_, column_);
    }

    std::size_t columns_;
    std::size_t column_ = 0;
    std::size_t wrapped_ = 0;
    std::size_t widest_bar_ = 0;
    std::vector<std::string> lines_{""};
};

class OnTerminal : public ProgramTest {
protected:
    OnTerminal() {
        folder_.write("runs.toml",
                      "scenes = ['walls/scene.xml']\npasses = 400\nphotons_per_pass = 300\nthreads = 1\n"
                      "seeds = 3\n[[method]]\nintegrator = 'ppm'\nname = '" +
                          std::string(60, 'n') + "'\n");
        terminal_ = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
    }
    void SetUp() override {
        if (terminal_ < 0 || ::grantpt(terminal_) != 0 || ::unlockpt(terminal_) != 0)
            GTEST_SKIP() << "this system has no pseudo-terminals";
    }
    ~OnTerminal() override { ::close(terminal_); }

    void set_columns(std::size_t columns) const {
        const winsize size{24, static_cast<unsigned short>(columns), 0, 0};
        EXPECT_EQ(::ioctl(terminal_, TIOCSWINSZ, &size), 0);
    }

    /// Starts the program with its standard error on the terminal.
    void start(const std::vector<std::string>& arguments) {
        std::vector<std::string> words{PHOTONLAB_PROGRAM};
        words.insert(words.end(), arguments.begin(), arguments.end());
        std::vector<char*> pointers;
        for (std::string& word : words) pointers.push_back(word.data());
        pointers.push_back(nullptr);
        const int side = ::open(::ptsname(terminal_), O_RDWR | O_NOCTTY | O_CLOEXEC);
        ASSERT_GE(side, 0);
        process_ = ::fork();
        if (process_ == 0) {
            ::dup2(side, STDERR_FILENO);
            ::dup2(::open("/dev/null", O_WRONLY), STDOUT_FILENO);
            ::execv(PHOTONLAB_PROGRAM, pointers.data());
            ::_exit(127);
        }
        ::close(side);
    }

    /// What the program sends next; empty once it has ended.
    std::string read_some() const {
        char buffer[4096];
        const ssize_t count = ::read(terminal_, buffer, sizeof(buffer));
        return count > 0 ? std::string(buffer, static_cast<std::size_t>(count)) : "";
    }

    int wait() const {
        int status = 0;
        ::waitpid(process_, &status, 0);
        return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
    }

    /// The screen after the program has run to its end on so many columns.
    Screen shown_on(std::size_t columns, const std::vector<std::string>& arguments) {
        set_columns(columns);
        start(arguments);
        Screen screen(columns);
        for (std::string sent; !(sent = read_some()).empty();) screen.put(sent);
        EXPECT_EQ(wait(), 0);
        return screen;
    }

    static std::size_t count(const std::vector<std::string>& lines, const std::string& begin) {
        return static_cast<std::size_t>(std::count_if(
            lines.begin(), lines.end(), [&](const std::string& line) { return line.starts_with(begin); }));
    }

    int terminal_ = -1;
    pid_t process_ = -1;
};

TEST_F(OnTerminal, TheBarOfARenderStaysOnItsLineAndLeavesNothing) {
    for (const std::size_t columns : {1, 2, 20, 40, 80, 300}) {
        const Screen screen =
            shown_on(columns, {"render", (folder_ / "walls/scene.xml").string(), "-o", (folder_ / "image.exr").string(),
                               "--passes", "300", "--photons", "300", "--threads", "1"});
        EXPECT_EQ(screen.wrapped(), 0u) << columns;
        EXPECT_EQ(screen.lines(), std::vector<std::string>{""}) << columns;
        EXPECT_EQ(screen.widest_bar() > 0, columns > 1) << columns;
    }
}

TEST_F(OnTerminal, EveryRunThatEndsLeavesALineAboveTheBar) {
    for (const std::size_t columns : {20, 40, 80, 300}) {
        std::filesystem::remove_all(folder_ / "results");
        const Screen screen =
            shown_on(columns, {"run", (folder_ / "runs.toml").string(), "-o", (folder_ / "results").string()});
        EXPECT_EQ(count(screen.lines(), "finished walls_nnn"), 3u) << columns;
        EXPECT_EQ(screen.lines().back(), "") << columns;
        for (const std::string& line : screen.lines()) EXPECT_EQ(line.find('%'), std::string::npos) << line;
        // What stays are the line on memory and one a run, which may go on in the next: no bar is among them.
        EXPECT_EQ(count(screen.lines(), "memory: "), 1u) << columns;
        EXPECT_EQ(screen.lines().size(), 5 + screen.wrapped()) << columns;
    }
}

TEST_F(OnTerminal, ABarFollowsItsTerminalsSize) {
    set_columns(80);
    start({"render", (folder_ / "walls/scene.xml").string(), "-o", (folder_ / "image.exr").string(), "--passes",
           "1000000", "--photons", "300", "--threads", "1"});
    Screen wide(80);
    while (wide.widest_bar() == 0) wide.put(read_some());
    set_columns(40);
    std::string since;
    while (std::count(since.begin(), since.end(), '%') < 3) since += read_some();
    ::kill(process_, SIGTERM);
    EXPECT_EQ(wait(), 3);
    // The first may have been on its way already.
    Screen narrow(40);
    narrow.put(since.substr(since.find('\r', since.find('%'))));
    EXPECT_EQ(narrow.wrapped(), 0u);
    EXPECT_GT(narrow.widest_bar(), 0u);
}

}  // namespace
}  // namespace photonlab
