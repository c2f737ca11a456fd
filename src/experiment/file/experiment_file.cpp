#include "experiment/file/experiment_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>
#include <map>
#include <thread>

#include "core/error.h"
#include "core/files/files.h"
#include "core/machine/processors.h"
#include "core/text/nearest.h"
#include "core/text/text.h"
#include "experiment/file/toml.h"
#include "experiment/file/toml_nesting.h"
#include "integrators/registry.h"
#include "transport/camera/camera_pass.h"

namespace photonlab {

namespace {

constexpr std::int64_t most_passes = 0xffffffff;  // a random stream's pass has 32 bits
constexpr std::int64_t most_threads = 1024;
constexpr std::size_t most_runs = 100'000;
constexpr std::size_t longest_file_name = 255;                    // bytes, on the file systems of Linux
constexpr std::uint64_t most_records = 10'000'000;                // recorded passes of all runs together
constexpr std::uintmax_t largest_file = std::uintmax_t{1} << 24;  // bytes

/// The values of one setting, and where they stand in the file.
struct Axis {
    std::vector<SettingValue> values;
    std::string place;
};
using Axes = std::map<std::string, Axis, std::less<>>;

/// A scene as it stands in the file: one of the experiment for each number of sample positions.
struct WrittenScene {
    SceneEntry entry;
    std::vector<int> samples;  ///< of methods that have none of their own
};

struct Method {
    std::optional<std::string> name;
    std::optional<std::vector<int>> samples;  ///< sample positions a pixel
    Axes axes;
    PassPlan plan;
    std::string place;
};

std::string run_name(const ExperimentPoint& point, std::uint64_t seed) {
    return fmt::format("{}_seed-{}", point.name, seed);
}

/// Everything from letters to dots stays, the rest becomes a dash.
std::string file_safe(std::string text) {
    for (char& c : text)
        if (!std::isalnum(static_cast<unsigned char>(c)) && c != '.' && c != '-' && c != '_' && c != '+') c = '-';
    return text;
}

void sort_unique(std::vector<std::uint64_t>& values) {
    std::sort(values.begin(), values.end());
    values.erase(std::unique(values.begin(), values.end()), values.end());
}

class ExperimentReader {
public:
    ExperimentReader(const std::filesystem::path& file, std::optional<SmokeLimits> smoke) : smoke_(smoke) {
        experiment_.file = file;
        experiment_.name = valid_text(file.stem().string()) + (smoke ? "-smoke" : "");
        experiment_.is_smoke = smoke.has_value();
    }

    Experiment read() {
        const std::string text = read_text_file(experiment_.file, largest_file);
        if (const auto line = line_nested_too_deeply(text))
            throw InputError(fmt::format("{}:{}", experiment_.file.string(), *line),
                             fmt::format("expected at most {} names joined by dots", most_joined_names));
        toml::table root;
        try {
            root = toml::parse(text, experiment_.file.string());
        } catch (const toml::parse_error& error) {
            throw InputError(fmt::format("{}:{}", experiment_.file.string(), error.source().begin.line),
                             std::string(error.description()));
        }
        std::vector<std::string_view> known{"title",     "scenes",       "method",
                                            "seeds",     "passes",       "record",
                                            "snapshots", "resolution",   "samples_per_pixel",
                                            "threads",   "decomposition"};
        for (const SettingField& field : setting_fields()) known.push_back(field.name);
        require_known(root, known);

        experiment_.title = root.contains("title") ? string(*root.get("title"), "title") : experiment_.name;
        read_passes(root);
        read_sampling(root);
        read_seeds(root);
        read_scenes(root);
        for (const SettingField& field : setting_fields())
            if (const toml::node* node = root.get(field.name))
                defaults_[std::string(field.name)] = axis(*node, field.name);
        read_methods(root);
        return std::move(experiment_);
    }

private:
    std::string place(const toml::node& node) const {
        return fmt::format("{}:{}", experiment_.file.string(), node.source().begin.line);
    }
    std::string whole_file() const { return experiment_.file.string(); }

    void require_known(const toml::table& table, const std::vector<std::string_view>& known) const {
        for (const auto& [key, node] : table) {
            if (std::find(known.begin(), known.end(), std::string_view(key.str())) != known.end()) continue;
            throw InputError(place(node), unknown_name("key", key.str(), known));
        }
    }

    std::string string(const toml::node& node, std::string_view what) const {
        const auto value = node.value_exact<std::string>();
        if (!value) throw InputError(place(node), fmt::format("{}: expected text in quotes", what));
        if (value->empty()) throw InputError(place(node), fmt::format("{}: expected text, it is empty", what));
        return *value;
    }

