// Processes that know nothing of each other, as in containers or on several machines, on one results folder: each has
// the process id 1, is killed at random moments, and begins again until all is made.

#pragma once

#include <fmt/format.h>

#include <atomic>
#include <fstream>
#include <memory>
#include <random>
#include <set>

#include "core/files/file_lock.h"
#include "record/recorder.h"
#include "tests/app/program.h"
#include "tests/support/results.h"

namespace photonlab {

/// Reads a table that others replace, again and again, as a script would that draws while runs are made.
class WatchedTable {
public:
    explicit WatchedTable(std::filesystem::path file) : file_(std::move(file)), thread_([this] { watch(); }) {}
    ~WatchedTable() { stop(); }

    void stop() {
        is_over_ = true;
        if (thread_.joinable()) thread_.join();
    }

    std::uint64_t reads() const { return reads_; }
    std::size_t lines() const { return lines_; }
    const std::string& fault() const { return fault_; }

private:
    void watch() {
        const std::string header = csv_header() + "\n";
        const auto commas = [](std::string_view line) { return std::count(line.begin(), line.end(), ','); };
        const auto expected = commas(header);
        while (!is_over_ && fault_.empty()) {
            std::ifstream stream(file_, std::ios::binary);
            if (!stream) continue;  // not merged yet
            const std::string text((std::istreambuf_iterator<char>(stream)), {});
            ++reads_;
            if (!text.starts_with(header) || text.back() != '\n') fault_ = "is empty or torn: \"" + text + "\"";
            std::size_t lines = 0;
            for (std::size_t at = 0; at < text.size(); ++lines) {
                const std::size_t end = text.find('\n', at);
                if (commas(std::string_view(text).substr(at, end - at)) != expected) fault_ = "has a torn line";
                at = end + 1;
            }
            if (lines < lines_) fault_ = "has fewer rows than it had";
            lines_ = lines;
        }
    }

    std::filesystem::path file_;
    std::uint64_t reads_ = 0;
    std::size_t lines_ = 0;
    std::string fault_;
    std::atomic<bool> is_over_ = false;
    std::thread thread_;
};

class SharedFolder : public ProgramTest {
protected:
    /// An experiment with so many runs, each of a few milliseconds.
    void write_tiny_runs(int runs) {
        std::string scene = two_walls_scene;
        folder_.write("dot/scene.xml", scene.replace(scene.find("value=\"12\""), 10, "value=\"16\"")
                                           .replace(scene.find("value=\"8\"/></film"), 9, "value=\"16\""));
        folder_.write("many.toml",
                      fmt::format("passes = 2\nseeds = {}\nthreads = 1\nphotons_per_pass = 20\n"
                                  "decomposition = true\n"
                                  "scenes = [{{ path = \"dot/scene.xml\", probes = {{ middle = [8, 8] }} }}]\n"
                                  "[[method]]\nintegrator = \"ppm\"\n[[method]]\nintegrator = \"path\"\n",
                                  runs / 2));
    }

    /// Lets `count` processes make them, killing one every `milliseconds` on average; returns how often one was killed.
    int make_them_together(int count, double milliseconds, std::uint32_t seed) {
        const std::vector<std::string> command{
            "run", (folder_ / "many.toml").string(), "-o", (folder_ / "shared").string(), "--checkpoint-seconds", "0"};
        std::mt19937 random(seed);
        std::vector<std::unique_ptr<Program>> programs(static_cast<std::size_t>(count));
        int kills = 0;
        std::size_t done = 0;
        const auto start = [&](std::size_t i) {
            programs[i] = std::make_unique<Program>(command, folder_ / fmt::format("messages {}", i),
                                                    Limits{.own_process_ids = true});
        };
        for (std::size_t i = 0; i < programs.size(); ++i) start(i);
        while (done < programs.size()) {
            std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(
                std::exponential_distribution<double>(1.0 / milliseconds)(random)));
            const std::size_t victim = random() % programs.size();
            if (programs[victim] && programs[victim]->is_running()) programs[victim]->send(SIGKILL);
            for (std::size_t i = 0; i < programs.size(); ++i) {
                if (!programs[i] || programs[i]->is_running()) continue;
                const int code = programs[i]->wait();
                if (code == -SIGKILL) {
                    ++kills;
                    start(i);
                    continue;
                }
                EXPECT_EQ(code, 0) << programs[i]->messages();
                programs[i].reset();
                ++done;
            }
        }
        return kills;
    }

    /// Names of what is there only while somebody is at work.
    std::string leftovers() const {
        std::string names;
        for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "shared")) {
            const std::string name = entry.path().filename().string();
            if (name.find("partial") != std::string::npos || name.ends_with("lock") || name == "checkpoint")
                names += entry.path().string() + "\n";
        }
        return names;
    }

    /// Every run is there once, with all its rows, and its seed is in the sums.
    void expect_all_made(int runs) {
        std::map<std::string, int> rows;
        for (const Row& row : read_rows(folder_ / "shared/iterations.csv")) ++rows[row.at("run")];
        EXPECT_EQ(rows.size(), static_cast<std::size_t>(runs));
        for (const auto& [run, count] : rows) EXPECT_EQ(count, 3 * 4) << run;
        for (const char* point : {"dot_ppm", "dot_path"}) {
            std::multiset<std::uint64_t> seeds;
            for (int slot = 0; slot < 16; ++slot) {
                std::istringstream stream(read_exr_metadata(
                    folder_ / fmt::format("shared/ensembles/{}/slot-{:02}.exr", point, slot))["photonlab.seeds"]);
                for (std::uint64_t seed = 0; stream >> seed;) seeds.insert(seed);
            }
            EXPECT_EQ(seeds.size(), static_cast<std::size_t>(runs / 2));
            EXPECT_EQ(std::set<std::uint64_t>(seeds.begin(), seeds.end()).size(), seeds.size());
        }
    }
};

}  // namespace photonlab
