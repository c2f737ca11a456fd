#include "record/images/ensemble.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "image/exr.h"
#include "tests/support/test_folder.h"

namespace photonlab {
namespace {

class EnsembleTest : public ::testing::Test {
protected:
    /// Images whose pixels are whole numbers: sums are exact.
    static std::vector<PassImage> images(float value) {
        const auto image = [&](float gathered) {
            return Image{2,
                         1,
                         {{"emission", {Color(7.0f), Color(0.0f)}},
                          {"direct", {Color(value), Color(1.0f)}},
                          {"gathered", {Color(gathered), Color(2.0f)}}}};
        };
        return {{0, image(0.0f)}, {128, image(10.0f * value)}};
    }
    Ensemble open(const std::string& key = "key", const Json& description = {{"point", "p"}}) const {
        return Ensemble(folder_ / "point", key, description);
    }
    Image slot(int number, Metadata* metadata = nullptr) const {
        return read_exr(
            folder_ / ("point/slot-" + std::string(number < 10 ? "0" : "") + std::to_string(number) + ".exr"),
            metadata);
    }

    TestFolder folder_;
};

TEST_F(EnsembleTest, KeepsEverySeedApartWhileThereAreSlots) {
    for (std::uint64_t seed = 1; seed <= 16; ++seed) open().add(seed, seed - 1, images(static_cast<float>(seed)));
    for (int i = 0; i < 16; ++i) {
        Metadata metadata;
        const Image image = slot(i, &metadata);
        EXPECT_EQ(metadata["photonlab.seeds"], std::to_string(i + 1));
        EXPECT_EQ(image.layers.size(), 5u);
        EXPECT_EQ(image.find("emission")->at(0), Color(7.0f));
        EXPECT_EQ(image.find("pass-000000-direct")->at(0), Color(static_cast<float>(i + 1)));
        EXPECT_EQ(image.find("pass-000128-gathered")->at(0), Color(static_cast<float>(10 * (i + 1))));
    }
}

TEST_F(EnsembleTest, AddsFurtherSeedsToTheSlotsInTurn) {
    for (std::uint64_t seed = 1; seed <= 35; ++seed) open().add(seed, seed - 1, images(static_cast<float>(seed)));
    Metadata metadata;
    const Image image = slot(2, &metadata);
    EXPECT_EQ(metadata["photonlab.seeds"], "3 19 35");
    EXPECT_EQ(image.find("pass-000128-gathered")->at(0), Color(10.0f * (3 + 19 + 35)));
    EXPECT_EQ(image.find("pass-000128-gathered")->at(1), Color(6.0f));
    EXPECT_EQ(image.find("emission")->at(0), Color(21.0f));
    slot(15, &metadata);
    EXPECT_EQ(metadata["photonlab.seeds"], "16 32");
    EXPECT_FALSE(std::filesystem::exists(folder_ / "point/slot-16.exr"));
    for (std::uint64_t seed = 1; seed <= 35; ++seed) EXPECT_TRUE(open().contains(seed));
    EXPECT_FALSE(open().contains(36));
}

// Which process is first is chance; what is in the files is not.
TEST_F(EnsembleTest, OfSeedsInAnyOrderIsTheSameBytes) {
    constexpr std::uint64_t seeds = 53;
    std::mt19937 random(2008);
    std::vector<std::vector<PassImage>> of_seed;
    std::vector<std::uint64_t> order;
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
        of_seed.push_back(images(std::exp(std::normal_distribution<float>(0.0f, 2.0f)(random))));
        order.push_back(seed);
    }
    const auto add_all = [&](const std::string& folder) {
        for (const std::uint64_t seed : order)
            Ensemble(folder_ / folder, "key", {{"point", "p"}}).add(seed, seed, of_seed[seed]);
    };
    add_all("point");
    Metadata metadata;
    EXPECT_EQ(slot(3, &metadata).layers.size(), 10u);
    EXPECT_EQ(metadata["photonlab.inexact"], "0");
    for (int i = 0; i < 3; ++i) {
        std::shuffle(order.begin(), order.end(), random);
        const std::string folder = "shuffled " + std::to_string(i);
        add_all(folder);
        for (const auto& entry : std::filesystem::directory_iterator(folder_ / "point"))
            EXPECT_EQ(read_text_file(entry.path()), read_text_file(folder_ / folder / entry.path().filename()))
                << entry.path();
    }
}

TEST_F(EnsembleTest, CountsAdditionsInWhichSomethingWasLost) {
    open().add(1, 0, images(1e8f));
    open().add(17, 16, images(1e-8f));
    Metadata metadata;
    slot(0, &metadata);
    EXPECT_EQ(metadata["photonlab.inexact"], "9");  // three channels of a pixel of three layers
    EXPECT_EQ(read_slot_content(folder_ / "point/slot-00.exr").inexact, 9u);
}

TEST_F(EnsembleTest, TakesASeedOnce) {
    open().add(5, 0, images(1.0f));
    open().add(5, 0, images(1.0f));
    EXPECT_EQ(slot(0).find("pass-000128-direct")->at(0), Color(1.0f));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "point/slot-01.exr"));
}