    std::int64_t integer(const toml::node& node, std::string_view what, std::int64_t least, std::int64_t most) const {
        const auto value = node.value_exact<std::int64_t>();
        if (!value || *value < least || *value > most)
            throw InputError(place(node), fmt::format("{}: expected a whole number from {} to {}{}", what, least, most,
                                                      value ? fmt::format(", got {}", *value) : ""));
        return *value;
    }

    std::vector<std::uint64_t> integers(const toml::node& node, std::string_view what, std::int64_t least,
                                        std::int64_t most) const {
        const toml::array* array = node.as_array();
        if (!array || array->empty())
            throw InputError(place(node), fmt::format("{}: expected a list of whole numbers", what));
        std::vector<std::uint64_t> values;
        for (const toml::node& item : *array)
            values.push_back(static_cast<std::uint64_t>(integer(item, what, least, most)));
        return values;
    }

    Resolution resolution(const toml::node& node) const {
        const std::vector<std::uint64_t> sides = integers(node, "resolution", 1, largest_image_side);
        if (sides.size() != 2) throw InputError(place(node), "resolution: expected [width, height]");
        return {static_cast<int>(sides[0]), static_cast<int>(sides[1])};
    }

    /// One number or several.
    std::vector<int> samples_per_pixel(const toml::node& node) const {
        constexpr std::string_view name = "samples_per_pixel";
        constexpr std::int64_t most = 1 << 20;
        std::vector<int> samples;
        const auto add = [&](const toml::node& item) {
            samples.push_back(static_cast<int>(integer(item, name, 1, most)));
            at(place(item), [&] { require_perfect_square(samples.back()); });
        };
        if (!node.is_array()) {
            add(node);
            return samples;
        }
        if (node.as_array()->empty())
            throw InputError(place(node), fmt::format("{}: the list of values is empty", name));
        for (const toml::node& item : *node.as_array()) add(item);
        return samples;
    }

    SettingValue value(const toml::node& node, std::string_view what) const {
        if (const auto boolean = node.value_exact<bool>()) return *boolean;
        if (const auto number = node.value_exact<std::int64_t>()) return *number;
        if (const auto number = node.value_exact<double>()) return *number;
        if (const auto text = node.value_exact<std::string>()) return *text;
        throw InputError(place(node), fmt::format("{}: expected a number, a name, or a list of those", what));
    }

    Axis axis(const toml::node& node, std::string_view what) const {
        Axis result{{}, place(node)};
        if (const toml::array* array = node.as_array()) {
            if (array->empty()) throw InputError(place(node), fmt::format("{}: the list of values is empty", what));
            for (const toml::node& item : *array) result.values.push_back(value(item, what));
        } else {
            result.values.push_back(value(node, what));
        }
        return result;
    }

    std::uint64_t passes(const toml::node& node) const {
        return static_cast<std::uint64_t>(integer(node, "passes", 1, most_passes));
    }

    /// The plan of `written` passes, smoke limits applied. Of a list in the file, what lies beyond them is left out.
    PassPlan plan_of(const toml::table& root, std::uint64_t written) const {
        PassPlan plan{smoke_ ? std::min(written, smoke_->passes) : written, {}, {}};
        const auto up_to_last = [&](std::vector<std::uint64_t> list) {
            std::erase_if(list, [&](std::uint64_t pass) { return pass > plan.passes; });
            list.push_back(plan.passes);
            sort_unique(list);
            return list;
        };

        const toml::node* record = root.get("record");
        std::vector<std::uint64_t> recorded = powers_of_two(plan.passes);
        if (record && record->is_string()) {
            const std::string rule = string(*record, "record");
            if (rule == "all") {
                if (plan.passes > most_records)
                    throw InputError(place(*record),
                                     fmt::format("record: all of {} passes are more than {}; name those "
                                                 "that are wanted",
                                                 plan.passes, most_records));
                for (std::uint64_t pass = 1; pass <= plan.passes; ++pass) recorded.push_back(pass);
            } else if (rule != "powers-of-two") {
                throw InputError(place(*record),
                                 unknown_name("record", rule, {"all", "powers-of-two", "a list of passes"}));
            }
        } else if (record) {
            recorded = integers(*record, "record", 0, static_cast<std::int64_t>(most_written_passes_));
        }
        recorded.push_back(0);
        plan.recorded = up_to_last(std::move(recorded));

        const toml::node* snapshots = root.get("snapshots");
        if (snapshots && !(snapshots->is_array() && snapshots->as_array()->empty()))
            plan.snapshots = integers(*snapshots, "snapshots", 0, static_cast<std::int64_t>(most_written_passes_));
        plan.snapshots = up_to_last(std::move(plan.snapshots));
        return plan;
    }

