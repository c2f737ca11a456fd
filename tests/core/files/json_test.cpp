#include "core/files/json.h"

#include <gtest/gtest.h>

#include "core/error.h"

namespace photonlab {
namespace {

std::string nested(std::size_t depth) {
    return std::string(depth, '[') + std::string(depth, ']');
}

TEST(JsonText, HoldsNamesThatAreNoUtf8) {
    const std::string text = json_text({{"folder", "caf\xe9"}, {"euro", "\xe2\x82\xac"}});
    EXPECT_EQ(text, "{\n  \"folder\": \"caf\xef\xbf\xbd\",\n  \"euro\": \"\xe2\x82\xac\"\n}");
    EXPECT_EQ(parse_json(text).at("folder"), "caf\xef\xbf\xbd");
}

TEST(JsonText, IsRefusedWhereCopyingItWouldTakeMoreStackThanThereIs) {
    EXPECT_TRUE(parse_sound_json(nested(60)));
    for (const std::size_t depth : {100, 250'000, 1'000'000}) EXPECT_FALSE(parse_sound_json(nested(depth)));
    EXPECT_FALSE(parse_sound_json(std::string(250'000, '[')));
    std::string objects;
    for (int i = 0; i < 100'000; ++i) objects += "{\"a\":";
    EXPECT_FALSE(parse_sound_json(objects + "1" + std::string(100'000, '}')));
    EXPECT_TRUE(parse_sound_json("[" + std::string(100'000, ' ') + "\"" + std::string(1000, '[') + "\"]"));
    EXPECT_THROW(parse_json(nested(100)), InputError);
}

TEST(JsonText, ThatIsNoneIsRefused) {
    for (const std::string text : {"", "{", "{\"a\": 1e999}", "{\"a\": \"\xff\"}", "[1,]", "nul"})
        EXPECT_FALSE(parse_sound_json(text)) << text;
}

}  // namespace
}  // namespace photonlab
