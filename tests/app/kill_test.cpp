// SIGKILL at random moments, 50 times in all, and the bits of a program that was left alone.

#include <random>

#include "tests/app/program.h"
#include "tests/app/shared_folder.h"
#include "tests/support/results.h"

namespace photonlab {
namespace {

class KilledProgram : public ProgramTest {
protected:
    /// Starts the program again and again, killing it at a random moment of the next `seconds`, until it ends by
    /// itself; returns how often it was killed. `seconds` grow with every kill and shrink with every end, so that there
    /// are some of both however fast the machine is just then.
    int kill_until_done(const std::vector<std::string>& command, double& seconds) {
        std::uniform_real_distribution<double> share(0.0, 1.0);
        for (int kills = 0;; ++kills) {
            Program program(command, folder_ / "messages");
            std::this_thread::sleep_for(std::chrono::duration<double>(seconds * share(random_)));
            if (program.is_running()) program.send(SIGKILL);
            const int code = program.wait();
            if (code == -SIGKILL) {
                seconds *= 1.2;
                continue;
            }
            EXPECT_EQ(code, 0) << program.messages();
            seconds *= 0.6;
            return kills;
        }
    }

    double seconds_of(const std::vector<std::string>& command) {
        const auto began = std::chrono::steady_clock::now();
        std::string said;
        EXPECT_EQ(run_program(command, said), 0) << said;
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    }

    std::mt19937 random_{20080};
};

TEST_F(KilledProgram, RunLosesNothing) {
    double seconds = seconds_of(run_into("whole"));
    for (int kills = 0; kills < 34;) {
        std::filesystem::remove_all(folder_ / "killed");
        kills += kill_until_done(run_into("killed"), seconds);
        EXPECT_EQ(difference_of_results(folder_ / "whole", folder_ / "killed"), "");
        EXPECT_EQ(difference_of_results(folder_ / "killed", folder_ / "whole"), "");
    }
}

TEST_F(KilledProgram, RenderLosesNothing) {
    double seconds = seconds_of(render_into("whole", 200));
    for (int kills = 0; kills < 12;) {
        for (const char* file : {"killed.exr", "killed.csv", "killed-pass-7.exr"})
            std::filesystem::remove(folder_ / file);
        kills += kill_until_done(render_into("killed", 200), seconds);
        EXPECT_EQ(difference_of_images(folder_ / "whole.exr", folder_ / "killed.exr"), "");
        EXPECT_EQ(difference_of_images(folder_ / "whole-pass-7.exr", folder_ / "killed-pass-7.exr"), "");
        EXPECT_EQ(repeatable_rows(folder_ / "whole.csv"), repeatable_rows(folder_ / "killed.csv"));
        EXPECT_FALSE(std::filesystem::exists(folder_ / "killed.checkpoint"));
    }
}

// Four processes with process ids of their own, as in containers, and a reader that sees whole tables alone.
TEST_F(SharedFolder, LosesNothingOfManyRuns) {
    if (!has_own_process_ids()) GTEST_SKIP() << "unshare -pf --mount-proc is not allowed here";
    constexpr int runs = 2000;
    write_tiny_runs(runs);
    WatchedTable table(folder_ / "shared/iterations.csv");
    EXPECT_GT(make_them_together(4, 700.0, 2011), 20);
    table.stop();
    EXPECT_EQ(table.fault(), "");
    EXPECT_GT(table.reads(), 0u);
    EXPECT_EQ(leftovers(), "");
    expect_all_made(runs);
}

// Samples are added to what a killed one left, and the halves are those of as many samples made at once, but for the
// rounding of float images that are joined.
TEST_F(KilledProgram, ReferenceStaysOne) {
    const auto command = [&](const std::string& folder, std::uint64_t samples) {
        return std::vector<std::string>{"reference", (folder_ / "walls/scene.xml").string(),
                                        "-o",        (folder_ / folder).string(),
                                        "--threads", "1",
                                        "--samples", std::to_string(samples)};
    };
    double seconds = seconds_of(command("timed", 2000));
    int kills = 0;
    while (kills < 4) kills += kill_until_done(command("killed", 2000), seconds);
    const Json json = read_reference_json(folder_ / "killed");
    const auto samples = json.at("samples_per_half").get<std::uint64_t>();
    EXPECT_GE(samples, 2000u);
    seconds_of(command("whole", samples));
    const Json whole = read_reference_json(folder_ / "whole");
    for (const char* half : {"half_a", "half_b"}) {
        const Image a = read_reference_half(folder_ / "killed", json, half);
        const Image b = read_reference_half(folder_ / "whole", whole, half);
        for (std::size_t layer = 0; layer < a.layers.size(); ++layer)
            for (std::size_t i = 0; i < a.layers[layer].pixels.size(); ++i)
                for (int channel = 0; channel < 3; ++channel)
                    EXPECT_NEAR(a.layers[layer].pixels[i][channel], b.layers[layer].pixels[i][channel],
                                1e-5f * (1.0f + b.layers[layer].pixels[i][channel]));
    }
}

}  // namespace
}  // namespace photonlab
