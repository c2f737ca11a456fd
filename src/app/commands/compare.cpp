// photonlab compare: every error metric of images against a reference, of the whole or of regions.

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>

#include "app/commands/commands.h"
#include "app/options.h"
#include "app/written_files.h"
#include "core/error.h"
#include "core/files/files.h"
#include "core/files/json.h"
#include "core/text/messages.h"
#include "core/text/nearest.h"
#include "core/text/number_in.h"
#include "core/text/text.h"
#include "experiment/file/experiment_file.h"
#include "image/difference.h"
#include "image/exr.h"
#include "integrators/settings/settings.h"
#include "reference/reference.h"

namespace photonlab {

namespace {

struct CompareOptions {
    std::vector<std::filesystem::path> files;  ///< the last is the reference
    std::string component{total_component};
    std::vector<std::string> regions;
    bool as_json = false;
    std::filesystem::path difference;
};

/// The errors of one image in one region.
struct Judged {
    std::filesystem::path file;
    std::string region;
    ErrorMetrics errors;
};

/// A file that is compared, and how its direct light came.
struct ComparedImage {
    std::filesystem::path file;
    Image image;
    bool photons_carry_direct = false;
};

constexpr const char* whole_image = "image";

/// "caustic=10,20,40,50", or the numbers alone, which are then its name.
Region parse_region(const std::string& text) {
    const std::size_t equals = text.find('=');
    Region region{.name = text.substr(0, equals)};
    std::string_view rest = equals == std::string::npos ? text : std::string_view(text).substr(equals + 1);
    int* const edges[] = {&region.left, &region.top, &region.right, &region.bottom};
    for (int* edge : edges) {
        const std::size_t comma = rest.find(',');
        const bool is_last = edge == edges[3];
        const std::optional<int> number = number_in<int>(rest.substr(0, comma));
        if (!number || is_last != (comma == std::string_view::npos))
            throw InputError(fmt::format("--region: expected NAME=LEFT,TOP,RIGHT,BOTTOM in pixels, got \"{}\"", text));
        *edge = *number;
        rest = is_last ? "" : rest.substr(comma + 1);
    }
    return region;
}

std::vector<Region> regions_of(const CompareOptions& options, int width, int height) {
    std::vector<Region> regions;
    for (const std::string& text : options.regions) {
        const Region& region = regions.emplace_back(parse_region(text));
        if (region.left < 0 || region.top < 0 || region.left >= region.right || region.top >= region.bottom ||
            region.right > width || region.bottom > height)
            throw InputError(fmt::format("--region {}: is empty, or not within the image, {}x{}", text, width, height));
    }
    return regions;
}

Image cropped(const Image& image, const Region& region) {
    Image part{.width = region.right - region.left, .height = region.bottom - region.top, .layers = {}};
    for (const Layer& layer : image.layers) {
        Layer& cut = part.layers.emplace_back(Layer{layer.name, {}});
        for (int y = region.top; y < region.bottom; ++y) {
            const auto row = layer.pixels.begin() + std::ptrdiff_t{y} * image.width;
            cut.pixels.insert(cut.pixels.end(), row + region.left, row + region.right);
        }
    }
    return part;
}

ErrorMetrics errors_of(const ComparedImage& compared, const Image& image, const Reference& reference,
                       const std::string& component) {
    const auto errors = judge(image, reference, component, compared.photons_carry_direct);
    if (!errors)
        throw InputError(compared.file.string(),
                         fmt::format("--component {}: this image or the reference {} does not have it to compare",
                                     component, reference.path.string()));
    return *errors;
}

ErrorMetrics errors_in(const ComparedImage& compared, const Region& region, const Reference& reference,
                       const std::string& component) {
    Reference part = reference;
    part.half_a = cropped(reference.half_a, region);
    if (!reference.half_b.layers.empty()) part.half_b = cropped(reference.half_b, region);
    return errors_of(compared, cropped(compared.image, region), part, component);
}

/// Says which picture of a file was taken, where it has several.
void say_what_was_chosen(const std::filesystem::path& file) {
    const std::string chosen = is_folder(file) ? "" : chosen_picture(file);
    if (!chosen.empty())
        print_message("photonlab: {}: has several pictures; {} is compared, what the compositor made of the layers\n",
                      file.string(), chosen);
}

ComparedImage read_image(const std::filesystem::path& file, const Reference& reference, const std::string& component) {
    Metadata metadata;
    ComparedImage compared{file, read_exr(file, &metadata, component), false};
    const Image& image = compared.image;
    if (image.width != reference.half_a.width || image.height != reference.half_a.height)
        throw InputError(file.string(), fmt::format("the image is {}x{}, the reference {}x{}", image.width,
                                                    image.height, reference.half_a.width, reference.half_a.height));
    compared.photons_carry_direct = metadata["photonlab.direct"] == name_of(DirectMode::Photons);
    return compared;
}

/// A line a metric, and a column each image and region; with more than one column their names above.
void print_table(const std::vector<Judged>& judged, bool has_regions) {
    const bool is_single = judged.size() == 1 && !has_regions;
    std::vector<std::vector<std::string>> lines{{""}};
    for (const Metric& metric : metrics()) lines.push_back({std::string(metric.name)});
    for (const char* name : {"as figures show", "nonfinite"}) lines.push_back({name});
    for (const Judged& one : judged) {
        std::size_t line = 0;
        lines[line++].push_back(has_regions ? one.file.string() + " " + one.region : one.file.string());
        for (const Metric& metric : metrics()) {
            const std::optional<double> value = one.errors.of(metric.name);
            lines[line++].push_back(value       ? fmt::format("{}", *value)
                                    : is_single ? "not known: the reference has no halves"
                                                : "not known");
        }
        lines[line++].push_back(describe_rmse(one.errors));
        lines[line++].push_back(fmt::format("{}", one.errors.nonfinite));
    }
    if (is_single) lines.erase(lines.begin());
    std::vector<std::size_t> widths(lines[0].size(), 16);
    for (const auto& line : lines)
        for (std::size_t i = 0; i < line.size(); ++i) widths[i] = std::max(widths[i], line[i].size());
    for (const auto& line : lines) {
        std::string text;
        for (std::size_t i = 0; i < line.size(); ++i)
            text += i + 1 == line.size() ? line[i] : fmt::format("{:<{}} ", line[i], widths[i]);
        print_output("{}\n", text);
    }
}

void print_json(const CompareOptions& options, const std::vector<Judged>& judged) {
    Json rows = Json::array();
    for (const Judged& one : judged) {
        Json row{{"image", printable(one.file.string())}, {"region", printable(one.region)}};
        for (const Metric& metric : metrics()) {
            const std::optional<double> value = one.errors.of(metric.name);
            row[std::string(metric.name)] = value ? Json(*value) : Json(nullptr);
        }
        row["nonfinite"] = one.errors.nonfinite;
        rows.push_back(std::move(row));
    }
    const Json page{{"reference", printable(options.files.back().string())},
                    {"component", options.component},
                    {"errors", std::move(rows)}};
    print_output("{}\n", page.dump(2));
}

void compare_files(const CompareOptions& options) {
    if (options.files.size() < 2) throw InputError("compare: expected IMAGE ... REFERENCE, got one file");
    const Reference reference = load_reference(options.files.back(), std::nullopt, options.component);
    const std::vector<Region> regions = regions_of(options, reference.half_a.width, reference.half_a.height);
    if (const auto warning = warning_about(reference)) print_message("photonlab: {}\n", *warning);
    for (const std::filesystem::path& file : options.files) say_what_was_chosen(file);
    std::vector<Judged> judged;
    std::vector<std::vector<float>> differences;
    for (auto file = options.files.begin(); file + 1 != options.files.end(); ++file) {
        const ComparedImage compared = read_image(*file, reference, options.component);
        judged.push_back({*file, whole_image, errors_of(compared, compared.image, reference, options.component)});
        for (const Region& region : regions)
            judged.push_back({*file, region.name, errors_in(compared, region, reference, options.component)});
        if (!options.difference.empty())
            differences.push_back(
                difference(component_pixels(compared.image, options.component),
                           reference_pixels(reference, options.component, compared.photons_carry_direct)->mean));
    }
    if (options.as_json)
        print_json(options, judged);
    else
        print_table(judged, !regions.empty());
    if (options.difference.empty()) return;
    const double largest = write_difference_picture(options.difference, reference.half_a.width, differences);
    print_message(
        "photonlab: wrote {}: image minus reference, mean over R, G, B, from blue, {:.3g} below, over white to red, "
        "{:.3g} above\n",
        options.difference.string(), largest, largest);
}

/// A check of CLI11: empty where the name is that of a component.
std::string require_component(const std::string& name) {
    if (std::find(components.begin(), components.end(), name) != components.end()) return "";
    return unknown_name("component", name, {components.begin(), components.end()});
}

std::string require_png(const std::string& name) {
    const FileKind* kind = kind_named(name);
    return kind && kind->extension == ".png" ? "" : fmt::format("expected a name that ends in .png, got \"{}\"", name);
}

}  // namespace

void add_compare_command(CLI::App& app) {
    auto options = std::make_shared<CompareOptions>();
    CLI::App* command = app.add_subcommand("compare", "Print every error metric of images against a reference");
    command
        ->add_option("FILES", options->files,
                     "IMAGE ... REFERENCE: images to judge (OpenEXR), and the folder of a reference or an EXR")
        ->required();
    command->add_option("--component", options->component, "total, or a layer: emission, direct, gathered [total]")
        ->check(require_component);
    command
        ->add_option("--region", options->regions,
                     "NAME=LEFT,TOP,RIGHT,BOTTOM in pixels from the top left, looked at beside the whole image; may be "
                     "given more than once")
        ->allow_extra_args(false);
    command->add_flag("--json", options->as_json, "print JSON");
    command
        ->add_option("--difference", options->difference,
                     "picture to write: image minus reference in colours, of several images side by side (PNG)")
        ->check(require_png);
    command->footer(
        "Pictures of other programs are found as R, G, B, as r, g, b, or as Blender's Combined: of several that of "
        "its compositor.\n\n"
        "Example:\n  photonlab compare pm.exr ppm.exr reference/cornell-box --region caustic=60,80,110,110 "
        "--difference difference.png");
    command->callback([options] { compare_files(*options); });
}

}  // namespace photonlab