    /// The experiment's passes, and the most that it or a method of its own has.
    void read_passes(const toml::table& root) {
        const toml::node* node = root.get("passes");
        if (!node) throw InputError(whole_file(), "passes is missing: how many passes each run has");
        written_passes_ = most_written_passes_ = passes(*node);
        if (const toml::array* methods = root["method"].as_array())
            for (const toml::node& method : *methods)
                if (const toml::node* own = method.is_table() ? method.as_table()->get("passes") : nullptr)
                    most_written_passes_ = std::max(most_written_passes_, passes(*own));
    }

    void read_sampling(const toml::table& root) {
        experiment_.threads = usable_processors();
        if (const toml::node* node = root.get("threads"))
            experiment_.threads = static_cast<int>(integer(*node, "threads", 1, most_threads));
        if (const toml::node* node = root.get("samples_per_pixel")) samples_per_pixel_ = samples_per_pixel(*node);
        if (const toml::node* node = root.get("resolution")) resolution_ = resolution(*node);
        if (const toml::node* node = root.get("decomposition")) {
            const auto value = node->value_exact<bool>();
            if (!value) throw InputError(place(*node), "decomposition: expected true or false");
            experiment_.decomposition = *value;
        }
    }

    void read_seeds(const toml::table& root) {
        experiment_.seeds = {1};
        if (const toml::node* node = root.get("seeds")) {
            if (node->is_array()) {
                experiment_.seeds = integers(*node, "seeds", 0, std::numeric_limits<std::int64_t>::max());
                const std::set<std::uint64_t> once(experiment_.seeds.begin(), experiment_.seeds.end());
                if (once.size() < experiment_.seeds.size()) throw InputError(place(*node), "seeds: expected each once");
            } else {
                experiment_.seeds.resize(static_cast<std::size_t>(integer(*node, "seeds", 1, most_runs)));
                for (std::size_t i = 0; i < experiment_.seeds.size(); ++i) experiment_.seeds[i] = i + 1;
            }
        }
        if (smoke_ && experiment_.seeds.size() > smoke_->seeds) experiment_.seeds.resize(smoke_->seeds);
    }

    std::filesystem::path path(const toml::node& node, std::string_view what) const {
        const std::string written = string(node, what);
        if (written.find('\0') != written.npos)
            throw InputError(place(node),
                             fmt::format("{}: expected the name of a file, got one with a NUL in it", what));
        std::filesystem::path whole = (experiment_.file.parent_path() / written).lexically_normal();
        try {
            if (is_there(whole)) return whole;
        } catch (const InputError& error) {
            throw InputError(place(node), fmt::format("{}: {}", what, error.what()));
        }
        throw InputError(place(node), fmt::format("{}: {} does not exist", what, whole.string()));
    }

    /// Calls `take(name, whole numbers, place)` for each entry of a table of lists of `count` numbers.
    template <typename Take>
    void read_named_pixels(const toml::table& scene, std::string_view key, std::size_t count, std::string_view expected,
                           const Take& take) const {
        const toml::node* node = scene.get(key);
        if (!node) return;
        const toml::table* table = node->as_table();
        if (!table)
            throw InputError(place(*node), fmt::format("{}: expected a table of names, each {}", key, expected));
        for (const auto& [name, value] : *table) {
            const std::string written(name.str());
            if (written != file_safe(written))
                throw InputError(place(value), fmt::format("{}: \"{}\" is no name for a file", key, written));
            const std::vector<std::uint64_t> numbers = integers(value, written, 0, largest_image_side);
            if (numbers.size() != count)
                throw InputError(place(value), fmt::format("{}: expected {}", written, expected));
            take(written, std::vector<int>(numbers.begin(), numbers.end()), place(value));
        }
    }

    void read_regions(const toml::table& table, SceneEntry& scene) const {
        read_named_pixels(table, "regions", 4, "[left, top, right, bottom]",
                          [&](const std::string& name, const std::vector<int>& edges, const std::string& where) {
                              if (edges[0] >= edges[2] || edges[1] >= edges[3] || name == "image")
                                  throw InputError(
                                      where, name + (name == "image" ? ": is the name of the whole image"
                                                                     : ": expected left < right and top < bottom"));
                              scene.regions.push_back({name, edges[0], edges[1], edges[2], edges[3]});
                          });
    }

    void read_probes(const toml::table& table, SceneEntry& scene) const {
        read_named_pixels(table, "probes", 2, "[x, y]",
                          [&](const std::string& name, const std::vector<int>& pixel, const std::string&) {
                              scene.probes.push_back({name, pixel[0], pixel[1]});
                          });
    }