TEST_F(EnsembleTest, BeginsAnewForOtherSettings) {
    open().add(1, 0, images(1.0f));
    open().add(2, 1, images(1.0f));
    EXPECT_FALSE(open("other").contains(1));
    EXPECT_TRUE(open().contains(1));  // asking removes nothing
    open("other").add(2, 0, images(3.0f));
    EXPECT_EQ(slot(0).find("pass-000128-direct")->at(0), Color(3.0f));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "point/slot-01.exr"));
    EXPECT_TRUE(open("other").contains(2));
}

TEST_F(EnsembleTest, SaysWhatTheSumsAreOf) {
    open().describe();
    EXPECT_FALSE(std::filesystem::exists(folder_ / "point"));  // of nothing yet
    open().add(1, 0, images(1.0f));
    open("key", {{"point", "p"}, {"regions", {{"edge", {1, 2, 3, 4}}}}}).describe();
    const Json json = Json::parse(read_text_file(folder_ / "point/ensemble.json"));
    EXPECT_EQ(json.at("schema"), 2);
    EXPECT_EQ(json.at("key"), "key");
    EXPECT_EQ(json.at("slots"), 16);
    EXPECT_EQ(json.at("regions").at("edge")[3], 4);
}

// Whatever becomes of a slot, asking for its seeds is answered no, so that they are made again.
TEST_F(EnsembleTest, AMissingOrDamagedSlotIsAsEmpty) {
    for (std::uint64_t seed = 1; seed <= 35; ++seed) open().add(seed, seed - 1, images(static_cast<float>(seed)));
    const std::filesystem::path file = folder_ / "point/slot-02.exr";
    const std::string whole = read_text_file(file);
    std::vector<std::string> damaged{"", "nothing", whole.substr(0, whole.size() / 2), whole + " "};
    for (std::size_t i = 0; i < whole.size(); i += 3) {
        damaged.push_back(whole);
        damaged.back()[i] = static_cast<char>(damaged.back()[i] ^ 1);
    }
    for (const std::string& bytes : damaged) {
        folder_.write("point/slot-02.exr", bytes);
        Ensemble ensemble = open();
        ensemble.check_slots();
        ASSERT_FALSE(ensemble.contains(3) || ensemble.contains(19) || ensemble.contains(35));
        ASSERT_EQ(ensemble.faults().size(), 1u);
        ASSERT_TRUE(ensemble.faults()[0].starts_with(file.string() + ": ")) << ensemble.faults()[0];
        ASSERT_TRUE(ensemble.contains(1) && ensemble.contains(34));
    }
    std::filesystem::remove(file);
    Ensemble ensemble = open();
    EXPECT_FALSE(ensemble.contains(3));
    for (const std::uint64_t seed : {3, 19, 35}) ensemble.add(seed, seed - 1, images(static_cast<float>(seed)));
    EXPECT_EQ(read_text_file(file), whole);
}

TEST_F(EnsembleTest, NothingIsAddedToADamagedSlot) {
    for (std::uint64_t seed = 1; seed <= 16; ++seed) open().add(seed, seed - 1, images(1.0f));
    const std::filesystem::path file = folder_ / "point/slot-00.exr";
    std::string bytes = read_text_file(file);
    bytes.back() = static_cast<char>(bytes.back() ^ 1);
    write_text_file(file, bytes);
    const std::string message = message_of([&] { open().add(17, 16, images(1.0f)); });
    EXPECT_NE(message.find("slot-00.exr: is not what was written: its checksum is another; remove it, and the runs of "
                           "its seeds are made again"),
              std::string::npos)
        << message;
    EXPECT_EQ(read_text_file(file), bytes);
}

// The description says nothing that the slots do not say themselves.
TEST_F(EnsembleTest, ADamagedDescriptionLosesNoSums) {
    open().add(1, 0, images(1.0f));
    const std::string whole = read_text_file(folder_ / "point/ensemble.json");
    folder_.write("point/ensemble.json", "{");
    EXPECT_TRUE(open().contains(1));
    open().describe();
    EXPECT_EQ(read_text_file(folder_ / "point/ensemble.json"), whole);
}

}  // namespace
}  // namespace photonlab
