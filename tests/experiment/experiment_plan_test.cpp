// What planning costs, in work that can be counted: comparisons, estimates, files that are opened. Time is nobody's
// business here.

#include "experiment/experiment_plan.h"

#include <gtest/gtest.h>
#include <sys/inotify.h>
#include <unistd.h>

#include <array>
#include <map>

#include "experiment/experiment_runs.h"
#include "experiment/run_list.h"
#include "tests/support/two_walls.h"

namespace photonlab {
namespace {

/// Counts what happens to files in folders, from its making on.
class FileEvents {
public:
    explicit FileEvents(const std::filesystem::path& folder) : descriptor_(::inotify_init1(IN_NONBLOCK)) {
        watch(folder);
        for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
            if (entry.is_directory()) watch(entry.path());
        counts();  // those folders were opened just now
    }
    ~FileEvents() { ::close(descriptor_); }
    FileEvents(const FileEvents&) = delete;
    FileEvents& operator=(const FileEvents&) = delete;

    /// By name of the file and what happened, since they were asked for last. Locks, and temporary files that are
    /// removed again, are left out.
    std::map<std::string, int> counts() {
        std::map<std::string, int> found;
        alignas(inotify_event) std::array<char, 1 << 16> buffer;
        for (ssize_t size = 0; (size = ::read(descriptor_, buffer.data(), buffer.size())) > 0;)
            for (ssize_t at = 0; at < size;) {
                const auto* event = reinterpret_cast<const inotify_event*>(buffer.data() + at);
                at += static_cast<ssize_t>(sizeof(inotify_event) + event->len);
                const std::string name = event->len > 0 ? event->name : "";
                if (name.empty() || (event->mask & IN_ISDIR) || name.ends_with("lock") ||
                    name.find(".partial-") != std::string::npos)
                    continue;
                ++found[name + (event->mask & IN_OPEN ? " opened" : " written")];
            }
        return found;
    }

private:
    void watch(const std::filesystem::path& folder) {
        EXPECT_GE(
            ::inotify_add_watch(descriptor_, folder.c_str(), IN_OPEN | IN_CREATE | IN_MODIFY | IN_MOVED_TO | IN_DELETE),
            0);
    }

    int descriptor_;
};

class ExperimentPlan : public ::testing::Test {
protected:
    Experiment experiment(const std::string& seeds, const std::string& more = "") {
        folder_.write("walls/scene.xml", two_walls_scene);
        folder_.write("plan.toml", "passes = 2\nthreads = 1\nphotons_per_pass = 100\nseeds = " + seeds + "\n" + more +
                                       "scenes = [\"walls/scene.xml\"]\n"
                                       "[[method]]\nintegrator = \"ppm\"\nalpha = [0.5, 0.7]\n"
                                       "[[method]]\nintegrator = \"photonmapper\"\n"
                                       "[[method]]\nintegrator = \"path\"\n");
        return read_experiment(folder_ / "plan.toml");
    }
    std::filesystem::path results() { return folder_ / "results"; }

