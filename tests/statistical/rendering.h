// A method run on a scene for some passes, by the program's own loop but without files or records.

#pragma once

#include <functional>
#include <vector>

#include "integrators/registry.h"
#include "render/pass_loop.h"
#include "transport/camera/camera_pass.h"
#include "transport/light/photons.h"

namespace photonlab::test {

struct RenderOptions {
    std::uint64_t passes = 1;
    std::uint64_t seed = 1;
    int threads = 1;
    int samples_per_pixel = 1;
    RandomPurpose path_purpose = RandomPurpose::CameraPaths;
    bool show_every_pass = false;  ///< ask for the image after every pass, not only after the last
};

struct Rendering {
    Image image;
    RunState state;
    IntegratorReport report;
    std::vector<double> radii;  ///< scene units, mean over hit points, before each pass; empty for `path`
};

inline PhotonSettings photon_settings(const MethodSettings& method, std::uint64_t seed) {
    return {.paths = method.photons_per_pass,
            .seed = seed,
            .max_depth = method.max_depth,
            .store_direct = method.direct == DirectMode::Photons};
}

/// A loop of one method.
inline PassLoop loop_of(const MethodSettings& method, const Scene& scene, const HitPoints& hit_points,
                        const RenderOptions& options = {}) {
    return PassLoop(scene, hit_points, {{.method = method, .seed = options.seed, .threads = options.threads}},
                    {.paths = options.path_purpose});
}

inline Rendering render(const Scene& scene, const HitPoints& hit_points, const MethodSettings& method,
                        const RenderOptions& options) {
    PassLoop loop = loop_of(method, scene, hit_points, options);
    Rendering result;
    for (std::uint64_t pass = 1; pass <= options.passes; ++pass) {
        if (const auto radius = loop.state_now(0).report.radius_mean) result.radii.push_back(*radius);
        loop.take(pass);
        if (options.show_every_pass || pass == options.passes) result.image = loop.image();
    }
    result.state = loop.state_now(0);
    result.report = result.state.report;
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
