#include "record/recorder.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <limits>

#include "integrators/registry.h"

namespace photonlab {

namespace {

constexpr std::size_t most_listed_pixels = 16;

}  // namespace

bool photons_carry_direct(const MethodSettings& settings) {
    return uses_setting(settings, "direct") && settings.direct == DirectMode::Photons;
}

double peak_resident_mib() {
    // Not getrusage(): after exec() that still knows the size of what the process was before, Python for instance.
    std::ifstream stream("/proc/self/status");
    double kibibytes = std::numeric_limits<double>::quiet_NaN();
    for (std::string word; stream >> word;)
        if (word == "VmHWM:") stream >> kibibytes;
    return kibibytes / 1024.0;
}

void reset_peak_resident() {
    std::ofstream("/proc/self/clear_refs") << "5";
}

Recorder::Recorder(RunIdentity identity, const Reference* reference, const std::filesystem::path& file)
    : identity_(std::move(identity)), reference_(reference) {
    if (!file.empty()) file_.emplace(file);
}

void Recorder::record(const RunState& state, const Image& image) {
    peak_ = std::max(peak_, peak_resident_mib());
    const bool carried = photons_carry_direct(identity_.settings.method);
    std::string rows = file_ && file_->is_empty() ? csv_header() + "\n" : "";
    for (const std::string& component : components) {
        std::optional<ErrorMetrics> errors;
        if (reference_) errors = judge(image, *reference_, component, carried);
        const std::uint64_t nonfinite = count_nonfinite(state, image, component);
        if (component == total_component) {
            last_total_ = errors;
            nonfinite_count_ += nonfinite;
        }
        Record row{identity_, state, component, errors, nonfinite, peak_};
        if (component == gathered_layer && image.estimated_error) {
            const auto truth = reference_ ? reference_pixels(*reference_, component, carried) : std::nullopt;
            row.estimate = judge_estimate(*image.estimated_error, *image.find(gathered_layer),
                                          truth ? truth->mean : std::vector<ColorD>{});
        }
        rows += csv_row(row) + "\n";
    }
    if (file_) file_->append(rows);
}

void Recorder::exchange(StateArchive& archive) {
    if (file_) file_->exchange(archive);
    archive.exchange(peak_);
    archive.exchange(nonfinite_count_);
    archive.exchange_each(first_nonfinite_, [](StateArchive& each, NonfinitePixel& pixel) {
        each.exchange(pixel.pass);
        each.exchange(pixel.component);
        each.exchange(pixel.x);
        each.exchange(pixel.y);
    });
}

std::uint64_t Recorder::count_nonfinite(const RunState& state, const Image& image, const std::string& component) {
    std::uint64_t count = 0;
    const std::vector<ColorD> pixels = component_pixels(image, component);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        if (is_finite(pixels[i])) continue;
        ++count;
        const auto width = static_cast<std::size_t>(image.width);
        if (first_nonfinite_.size() < most_listed_pixels)
            first_nonfinite_.push_back(
                {count_passes(state.ranges), component, static_cast<int>(i % width), static_cast<int>(i / width)});
    }
    return count;
}

}  // namespace photonlab
