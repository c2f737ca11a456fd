#include "experiment/run_list.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "core/files/files.h"
#include "core/text/progress.h"
#include "record/run/settings_json.h"

namespace photonlab {

namespace {

struct Cost {
    TimeEstimate time;
    double mebibytes = 0.0;
};

/// What each run takes, estimated once a point.
class Costs {
public:
    Costs(const Experiment& experiment, const PreparedExperiment& prepared, const TimeEstimator& estimate)
        : experiment_(experiment), prepared_(prepared), estimate_(estimate) {}

    const Cost& of(const PreparedRun& run) {
        const auto [known, is_new] = costs_.try_emplace(run.run.point);
        if (!is_new) return known->second;
        const std::size_t index = run.run.point->scene;
        const Scene& scene = *prepared_.scenes[index];
        const int samples_per_pixel = experiment_.scenes[index].samples_per_pixel;
        const double cutoff = run.settings.method.branch_cutoff;
        const auto [view, is_view_new] = views_.try_emplace({index, cutoff});
        if (is_view_new) view->second = trace_coarse_view(scene, samples_per_pixel, experiment_.threads, cutoff);
        known->second = {estimate_(scene, view->second, run.settings),
                         estimator_of(run).of({run.settings}, images_kept(run)).total()};
        return known->second;
    }

    /// Mebibytes of runs that share their photons.
    double memory_of(const RunsTogether& together) {
        std::vector<RunSettings> settings;
        std::string points;
        for (const PreparedRun* run : together) {
            settings.push_back(run->settings);
            points += run->run.point->name + "\n";
        }
        const auto [known, is_new] = memory_together_.try_emplace(points);
        if (is_new) known->second = estimator_of(*together[0]).of(settings, images_kept(*together[0])).total();
        return known->second;
    }

private:
    MemoryEstimator& estimator_of(const PreparedRun& run) {
        const std::size_t scene = run.run.point->scene;
        return memory_.try_emplace(scene, *prepared_.scenes[scene], experiment_.scenes[scene].samples_per_pixel)
            .first->second;
    }

    std::size_t images_kept(const PreparedRun& run) const {
        return experiment_.decomposition ? run.run.point->plan.recorded.size() : 0;
    }

