#include "record/run/part.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <optional>

#include "core/error.h"
#include "core/files/json.h"
#include "core/machine/version.h"
#include "integrators/registry.h"
#include "integrators/settings/settings_table.h"
#include "record/run/settings_json.h"

namespace photonlab {

namespace {

Json json_of(const RunPart& part) {
    return {{"photonlab", part.command},
            {"program", program_version().version},
            {"scene",
             {{"file", part.scene_file.string()},
              {"parameters", part.parameters},
              {"hash", part.scene_hash},
              {"width", part.width},
              {"height", part.height},
              {"samples_per_pixel", part.samples_per_pixel}}},
            {"settings", settings_json(part.settings)},
            {"seed", part.seed},
            {"passes", {part.passes.first, part.passes.last}}};
}

SettingValue value_of(const Json& json) {
    if (json.is_number_integer()) return json.get<std::int64_t>();
    if (json.is_number()) return json.get<double>();
    return json.get<std::string>();
}

RunPart part_from(const Json& json) {
    RunPart part;
    part.command = json.at("photonlab").get<std::string>();
    const Json& scene = json.at("scene");
    part.scene_file = scene.at("file").get<std::string>();
    part.parameters = scene.at("parameters").get<std::map<std::string, std::string>>();
    part.scene_hash = scene.at("hash").get<std::string>();
    part.width = scene.at("width").get<int>();
    part.height = scene.at("height").get<int>();
    part.samples_per_pixel = scene.at("samples_per_pixel").get<int>();
    const Json& settings = json.at("settings");
    for (const SettingField& field : setting_fields())
        if (const Json& value = settings.at(std::string(field.name)); !value.is_null())
            field.set(field, part.settings, value_of(value));
    part.seed = json.at("seed").get<std::uint64_t>();
    part.passes = {json.at("passes").at(0).get<std::uint64_t>(), json.at("passes").at(1).get<std::uint64_t>()};
    return part;
}

/// "alpha is 0.6 here and 0.7 in a.ck": every value in which two objects differ, one after the other.
void add_differences(std::vector<std::string>& found, const Json& here, const Json& there, const std::string& file) {
    for (const auto& [name, value] : here.items()) {
        if (name == "passes" || name == "file" || there.at(name) == value) continue;
        if (value.is_object() && name != "parameters")
            add_differences(found, value, there.at(name), file);
        else
            found.push_back(fmt::format("{} is {} here and {} in {}", name, value.dump(), there.at(name).dump(), file));
    }
}

}  // namespace

Checkpoint checkpoint_of(const RunPart& part, const std::filesystem::path& file) {
    return {file, json_of(part).dump(), "remove it, or give another file"};
}

PartFile read_part(const std::filesystem::path& file) {
    const std::string identity = read_identity(file);
    std::optional<Json> json;
    try {
        json = parse_json(identity);
    } catch (const InputError&) {
    }
    if (!json || !json->is_object() || !json->contains("photonlab"))
        throw InputError(file.string(),
                         "is the checkpoint of a run that takes all its passes by itself; expected one of "
                         "render or reference with --passes A..B");
    try {
        PartFile part{{file, identity, "make it anew"}, part_from(*json)};
        if (const std::string made_by = json->at("program").get<std::string>(); made_by != program_version().version)
            throw InputError(file.string(), fmt::format("was made by photonlab {}, and this is {}", made_by,
                                                        program_version().version));
        return part;
    } catch (const Json::exception& error) {
        throw InputError(file.string(), std::string("is of another program: ") + error.what());
    }
}

void require_same_run(const PartFile& first, const PartFile& part) {
    std::vector<std::string> differences;
    add_differences(differences, json_of(part.part), json_of(first.part), first.checkpoint.file.string());
    if (!differences.empty())
        throw InputError(part.checkpoint.file.string(),
                         fmt::format("is of another run: {}", fmt::join(differences, ", ")));
}

std::vector<PartFile> read_parts(const std::vector<std::filesystem::path>& files) {
    std::vector<PartFile> parts;
    for (const std::filesystem::path& file : files) {
        parts.push_back(read_part(file));
        require_same_run(parts.front(), parts.back());
    }
    std::sort(parts.begin(), parts.end(),
              [](const PartFile& a, const PartFile& b) { return a.part.passes.first < b.part.passes.first; });
    for (std::size_t i = 1; i < parts.size(); ++i)
        if (parts[i].part.passes.first <= parts[i - 1].part.passes.last)
            throw InputError(parts[i].checkpoint.file.string(),
                             fmt::format("is of passes {}, and {} is of {}: a pass would count twice",
                                         describe(parts[i].part.passes), parts[i - 1].checkpoint.file.string(),
                                         describe(parts[i - 1].part.passes)));
    return parts;
}

void load_part(const PartFile& part, PassLoop& loop) {
    const auto& [checkpoint, of] = part;
    const std::optional<EmissionMap> learnt = loop.state(0).pass > 0 ? loop.state_now(0).emission_map : std::nullopt;
    const bool is_there = load(checkpoint, [&](StateArchive& archive) {
        if (loop.state(0).pass > 0) archive.begin_joining();
        loop.exchange(0, archive);
        archive.skip_rest();  // what was recorded on the way
    });
    if (!is_there) throw InputError(checkpoint.file.string(), "is not there");
    if (const PassRange& taken = loop.state(0).ranges.back(); taken != of.passes)
        throw InputError(checkpoint.file.string(), fmt::format("has taken passes {} of {}; --resume takes the others",
                                                               describe(taken), describe(of.passes)));
    if (learnt && !(loop.state_now(0).emission_map == learnt))
        throw InputError(checkpoint.file.string(), "emitted by another emission map than those before it");
}

bool is_whole(const Checkpoint& checkpoint, const PassRange& passes) {
    std::uint64_t taken = 0;
    load(checkpoint, [&](StateArchive& archive) {
        archive.exchange(taken);  // the first thing in the state of a PassLoop
        archive.skip_rest();
    });
    return taken == passes.last;
}

void require_separable(const MethodSettings& settings, const PassRange& passes) {
    const Needs needs = needs_of(settings);
    if (!needs.can_be_joined())
        throw InputError(fmt::format(
            "--passes {}: passes of this {} follow from those before{}", describe(passes), settings.integrator,
            needs.ordered_since.empty() ? "" : fmt::format(", since {}", needs.ordered_since)));
    const auto learning = static_cast<std::uint64_t>(settings.learn_passes);
    if (needs.passes == Needs::Passes::AfterLearning && passes.first <= learning &&
        (passes.first > 1 || passes.last < learning))
        throw InputError(fmt::format(
            "--passes {}: emission learns in passes 1..{}, which are taken in one piece; later ones begin after it",
            describe(passes), learning));
}

std::string gaps_of(const std::vector<PassRange>& ranges) {
    std::vector<std::string> gaps;
    std::uint64_t next = 1;
    for (const PassRange& range : ranges) {
        if (range.first > next) gaps.push_back(describe(PassRange{next, range.first - 1}));
        next = range.last + 1;
    }
    return fmt::format("{}", fmt::join(gaps, " and "));
}

}  // namespace photonlab