    TestFolder folder_;
};

TEST_F(ExperimentPlan, RunsAreComparedWithThoseOfTheirSeedAlone) {
    const Experiment many = experiment("2000");
    const PreparedExperiment prepared = prepare_experiment(many, results());
    std::size_t comparisons = 0;
    const std::vector<RunsTogether> groups =
        runs_together(prepared.runs, [&](const RunSettings& a, const RunSettings& b) {
            ++comparisons;
            return can_run_together(a, b);
        });
    EXPECT_EQ(prepared.runs.size(), 8000u);
    EXPECT_EQ(groups.size(), 4000u);  // of a seed: what takes photons, and the paths
    EXPECT_LE(comparisons, 4 * prepared.runs.size());
}

// Each has a lock while its group is made.
TEST_F(ExperimentPlan, GroupsAreNoLargerThanThereCanBeOpenFiles) {
    const Experiment one = experiment("1");
    const std::vector<PreparedRun> runs(600, prepare_experiment(one, results()).runs.at(0));
    std::vector<std::size_t> sizes;
    for (const RunsTogether& group : runs_together(runs)) sizes.push_back(group.size());
    EXPECT_EQ(sizes, (std::vector<std::size_t>{256, 256, 88}));
}

TEST_F(ExperimentPlan, APointIsEstimatedOnceHoweverManySeedsItHas) {
    const Experiment many = experiment("500");
    std::size_t estimates = 0;
    const std::string list =
        list_runs(many, prepare_experiment(many, results()), [&](const Scene&, const CoarseView&, const RunSettings&) {
            ++estimates;
            return TimeEstimate{3600.0, 0.0, 0};
        });
    EXPECT_EQ(estimates, 4u);
    EXPECT_NE(list.find("walls_ppm_alpha-0.5_seed-500 "), std::string::npos);
    EXPECT_NE(list.find("2000 runs of 2 passes on 1 threads: about "), std::string::npos);
}

TEST_F(ExperimentPlan, ListingOpensADescriptionARunAndASlotAPoint) {
    const Experiment some = experiment("18", "decomposition = true\n");
    run_experiment(some, prepare_experiment(some, results()), results());
    FileEvents events(results());
    const PreparedExperiment prepared = prepare_experiment(some, results(), {}, Check::Sizes);
    EXPECT_EQ(prepared.faults, std::vector<std::string>{});
    const auto counts = events.counts();
    EXPECT_EQ(counts.at("run.json opened"), 18 * 4);
    EXPECT_FALSE(counts.contains("iterations.csv opened"));
    for (const auto& [what, count] : counts) {
        EXPECT_FALSE(what.ends_with("written")) << what;
        if (what.starts_with("slot-")) {
            EXPECT_LE(count, 4 * 6) << what;  // points, looks at one header
        }
    }
}

TEST_F(ExperimentPlan, WhereAllIsFinishedNothingIsWritten) {
    const Experiment some = experiment("18", "decomposition = true\n");
    run_experiment(some, prepare_experiment(some, results()), results());
    FileEvents events(results());
    const ExperimentOutcome outcome = run_experiment(some, prepare_experiment(some, results()), results());
    EXPECT_EQ(outcome.skipped, 72u);
    EXPECT_EQ(outcome.merged->runs, 72u);
    for (const auto& [what, count] : events.counts()) EXPECT_FALSE(what.ends_with("written")) << what << ' ' << count;
}

// Of a job's own runs: how many others the folder has changes nothing.
TEST_F(ExperimentPlan, AJobOpensAsManyFilesAmongThousandRunsAsAmongHundred) {
    const auto opened_by_job = [&](const std::string& seeds) {
        std::filesystem::remove_all(results());
        const Experiment all = experiment(seeds, "decomposition = true\n");
        const ContinuationOptions part{.is_part = true};
        const RunSelection selection{.groups = GroupRange{7, 7}};
        run_experiment(all, prepare_experiment(all, results(), selection), results(), part);
        for (const ExperimentRun& run : runs_of(all))  // what is in the others is nobody's business
            if (run.group != 7)
                std::filesystem::copy(results() / "runs/walls_path_seed-7", results() / "runs" / run.name,
                                      std::filesystem::copy_options::recursive);
        std::filesystem::remove(results() / "runs/walls_ppm_alpha-0.5_seed-7/run.json");
        std::filesystem::remove_all(results() / "ensembles/walls_ppm_alpha-0.5");
        FileEvents events(results());
        const ExperimentOutcome outcome =
            run_experiment(all, prepare_experiment(all, results(), selection), results(), part);
        EXPECT_EQ(outcome.ran, 1u);
        EXPECT_EQ(outcome.skipped, 3u);
        EXPECT_FALSE(outcome.merged);
        std::map<std::string, int> counts = events.counts();
        EXPECT_FALSE(counts.contains("iterations.csv written") && counts.contains("merged.json written"));
        return counts;
    };
    const auto of_hundred = opened_by_job("25");
    const auto of_thousand = opened_by_job("250");
    EXPECT_EQ(of_hundred, of_thousand);
    EXPECT_EQ(of_hundred.at("run.json opened"), 3);  // of its four runs one has none
}

TEST_F(ExperimentPlan, MergingOpensTheTwoFilesOfARunOnce) {
    const Experiment some = experiment("25");
    run_experiment(some, prepare_experiment(some, results()), results(), {.is_part = true});
    EXPECT_FALSE(std::filesystem::exists(results() / "iterations.csv"));
    FileEvents events(results());
    const auto merged = merge_experiment(some, prepare_all_keys(some, results()), results(), [] { return false; });
    EXPECT_EQ(merged->runs, 100u);
    auto counts = events.counts();
    EXPECT_EQ(counts.at("run.json opened"), 100);
    EXPECT_EQ(counts.at("iterations.csv opened"), 100);
    const std::string whole = read_text_file(results() / "iterations.csv");
    run_experiment(some, prepare_experiment(some, results()), results());
    EXPECT_EQ(read_text_file(results() / "iterations.csv"), whole);
}

// From the file alone, so that every job counts alike whatever is finished.
TEST_F(ExperimentPlan, AGroupIsASceneAndASeed) {
    folder_.write("other/scene.xml", two_walls_scene);
    folder_.write("two.toml",
                  "passes = 2\nthreads = 1\nphotons_per_pass = 100\nseeds = [5, 9, 2]\n"
                  "scenes = [\"walls/scene.xml\", \"other/scene.xml\"]\n"
                  "[[method]]\nintegrator = \"ppm\"\n[[method]]\nintegrator = \"path\"\n");
    folder_.write("walls/scene.xml", two_walls_scene);
    const Experiment two = read_experiment(folder_ / "two.toml");
    EXPECT_EQ(two.group_count(), 6u);
    const PreparedExperiment prepared = prepare_experiment(two, results(), RunSelection{.groups = GroupRange{3, 4}});
    std::vector<std::string> names;
    for (const PreparedRun& run : prepared.runs) names.push_back(run.run.name);
    EXPECT_EQ(names, (std::vector<std::string>{"walls_ppm_seed-2", "walls_path_seed-2", "other_ppm_seed-5",
                                               "other_path_seed-5"}));
    EXPECT_FALSE(message_of([&] {
                     prepare_experiment(two, results(), RunSelection{.groups = GroupRange{7, 7}});
                 }).find("--group: expected groups from 1 to 6, as many as scenes times seeds, got 7"));
    EXPECT_EQ(prepare_experiment(two, results(), {"*_path_*", GroupRange{6, 6}}).runs.size(), 1u);
    EXPECT_EQ(message_of([&] {
                  prepare_experiment(two, results(), {"walls_*", GroupRange{4, 6}});
              }),
              "--only, --group: expected runs that are in both, got none that is called walls_* in groups 4 to 6");
}

TEST_F(ExperimentPlan, TheListAsJsonHasGroupsAndRuns) {
    const Experiment some = experiment("3");
    run_experiment(some, prepare_experiment(some, results(), {"*_seed-2"}), results());
    folder_.write("results/runs/walls_path_seed-3/checkpoint", "");
    const auto estimate = [](const Scene&, const CoarseView&, const RunSettings& settings) {
        return settings.method.integrator == "path" ? TimeEstimate{50.0, 0.0, 0} : TimeEstimate{100.0, 60.0, 0};
    };
    const Json list =
        Json::parse(list_runs_json(some, prepare_experiment(some, results(), {}, Check::Sizes), estimate));
    EXPECT_EQ(list.at("experiment"), "plan");
    ASSERT_EQ(list.at("groups").size(), 3u);
    ASSERT_EQ(list.at("runs").size(), 12u);
    const Json& first = list.at("groups")[0];
    EXPECT_EQ(first.at("group"), 1);
    EXPECT_EQ(first.at("seed"), 1);
    EXPECT_EQ(first.at("runs"), 4);
    EXPECT_EQ(first.at("unfinished"), 4);
    EXPECT_EQ(first.at("seconds"), 100.0 + 40.0 + 40.0 + 50.0);  // photons are traced once
    EXPECT_GT(first.at("mebibytes"), 0.0);
    EXPECT_EQ(list.at("groups")[1].at("unfinished"), 0);
    EXPECT_EQ(list.at("groups")[1].at("seconds"), 0.0);
    const Json& run = list.at("runs")[0];
    EXPECT_EQ(run.at("name"), "walls_ppm_alpha-0.5_seed-1");
    EXPECT_EQ(run.at("group"), 1);
    EXPECT_EQ(run.at("settings").at("alpha"), 0.5);
    EXPECT_FALSE(run.at("settings").contains("k"));
    EXPECT_EQ(run.at("state"), "unfinished");
    EXPECT_EQ(run.at("seconds"), 100.0);
    EXPECT_EQ(list.at("runs")[1].at("state"), "finished");
    EXPECT_EQ(list.at("runs")[11].at("name"), "walls_path_seed-3");
    EXPECT_EQ(list.at("runs")[11].at("state"), "saved");
}

}  // namespace
}  // namespace photonlab
