#include "core/files/state_archive.h"

#include <gtest/gtest.h>

#include <sstream>

#include "core/math.h"

namespace photonlab {
namespace {

struct State {
    std::uint64_t count = 0;
    std::optional<double> radius;
    std::string name;
    std::vector<ColorD> sums;
    std::vector<std::string> names;

    void exchange(StateArchive& archive) {
        archive.exchange(count);
        archive.exchange(radius);
        archive.exchange(name);
        archive.exchange(sums);
        archive.exchange_each(names, [](StateArchive& each, std::string& text) { each.exchange(text); });
    }
    bool operator==(const State&) const = default;
};

State some_state() {
    return {7, 0.25, "corner", {ColorD(1.0, 2.0, 3.0), ColorD(0.1, -0.0, 1e300)}, {"a", "", "bc"}};
}

std::string written(State state) {
    std::ostringstream stream;
    StateArchive archive(stream);
    state.exchange(archive);
    return stream.str();
}

State read(const std::string& bytes) {
    std::istringstream stream(bytes);
    StateArchive archive(stream, bytes.size());
    State state{1, 2.0, "other", {ColorD(9.0)}, {"z"}};
    state.exchange(archive);
    EXPECT_EQ(archive.bytes_left(), 0u);
    return state;
}

TEST(StateArchive, ReadsWhatItWrote) {
    EXPECT_EQ(read(written(some_state())), some_state());
    EXPECT_EQ(read(written(State{})), State{});
}

TEST(StateArchive, HashesWhatItMoves) {
    std::ostringstream output;
    StateArchive writer(output);
    State state = some_state();
    state.exchange(writer);
    EXPECT_EQ(writer.hash(), hash_text(output.str()));

    std::istringstream input(output.str());
    StateArchive reader(input, output.str().size());
    state.exchange(reader);
    EXPECT_EQ(reader.hash(), writer.hash());
}

TEST(StateArchive, RefusesToReadPastItsEnd) {
    const std::string whole = written(some_state());
    for (std::size_t length = 0; length < whole.size(); ++length)
        EXPECT_THROW(read(whole.substr(0, length)), InputError) << length;
}

TEST(StateArchive, RefusesACountThatItsBytesCannotHoldBeforeMakingRoomForIt) {
    std::string bytes(8, '\xff');
    std::istringstream stream(bytes);
    StateArchive archive(stream, bytes.size());
    std::vector<double> values;
    try {
        archive.exchange(values);
        FAIL();
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(), "claims 18446744073709551615 values of 8 bytes where 0 bytes are left");
    }
}

TEST(StateArchive, RefusesAnotherNumberOfValuesThanExpected) {
    std::ostringstream output;
    StateArchive writer(output);
    std::vector<double> three{1.0, 2.0, 3.0};
    writer.exchange_as_many(three);
    std::istringstream input(output.str());
    StateArchive reader(input, output.str().size());
    std::vector<double> two(2);
    try {
        reader.exchange_as_many(two);
        FAIL();
    } catch (const InputError& error) {
        EXPECT_STREQ(error.what(), "expected 2 values, got 3");
    }
}

}  // namespace
}  // namespace photonlab
