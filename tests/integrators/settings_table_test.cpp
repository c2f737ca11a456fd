// What the table of settings promises of each line, whatever lines there are.

#include "integrators/settings/settings_table.h"

#include <gtest/gtest.h>

#include "integrators/registry.h"
#include "integrators/settings/chosen_settings.h"

namespace photonlab {
namespace {

using Type = SettingField::Type;

std::string message_of(const std::function<void()>& step) {
    try {
        step();
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

/// A value in the setting's range that is not its default.
SettingValue other_value(const SettingField& field) {
    if (field.name == "integrator") return std::string("path");
    if (!field.choices.empty()) return std::string(field.choices.back());
    if (field.type == Type::Length) return 1.0 / 3.0;
    const double least = field.range ? field.range->least : 0.0;
    return field.type == Type::Integer ? SettingValue(static_cast<std::int64_t>(least) + 76) : least + 1.0 / 3.0;
}

TEST(SettingsTable, HoldsEverySettingThatAnIntegratorUses) {
    for (const IntegratorKind& kind : integrator_kinds())
        for (const std::string_view name : kind.settings) EXPECT_NE(find_setting_field(name), nullptr) << name;
}

TEST(SettingsTable, EverySettingIsUsedAndSaysWhatItIs) {
    for (const SettingField& field : setting_fields()) {
        EXPECT_FALSE(users_of(field.name).empty()) << field.name;
        EXPECT_TRUE(field.option.starts_with("--")) << field.name;
        EXPECT_FALSE(field.meaning.empty()) << field.name;
        EXPECT_TRUE(field.name == "integrator" || !describe_values(field).empty()) << field.name << " can be anything";
        EXPECT_NO_THROW(require_in_range(field, {})) << "default of " << field.name;
    }
}

// Every field is set to what it is not by itself, written as text, and read again.
TEST(SettingsTable, ReadsBackWhatItWrites) {
    MethodSettings written;
    for (const SettingField& field : setting_fields()) field.set(field, written, other_value(field));
    MethodSettings read;
    for (const SettingField& field : setting_fields()) {
        EXPECT_NE(field.get(written), field.get(MethodSettings{})) << field.name << " was not set";
        field.set(field, read, parse_setting_value(plain_text(field.get(written))));
    }
    for (const SettingField& field : setting_fields()) EXPECT_EQ(field.get(read), field.get(written)) << field.name;
}

TEST(SettingsTable, RefusesWhatIsOutOfRangeWithWhatIsExpected) {
    const auto refusal = [](std::string_view name, const SettingValue& value) {
        const SettingField& field = *find_setting_field(name);
        MethodSettings settings;
        field.set(field, settings, value);
        return message_of([&] { require_in_range(field, settings); });
    };
    EXPECT_EQ(refusal("alpha", 1.5), "alpha: expected a number in (0, 1], got 1.5");
    EXPECT_EQ(refusal("alpha", 0.0), "alpha: expected a number in (0, 1], got 0");
    EXPECT_EQ(refusal("alpha", 1.0), "");
    EXPECT_EQ(refusal("k", std::int64_t{1}), "k: expected at least 2, got 1");
    EXPECT_EQ(refusal("footprints", 0.0), "footprints: expected a number above 0, got 0");
    EXPECT_EQ(refusal("radius", -1.0), "radius: expected \"auto\" or a length above 0 in scene units, got -1");
    EXPECT_EQ(refusal("max_depth", std::int64_t{0}), "max_depth: expected -1 (unlimited) or at least 1, got 0");
    EXPECT_EQ(refusal("max_depth", std::int64_t{-1}), "");
    EXPECT_EQ(refusal("branch_cutoff", 2.0), "branch_cutoff: expected from 1e-12 to 1, got 2");
    EXPECT_EQ(refusal("photons_per_pass", std::int64_t{0}), "photons_per_pass: expected from 1 to 4294967296, got 0");
    for (const double number : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
        for (const SettingField& field : setting_fields())
            if (field.type == Type::Number || field.type == Type::Length) {
                EXPECT_NE(refusal(field.name, number), "") << field.name;
            }
}

TEST(SettingsTable, UnsetRadiusIsCalledAuto) {
    MethodSettings settings;
    settings.radius = 2.0;
    const SettingField& radius = *find_setting_field("radius");
    radius.set(radius, settings, std::string("auto"));
    EXPECT_FALSE(settings.radius.has_value());
    EXPECT_EQ(plain_text(radius.get(settings)), "auto");
}

TEST(SettingsTable, WholeNumbersMayHaveAnExponent) {
    MethodSettings settings;
    const SettingField& photons = *find_setting_field("photons_per_pass");
    photons.set(photons, settings, parse_setting_value("1e6"));
    EXPECT_EQ(settings.photons_per_pass, 1'000'000u);
    EXPECT_EQ(message_of([&] { photons.set(photons, settings, parse_setting_value("1.5")); }),
              "photons_per_pass: expected a whole number, got 1.5");
    EXPECT_EQ(message_of([&] { photons.set(photons, settings, parse_setting_value("-1")); }),
              "photons_per_pass: expected a whole number of at least 0, got -1");
}

TEST(SettingsTable, WhatTheMethodDoesNotUseIsEmpty) {
    const MethodSettings settings{.integrator = "path"};
    EXPECT_EQ(setting_text(settings, *find_setting_field("alpha")), "");
    EXPECT_EQ(setting_text(settings, *find_setting_field("max_depth")), "-1");
}

TEST(ChosenSettings, DepthIsTheScenesUnlessGiven) {
    ChosenSettings settings;
    EXPECT_EQ(resolve(settings, 5).max_depth, 5);
    choose(settings, *find_setting_field("max_depth"), std::int64_t{-1});
    EXPECT_EQ(resolve(settings, 5).max_depth, -1);
}

}  // namespace
}  // namespace photonlab