    void read_scenes(const toml::table& root) {
        const toml::array* scenes = root["scenes"].as_array();
        if (!scenes || scenes->empty())
            throw InputError(root.contains("scenes") ? place(*root.get("scenes")) : whole_file(),
                             "scenes: expected a list of scene files, or of tables with path and reference");
        for (const toml::node& node : *scenes) {
            SceneEntry scene;
            scene.resolution = resolution_;
            std::vector<int> samples = samples_per_pixel_;
            if (const toml::table* table = node.as_table()) {
                require_known(*table,
                              {"path", "reference", "resolution", "samples_per_pixel", "name", "regions", "probes"});
                if (!table->contains("path")) throw InputError(place(node), "scene: path is missing");
                scene.file = path(*table->get("path"), "path");
                if (const toml::node* reference = table->get("reference"))
                    scene.reference = path(*reference, "reference");
                if (const toml::node* pixels = table->get("resolution")) scene.resolution = resolution(*pixels);
                if (const toml::node* own = table->get("samples_per_pixel")) samples = samples_per_pixel(*own);
                read_regions(*table, scene);
                read_probes(*table, scene);
                if (const toml::node* name = table->get("name")) scene.name = file_safe(string(*name, "name"));
            } else {
                scene.file = path(node, "scenes");
            }
            if (is_folder(scene.file))
                throw InputError(place(node), scene.file.string() + " is a folder; expected a scene file in it");
            if (scene.name.empty()) {
                const bool in_folder = scene.file.filename() == "scene.xml";
                const std::filesystem::path named =
                    in_folder ? std::filesystem::absolute(scene.file).parent_path() : scene.file;
                scene.name = file_safe(in_folder ? named.filename().string() : named.stem().string());
            }
            scenes_.push_back({std::move(scene), std::move(samples)});
        }
    }

    void read_methods(const toml::table& root) {
        const toml::array* tables = root["method"].as_array();
        if (!tables || tables->empty() || !tables->is_homogeneous<toml::table>())
            throw InputError(root.contains("method") ? place(*root.get("method")) : whole_file(),
                             "method: expected at least one table [[method]]");
        std::vector<Method> methods;
        for (const toml::node& node : *tables) {
            const toml::table& table = *node.as_table();
            std::vector<std::string_view> known{"name", "passes", "samples_per_pixel"};
            for (const SettingField& field : setting_fields()) known.push_back(field.name);
            require_known(table, known);
            Method method;
            method.place = place(node);
            if (const toml::node* name = table.get("name")) method.name = file_safe(string(*name, "name"));
            const toml::node* own_passes = table.get("passes");
            method.plan = plan_of(root, own_passes ? passes(*own_passes) : written_passes_);
            if (const toml::node* own = table.get("samples_per_pixel")) method.samples = samples_per_pixel(*own);
            for (const SettingField& field : setting_fields())
                if (const toml::node* setting = table.get(field.name))
                    method.axes[std::string(field.name)] = axis(*setting, field.name);
            if (!method.axes.contains("integrator") && !defaults_.contains("integrator"))
                throw InputError(method.place, "method: integrator is missing");
            methods.push_back(std::move(method));
        }
        for (const WrittenScene& scene : scenes_) add_runs_of(scene, methods);
        for (const auto& [name, default_axis] : defaults_)
            if (!used_defaults_.contains(name)) throw InputError(default_axis.place, name + " is used by no method");
    }

    /// One scene of the experiment for each number of sample positions that some method has there.
    void add_runs_of(const WrittenScene& scene, const std::vector<Method>& methods) {
        const auto samples_of = [&](const Method& method) { return method.samples.value_or(scene.samples); };
        std::set<int> counts;
        for (const Method& method : methods)
            for (const int count : samples_of(method)) counts.insert(count);
        for (const int count : counts) {
            experiment_.scenes.push_back(scene.entry);
            experiment_.scenes.back().samples_per_pixel = count;
            for (const Method& method : methods) {
                const std::vector<int> samples = samples_of(method);
                const std::string swept = samples.size() > 1 ? fmt::format("_samples_per_pixel-{}", count) : "";
                for (const int own : samples)
                    if (own == count) add_runs(experiment_.scenes.size() - 1, method, 0, {}, swept);
            }
        }
    }

