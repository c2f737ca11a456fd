#include "core/text/nearest.h"

#include <gtest/gtest.h>

namespace photonlab {
namespace {

const std::vector<std::string_view> commands{"render", "run", "reference", "compare", "info", "help"};

TEST(NearestName, IsTheOneThatWasMisspelt) {
    for (const auto& [written, meant] :
         std::vector<std::pair<std::string_view, std::string_view>>{{"rnu", "run"},
                                                                    {"runn", "run"},
                                                                    {"rendr", "render"},
                                                                    {"redner", "render"},
                                                                    {"Render", "render"},
                                                                    {"RUN", "run"},
                                                                    {"refernce", "reference"},
                                                                    {"ref", "reference"},
                                                                    {"comp", "compare"},
                                                                    {"compere", "compare"},
                                                                    {"inof", "info"},
                                                                    {"hlep", "help"}})
        EXPECT_EQ(nearest_name(written, commands), meant) << written;
    EXPECT_EQ(nearest_name("samples-per-pixel", {"samples", "samples_per_pixel"}), "samples_per_pixel");
    EXPECT_EQ(nearest_name("photons_per_pas", {"photons_per_pass"}), "photons_per_pass");
}

TEST(NearestName, IsNoneWhereNothingIsNear) {
    for (const std::string_view written : {"", "x", "walk", "photon", "rr", "zzzzzz"})
        EXPECT_EQ(nearest_name(written, commands), "") << written;
    EXPECT_EQ(nearest_name("x", {"k"}), "") << "any letter is one change from any other";
    EXPECT_EQ(nearest_name(std::string(100'000, 'r'), commands), "");
    EXPECT_EQ(nearest_name("run", {}), "");
}

TEST(NearestName, StandsInTheMessageBeforeAllThatAreKnown) {
    EXPECT_EQ(unknown_name("kernel", "disk", {"disc", "cone"}),
              "unknown kernel \"disk\"; did you mean \"disc\"? Known here: disc, cone");
    EXPECT_EQ(unknown_name("kernel", "gauss", {"disc", "cone"}), "unknown kernel \"gauss\"; known here: disc, cone");
}

}  // namespace
}  // namespace photonlab
