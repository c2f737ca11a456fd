// A method run on a scene for some passes, as the program's runner does it but without clocks, files or records.

#pragma once

#include <functional>
#include <vector>

#include "integrators/registry.h"
#include "transport/camera_pass.h"
#include "transport/photons.h"

namespace photonlab::test {

struct RenderOptions {
    std::uint64_t passes = 1;
    std::uint64_t seed = 1;
    int threads = 1;
    int samples_per_pixel = 1;
    RandomPurpose path_purpose = RandomPurpose::CameraPaths;
    bool estimate_every_pass = false;  ///< ask for the image after every pass, not only after the last
};

struct Rendering {
    Image image;
    IntegratorReport report;
    std::vector<double> radii;  ///< scene units, mean over hit points, before each pass; empty for `path`
};

inline const StageListener no_listener = [](Stage) {};

inline PhotonSettings photon_settings(const MethodSettings& method, std::uint64_t seed) {
    return {.paths = method.photons_per_pass,
            .seed = seed,
            .max_depth = method.max_depth,
            .store_direct = method.direct == DirectMode::Photons};
}

/// An integrator and its photons.
struct MethodWithPhotons {
    std::unique_ptr<Integrator> integrator;
    PhotonSupply photons;

    MethodWithPhotons(const MethodSettings& method, const IntegratorContext& context)
        : integrator(make_integrator(method, context)) {}

    void run_pass(std::uint64_t pass, PhotonPass traced) {
        photons.begin_pass(std::move(traced));
        photons.add_pass();
        photons.index_pass();
        integrator->run_pass(pass, photons, no_listener);
        photons.end_pass();
    }

    Image estimate() {
        photons.index_all_passes();
        return integrator->estimate(photons, no_listener);
    }
};

inline Rendering render(const Scene& scene, const HitPoints& hit_points, const MethodSettings& method,
                        const RenderOptions& options) {
    MethodWithPhotons run(method, {scene, hit_points, options.seed, options.threads, options.path_purpose});
    const bool needs_photons = find_integrator_kind(method.integrator).needs != PhotonNeed::None;
    Rendering result;
    for (std::uint64_t pass = 1; pass <= options.passes; ++pass) {
        if (const auto radius = run.integrator->report().radius_mean) result.radii.push_back(*radius);
        run.run_pass(pass, needs_photons
                               ? trace_photons(scene, photon_settings(method, options.seed), pass, options.threads)
                               : PhotonPass{});
        if (options.estimate_every_pass) result.image = run.estimate();
    }
    if (!options.estimate_every_pass) result.image = run.estimate();
    result.report = run.integrator->report();
    return result;
}

inline Rendering render(const Scene& scene, const MethodSettings& method, const RenderOptions& options) {
    return render(scene, trace_hit_points(scene, options.samples_per_pixel, options.threads), method, options);
}

/// Mean over all pixels of one layer, in double.
inline ColorD mean_of(const Image& image, std::string_view layer) {
    ColorD sum(0.0);
    const std::vector<Color>& pixels = *image.find(layer);
    for (const Color& pixel : pixels) sum += ColorD(pixel);
    return sum / static_cast<double>(pixels.size());
}

inline ColorD mean_total(const Image& image) {
    return mean_of(image, emission_layer) + mean_of(image, direct_layer) + mean_of(image, gathered_layer);
}

/// Mean of f(radius) over the radii of a run.
template <typename Function>
double mean_over(const std::vector<double>& radii, const Function& f) {
    double sum = 0.0;
    for (const double radius : radii) sum += f(radius);
    return sum / static_cast<double>(radii.size());
}

}  // namespace photonlab::test