    /// Adds the runs of `method` that share the settings before field `index`: a walk through the product of its axes.
    /// A field stands after those that decide whether it is used, so that can be asked on the way.
    void add_runs(std::size_t scene, const Method& method, std::size_t index, const ChosenSettings& settings,
                  const std::string& swept) {
        if (index == setting_fields().size()) {
            add_point(scene, method, settings, swept);
            return;
        }
        const SettingField& field = setting_fields()[index];
        const auto own = method.axes.find(field.name);
        const auto common = defaults_.find(field.name);
        const bool is_own = own != method.axes.end();
        if (!is_own && (common == defaults_.end() || !uses_setting(settings.values, field.name))) {
            add_runs(scene, method, index + 1, settings, swept);
            return;
        }
        if (!is_own) used_defaults_.emplace(field.name);
        const Axis& values = is_own ? own->second : common->second;
        for (const SettingValue& value : values.values) {
            ChosenSettings chosen = settings;
            at(values.place, [&] {
                choose(chosen, field, value);
                require_valid(chosen.values);
                require_used(chosen, field);
            });
            const bool varies = values.values.size() > 1;
            const std::string text = plain_text(field.get(chosen.values));
            add_runs(scene, method, index + 1, chosen,
                     varies ? fmt::format("{}_{}-{}", swept, field.name, text) : swept);
        }
    }

    void add_point(std::size_t scene, const Method& method, ChosenSettings settings, const std::string& swept) {
        if (smoke_ && uses_setting(settings.values, "photons_per_pass"))
            settings.values.photons_per_pass = std::min(settings.values.photons_per_pass, smoke_->photons_per_pass);
        const std::string name = method.name.value_or(settings.values.integrator);
        ExperimentPoint point{file_safe(fmt::format("{}_{}{}", experiment_.scenes[scene].name, name, swept)), scene,
                              name, std::move(settings), method.plan};
        const std::vector<std::uint64_t>& seeds = experiment_.seeds;
        const std::string longest = run_name(point, *std::max_element(seeds.begin(), seeds.end()));
        if (longest.size() > longest_file_name)
            throw InputError(method.place,
                             fmt::format("a run is called {}, which has {} letters and can be no file's name: expected "
                                         "at most {}; give the scene and the method short names, or sweep less",
                                         longest, longest.size(), longest_file_name));
        if (!names_.insert(point.name).second)
            throw InputError(method.place, fmt::format("two runs are called {}: give methods and scenes names of their "
                                                       "own, and values once",
                                                       run_name(point, seeds[0])));
        records_ += point.plan.recorded.size() * seeds.size();
        experiment_.points.push_back(std::move(point));
        if (experiment_.run_count() > most_runs)
            throw InputError(method.place, fmt::format("more than {} runs", most_runs));
        if (records_ > most_records)
            throw InputError(method.place,
                             fmt::format("the runs record more than {} passes in all; record fewer", most_records));
    }

    /// Runs `body`; an InputError gets the place in front.
    template <typename Body>
    void at(const std::string& where, const Body& body) const {
        try {
            body();
        } catch (const InputError& error) {
            throw InputError(where, error.what());
        }
    }

    Experiment experiment_;
    std::optional<SmokeLimits> smoke_;
    std::optional<Resolution> resolution_;
    std::vector<int> samples_per_pixel_{1};
    std::vector<WrittenScene> scenes_;
    std::uint64_t records_ = 0;
    std::uint64_t written_passes_ = 1;
    std::uint64_t most_written_passes_ = 1;
    Axes defaults_;
    std::set<std::string, std::less<>> used_defaults_;
    std::set<std::string> names_;
};

}  // namespace

std::vector<ExperimentRun> runs_of(const Experiment& experiment, std::optional<GroupRange> groups) {
    const auto& [first, last] = groups.value_or(GroupRange{1, std::numeric_limits<std::size_t>::max()});
    std::vector<ExperimentRun> runs;
    for (const ExperimentPoint& point : experiment.points) {
        const std::size_t before = point.scene * experiment.seeds.size();  // groups of other scenes
        const std::size_t end = last > before ? std::min(last - before, experiment.seeds.size()) : 0;
        for (std::size_t place = first > before ? first - before - 1 : 0; place < end; ++place) {
            const std::uint64_t seed = experiment.seeds[place];
            runs.push_back({run_name(point, seed), &point, seed, place, before + place + 1});
        }
    }
    return runs;
}

Experiment read_experiment(const std::filesystem::path& file, std::optional<SmokeLimits> smoke) {
    return ExperimentReader(file, smoke).read();
}

std::vector<std::uint64_t> powers_of_two(std::uint64_t passes) {
    std::vector<std::uint64_t> result{0};
    for (std::uint64_t pass = 1; pass <= passes && pass != 0; pass *= 2) result.push_back(pass);
    result.push_back(passes);
    sort_unique(result);
    return result;
}

}  // namespace photonlab