    const Experiment& experiment_;
    const PreparedExperiment& prepared_;
    const TimeEstimator& estimate_;
    std::map<const ExperimentPoint*, Cost> costs_;
    std::map<std::size_t, MemoryEstimator> memory_;               // by scene
    std::map<std::string, double> memory_together_;               // by the names of the points
    std::map<std::pair<std::size_t, double>, CoarseView> views_;  // by scene and cutoff
};

/// "64", or "16 to 64"; never of no runs.
std::string passes_text(const std::vector<PreparedRun>& runs) {
    const auto [fewest, most] = std::minmax_element(
        runs.begin(), runs.end(),
        [](const PreparedRun& a, const PreparedRun& b) { return a.settings.passes < b.settings.passes; });
    return fewest->settings.passes == most->settings.passes
               ? fmt::format("{}", most->settings.passes)
               : fmt::format("{} to {}", fewest->settings.passes, most->settings.passes);
}

}  // namespace

std::string list_runs(const Experiment& experiment, const PreparedExperiment& prepared, const TimeEstimator& estimate) {
    std::size_t width = 0;
    for (const PreparedRun& ready : prepared.runs) width = std::max(width, ready.run.name.size());
    std::string list = fmt::format("{}\n\n", experiment.title);
    Costs costs(experiment, prepared, estimate);
    double seconds = 0.0;
    const auto groups = runs_together(prepared.runs);
    std::set<const PreparedRun*> first_of_group;
    for (const auto& group : groups) first_of_group.insert(group[0]);
    for (const PreparedRun& ready : prepared.runs) {
        if (ready.finished) {
            list += fmt::format("{:<{}}  finished\n", ready.run.name, width);
            continue;
        }
        const auto& [time, mebibytes] = costs.of(ready);
        seconds += time.seconds - (first_of_group.contains(&ready) ? 0.0 : time.trace_seconds);
        list += fmt::format("{:<{}}  about {}, up to {:.0f} MiB\n", ready.run.name, width,
                            describe_duration(time.seconds), mebibytes);
    }
    list += fmt::format("\n{} runs of {} passes on {} threads: about {} in all\n", prepared.runs.size(),
                        passes_text(prepared.runs), experiment.threads, describe_duration(seconds));
    if (const auto largest = largest_memory(experiment, prepared, groups))
        list += fmt::format("memory of runs that share photons: {}\n", describe(largest->estimate));
    return list;
}

namespace {

/// What a group still takes.
struct GroupCost {
    std::size_t runs = 0;
    std::size_t unfinished = 0;
    double seconds = 0.0;
    double mebibytes = 0.0;
    const ExperimentRun* any = nullptr;
};

std::map<std::size_t, GroupCost> group_costs(const PreparedExperiment& prepared, Costs& costs) {
    std::map<std::size_t, GroupCost> groups;
    for (const PreparedRun& ready : prepared.runs) {
        GroupCost& group = groups[ready.run.group];
        group.any = &ready.run;
        ++group.runs;
        group.unfinished += !ready.finished;
    }
    for (const RunsTogether& together : runs_together(prepared.runs)) {
        GroupCost& group = groups.at(together[0]->run.group);
        for (const PreparedRun* run : together) {
            const TimeEstimate& time = costs.of(*run).time;
            group.seconds += time.seconds - (run == together[0] ? 0.0 : time.trace_seconds);
        }
        group.mebibytes = std::max(group.mebibytes, costs.memory_of(together));
    }
    return groups;
}

/// What was estimated is known to no more digits than these.
double rounded(double value) {
    return std::round(10.0 * value) / 10.0;
}

std::string one_line(const Json& json) {
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json run_line(const Experiment& experiment, const PreparedRun& ready, Costs& costs) {
    Json settings = settings_json(ready.settings.method);
    for (auto setting = settings.begin(); setting != settings.end();)
        setting = setting->is_null() ? settings.erase(setting) : std::next(setting);
    const bool is_saved = !ready.finished && is_there(ready.files.checkpoint.file);
    const Cost cost = ready.finished ? Cost{} : costs.of(ready);
    return {{"name", ready.run.name},
            {"group", ready.run.group},
            {"scene", experiment.scenes[ready.run.point->scene].name},
            {"method", ready.run.point->method},
            {"settings", settings},
            {"passes", ready.settings.passes},
            {"seed", ready.run.seed},
            {"state", ready.finished ? "finished"
                      : is_saved     ? "saved"
                                     : "unfinished"},
            {"seconds", rounded(cost.time.seconds)},
            {"mebibytes", rounded(cost.mebibytes)}};
}

}  // namespace

std::string list_runs_json(const Experiment& experiment, const PreparedExperiment& prepared,
                           const TimeEstimator& estimate) {
    Costs costs(experiment, prepared, estimate);
    std::vector<std::string> groups;
    for (const auto& [number, group] : group_costs(prepared, costs))
        groups.push_back(one_line({{"group", number},
                                   {"scene", experiment.scenes[group.any->point->scene].name},
                                   {"seed", group.any->seed},
                                   {"runs", group.runs},
                                   {"unfinished", group.unfinished},
                                   {"seconds", rounded(group.seconds)},
                                   {"mebibytes", rounded(group.mebibytes)}}));
    std::vector<std::string> runs;
    for (const PreparedRun& ready : prepared.runs) runs.push_back(one_line(run_line(experiment, ready, costs)));
    std::string head = one_line(
        {{"schema", 1}, {"experiment", experiment.name}, {"title", experiment.title}, {"threads", experiment.threads}});
    head.pop_back();  // "}"
    return fmt::format("{},\n \"groups\": [\n{}],\n \"runs\": [\n{}]}}\n", head, fmt::join(groups, ",\n"),
                       fmt::join(runs, ",\n"));
}

}  // namespace photonlab
