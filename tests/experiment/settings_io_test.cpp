#include "experiment/settings_io.h"

#include <gtest/gtest.h>

#include "integrators/registry.h"
#include "test_folder.h"

namespace photonlab {
namespace {

TEST(SettingsTable, HoldsEverySettingThatAnIntegratorUses) {
    for (const IntegratorKind& kind : integrator_kinds())
        for (const std::string_view name : kind.settings) EXPECT_NE(find_setting_field(name), nullptr) << name;
}

TEST(SettingsTable, ReadsBackWhatItWrites) {
    MethodSettings written;
    written.integrator = "photonmapper";
    written.mode = GatherMode::Nearest;
    written.schedule = ScheduleName::KnausZwicker;
    written.alpha = 1.0 / 3.0;
    written.k = 77;
    written.radius = 0.1;
    written.footprints = 2.5;
    written.max_radius = 1e-30;
    written.kernel = Kernel::Biweight;
    written.eps = 0.25;
    written.direct = DirectMode::Photons;
    written.direct_samples = 3;
    written.max_depth = 9;
    written.branch_cutoff = 3e-3;
    written.photons_per_pass = 123'456'789'012;
    MethodSettings read;
    for (const SettingField& field : setting_fields())
        field.read(field.name, read, parse_setting_value(plain_text(field.write(written))));
    for (const SettingField& field : setting_fields()) EXPECT_EQ(field.write(read), field.write(written)) << field.name;
}

TEST(SettingsTable, UnsetRadiusIsCalledAuto) {
    MethodSettings settings;
    settings.radius = 2.0;
    const SettingField& radius = *find_setting_field("radius");
    radius.read("radius", settings, std::string("auto"));
    EXPECT_FALSE(settings.radius.has_value());
    EXPECT_EQ(plain_text(radius.write(settings)), "auto");
}

TEST(SettingsTable, WholeNumbersMayHaveAnExponent) {
    MethodSettings settings;
    const SettingField& photons = *find_setting_field("photons_per_pass");
    photons.read("photons_per_pass", settings, parse_setting_value("1e6"));
    EXPECT_EQ(settings.photons_per_pass, 1'000'000u);
    EXPECT_EQ(message_of([&] { photons.read("photons_per_pass", settings, parse_setting_value("1.5")); }),
              "photons_per_pass: expected a whole number, got 1.5");
    EXPECT_EQ(message_of([&] { photons.read("photons_per_pass", settings, parse_setting_value("-1")); }),
              "photons_per_pass: expected a whole number of at least 0, got -1");
}

TEST(SettingsTable, WhatTheMethodDoesNotUseIsEmptyOrNull) {
    MethodSettings settings;
    settings.integrator = "path";
    EXPECT_EQ(setting_text(settings, *find_setting_field("alpha")), "");
    EXPECT_EQ(setting_text(settings, *find_setting_field("max_depth")), "-1");
    EXPECT_TRUE(settings_json(settings)["photons_per_pass"].is_null());
}

TEST(ChosenSettings, DepthIsTheScenesUnlessGiven) {
    ChosenSettings settings;
    EXPECT_EQ(resolve(settings, 5).max_depth, 5);
    choose(settings, *find_setting_field("max_depth"), std::int64_t{-1});
    EXPECT_EQ(resolve(settings, 5).max_depth, -1);
}

}  // namespace
}  // namespace photonlab
