// photonlab compare: every error metric of an image against a reference.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "app/commands.h"
#include "core/error.h"
#include "core/text/messages.h"
#include "core/text/nearest.h"
#include "image/exr.h"
#include "integrators/settings.h"
#include "reference/reference.h"

namespace photonlab {

namespace {

struct CompareOptions {
    std::filesystem::path image;
    std::filesystem::path reference;
    std::string component{total_component};
};

void print(std::string_view name, const std::optional<double>& value) {
    print_output("{:<16} {}\n", name, value ? fmt::format("{}", *value) : "not known: the reference has no halves");
}

void compare_files(const CompareOptions& options) {
    Metadata metadata;
    const Image image = read_exr(options.image, &metadata, options.component);
    const Reference reference = load_reference(options.reference, std::nullopt, options.component);
    if (image.width != reference.half_a.width || image.height != reference.half_a.height)
        throw InputError(options.image.string(),
                         fmt::format("the image is {}x{}, the reference {}x{}", image.width, image.height,
                                     reference.half_a.width, reference.half_a.height));
    if (const auto warning = warning_about(reference)) print_message("photonlab: {}\n", *warning);
    const bool carried = metadata["photonlab.direct"] == name_of(DirectMode::Photons);
    const auto errors = judge(image, reference, options.component, carried);
    if (!errors)
        throw InputError(options.image.string(),
                         fmt::format("--component {}: this image or the reference {} does not have it to compare",
                                     options.component, options.reference.string()));
    for (const Metric& metric : metrics()) print(metric.name, errors->of(metric.name));
    print_output("{:<16} {}\n", "as figures show", describe_rmse(*errors));
    print_output("{:<16} {}\n", "nonfinite", errors->nonfinite);
}

/// A check of CLI11: empty where the name is that of a component.
std::string require_component(const std::string& name) {
    if (std::find(components.begin(), components.end(), name) != components.end()) return "";
    return unknown_name("component", name, {components.begin(), components.end()});
}

}  // namespace

void add_compare_command(CLI::App& app) {
    auto options = std::make_shared<CompareOptions>();
    CLI::App* command = app.add_subcommand("compare", "Print every error metric of an image against a reference");
    command->add_option("IMAGE", options->image, "image to judge (OpenEXR)")->required();
    command->add_option("REFERENCE", options->reference, "folder of a reference, or an EXR")->required();
    command->add_option("--component", options->component, "total, or a layer: emission, direct, gathered [total]")
        ->check(require_component);
    command->footer("Example:\n  photonlab compare box.exr reference/cornell-box");
    command->callback([options] { compare_files(*options); });
}

}  // namespace photonlab
