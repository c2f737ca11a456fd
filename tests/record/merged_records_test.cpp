// What is merged while other processes replace runs, and what is said of finished runs that are left out.

#include "record/merged_records.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>

#include "record/recorder.h"
#include "record/run/run_record.h"
#include "tests/support/test_folder.h"

namespace photonlab {
namespace {

class MergedRecordsTest : public ::testing::Test {
protected:
    std::filesystem::path folder_of(const std::string& run) const { return folder_ / ("runs/" + run); }

    std::string rows_of(const std::string& content) const { return csv_header() + "\n" + content + "\n"; }

    static std::string description(const std::string& key, const std::string& rows) {
        return with_checksum({{"schema", 2},
                              {"finished", true},
                              {"experiment", "tiny"},
                              {"run", "a"},
                              {"key", key},
                              {"seed", 1},
                              {"ensemble", nullptr},
                              {"reference", nullptr},
                              {"files", {{"iterations.csv", stamp_json(stamp_of_text(rows))}}}});
    }

    void finish(const std::string& run, const std::string& key, const std::string& content) const {
        folder_.write("runs/" + run + "/iterations.csv", rows_of(content));
        folder_.write("runs/" + run + "/run.json", description(key, rows_of(content)));
    }

    /// As a process makes a run again: the description goes first and comes last, and each file is replaced at once.
    void replace(const std::string& run, const std::string& key, const std::string& content) const {
        const auto put = [&](const std::string& name, const std::string& text) {
            std::filesystem::rename(folder_.write("new", text), folder_of(run) / name);
        };
        std::filesystem::remove(folder_of(run) / "run.json");
        std::filesystem::remove(folder_of(run) / "iterations.csv");
        put("iterations.csv", rows_of(content));
        put("run.json", description(key, rows_of(content)));
    }

    MergedRecords merge(const std::vector<std::string>& runs) const {
        std::vector<RunToMerge> wanted;
        for (const std::string& run : runs) wanted.push_back({folder_of(run), "key"});
        return merge_records("tiny", folder_.path(), wanted);
    }

    std::string table() const { return read_text_file(folder_ / "iterations.csv"); }

    TestFolder folder_;
};

TEST_F(MergedRecordsTest, ARunThatIsReplacedMeanwhileIsLookedAtAgain) {
    finish("a", "old", "1");
    int asked = 0;
    const FoundRun found = look_at_run(folder_of("a"), [&](const FinishedRun& run) -> std::vector<std::string> {
        if (++asked == 1) replace("a", "new", "2");
        return faults_of(folder_of("a"), run, Check::Records);
    });
    EXPECT_EQ(asked, 2);
    EXPECT_EQ(found.faults, std::vector<std::string>{});
    ASSERT_TRUE(found.run);
    EXPECT_EQ(found.run->key, "new");
}

TEST_F(MergedRecordsTest, ARunThatVanishesMeanwhileIsNotFinished) {
    finish("a", "key", "1");
    const FoundRun found = look_at_run(folder_of("a"), [&](const FinishedRun& run) {
        std::filesystem::remove_all(folder_of("a"));
        return faults_of(folder_of("a"), run, Check::Records);
    });
    EXPECT_FALSE(found.is_described);
    EXPECT_FALSE(found.run);
    EXPECT_EQ(found.faults, std::vector<std::string>{});
}

TEST_F(MergedRecordsTest, ARunThatIsTheSameTwiceAndDoesNotFitIsAFault) {
    finish("a", "key", "1");
    folder_.write("runs/a/iterations.csv", rows_of("2"));
    finish("b", "key", "3");
    const MergedRecords merged = merge({"a", "b"});
    EXPECT_EQ(merged.runs, 1u);
    EXPECT_EQ(merged.faults, (std::vector<std::string>{(folder_of("a") / "iterations.csv").string() +
                                                       ": is not what was written: its checksum is another"}));
    EXPECT_EQ(table(), rows_of("3"));
}

TEST_F(MergedRecordsTest, RunsThatAreReplacedAllTheTimeAreNeverFaults) {
    finish("a", "key", "0");
    finish("b", "key", "steady");
    std::atomic<bool> is_over = false;
    std::thread other([&] {
        for (int i = 1; !is_over; ++i) replace("a", "key", std::to_string(i));
    });
    for (int i = 0; i < 200; ++i) {
        const MergedRecords merged = merge({"a", "b"});
        EXPECT_EQ(merged.faults, std::vector<std::string>{});
        EXPECT_GE(merged.runs, 1u);
        EXPECT_TRUE(table().ends_with("\nsteady\n")) << table();
    }
    is_over = true;
    other.join();
}

TEST_F(MergedRecordsTest, FinishedRunsThatAreLeftOutAreCountedAndNamed) {
    EXPECT_EQ(describe_left_out(merge({"a"})), "");
    finish("a", "key", "1");
    EXPECT_EQ(describe_left_out(merge({"a", "none"})), "");
    finish("b", "another key", "2");
    EXPECT_EQ(describe_left_out(merge({"a", "b"})),
              "finished runs that are left out: 1 of other settings than the experiment has now, or of another program "
              "(b)");
    finish("c", "another key", "3");
    finish("d", "key", "4");
    finish("e", "key", "5");
    folder_.write("runs/unfinished/iterations.csv", rows_of("6"));
    const MergedRecords merged = merge({"a", "b", "c"});
    EXPECT_EQ(describe_left_out(merged),
              "finished runs that are left out: 2 of other settings than the experiment has now, or of another program "
              "(b, ...), and 2 that the experiment does not have (d, ...)");
    EXPECT_EQ(merged.runs, 1u);
    EXPECT_EQ(merged.faults, std::vector<std::string>{});
    EXPECT_EQ(table(), rows_of("1"));
}

}  // namespace
}  // namespace photonlab
