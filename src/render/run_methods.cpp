#include "render/run_methods.h"

#include <algorithm>

namespace photonlab {

namespace {

/// Methods that took the pass here, or that are still before the first; what was restored has shown its image already.
std::vector<std::size_t> methods_at(const PassLoop& loop, const std::vector<std::uint64_t>& first_shown,
                                    std::uint64_t pass) {
    std::vector<std::size_t> methods;
    for (std::size_t i = 0; i < loop.method_count(); ++i)
        if (loop.state(i).pass == pass && pass >= first_shown[i]) methods.push_back(i);
    return methods;
}

}  // namespace

std::vector<RunState> run_methods(const Scene& scene, const HitPoints& hit_points,
                                  const std::vector<RunSettings>& settings, const ImageListener& on_image,
                                  const PassListener& on_pass, const GatherListener& on_gather,
                                  const Continuation& continuation) {
    PassLoop loop(scene, hit_points, settings);
    std::vector<StateExchange> states;
    std::vector<std::uint64_t> first_shown;
    for (std::size_t i = 0; i < settings.size(); ++i) {
        states.push_back([&loop, i](StateArchive& archive) { loop.exchange(i, archive); });
        if (continuation.restore) continuation.restore(i, states[i]);
        first_shown.push_back(loop.state(i).pass == 0 ? 0 : loop.state(i).pass + 1);
    }

    const auto tell = [&](std::uint64_t pass, std::size_t method, Needs::Photons gathered) {
        if (loop.needs(method).photons == gathered) on_gather(method, pass, loop.integrator(method));
    };
    const auto is_shown = [&](std::uint64_t pass) {
        return std::binary_search(settings[0].shown.begin(), settings[0].shown.end(), pass);
    };
    const auto show_images = [&](const std::vector<std::size_t>& methods, std::uint64_t pass) {
        loop.show(methods, [&](std::size_t method, const Image& image) {
            tell(pass, method, Needs::Photons::OfAllPasses);
            on_image(method, loop.state(method), image);
        });
    };

    if (is_shown(0) && settings[0].first_pass == 1) show_images(methods_at(loop, first_shown, 0), 0);
    for (std::uint64_t pass = settings[0].first_pass; pass <= settings[0].passes; ++pass) {
        loop.take(pass);
        const std::vector<std::size_t> methods = methods_at(loop, first_shown, pass);
        for (const std::size_t method : methods) tell(pass, method, Needs::Photons::OfPass);
        const bool is_last =
            !methods.empty() && continuation.is_good_enough && continuation.is_good_enough(pass, loop.image());
        if (is_last || is_shown(pass)) show_images(methods, pass);
        on_pass(pass, !methods.empty());
        if (is_last || (continuation.goes_on && !continuation.goes_on(pass, states))) break;
    }

    std::vector<RunState> last;
    for (std::size_t i = 0; i < settings.size(); ++i) last.push_back(loop.state_now(i));
    return last;
}

}  // namespace photonlab
