// Every way in which radii are chosen: each schedule by ppm and by sppm, and their variants. A new rule is among them,
// in every test that asks for them, by being in the list of schedules. Beside them those that choose photons as well.

#pragma once

#include <string>
#include <vector>

#include "integrators/settings/settings.h"

namespace photonlab::test {

struct NamedMethod {
    std::string name;
    MethodSettings settings;
};

/// `base` by every rule.
inline std::vector<NamedMethod> methods_by_every_radius_rule(const MethodSettings& base) {
    std::vector<NamedMethod> methods;
    for (const std::string integrator : {"ppm", "sppm"})
        for (const auto& [schedule, name] : schedule_names) {
            MethodSettings settings = base;
            settings.integrator = integrator;
            settings.schedule = schedule;
            methods.push_back({integrator + " " + std::string(name), settings});
            settings.kernel = Kernel::Epanechnikov;
            settings.positions = Positions::Box;
            methods.push_back({integrator + " " + std::string(name) + ", other kernel and positions", settings});
        }
    MethodSettings tested = base;
    tested.schedule = ScheduleName::ChiSquare;
    for (const TestVariant variant : {TestVariant::LinearFit, TestVariant::Pooled}) {
        tested.test_variant = variant;
        methods.push_back({"ppm chi-square " + std::string(name_of(variant)), tested});
    }
    tested.start = StartRadius::Nearest;
    for (const std::string integrator : {"ppm", "sppm"}) {
        tested.integrator = integrator;
        methods.push_back({integrator + " chi-square, k-th photon", tested});
    }
    MethodSettings estimated = base;
    estimated.estimate_error = ErrorEstimation::On;
    methods.push_back({"ppm with estimates", estimated});
    return methods;
}

/// `base` with photons of its own.
inline std::vector<NamedMethod> methods_of_own_photons(const MethodSettings& base) {
    std::vector<NamedMethod> methods;
    for (const std::string integrator : {"ppm", "sppm"})
        for (const ScheduleName schedule : {ScheduleName::Hachisuka, ScheduleName::KnausZwicker}) {
            const std::string name = integrator + " " + std::string(name_of(schedule));
            MethodSettings settings = base;
            settings.integrator = integrator;
            settings.schedule = schedule;
            settings.emission = EmissionMode::Adaptive;
            methods.push_back({name + ", adaptive emission", settings});
            settings.emission = EmissionMode::Plain;
            settings.photon_paths = PhotonPathMode::Visible;
            methods.push_back({name + ", visible paths", settings});
            settings.area = AreaMode::Disc;
            methods.push_back({name + ", visible paths, disc", settings});  // ppm's chains keep their states here
        }
    return methods;
}

}  // namespace photonlab::test
