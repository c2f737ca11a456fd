#include "reference/reference.h"

#include <fmt/format.h>

#include "core/error.h"
#include "core/files/files.h"
#include "core/hash.h"
#include "image/exr.h"
#include "reference/reference_store.h"

namespace photonlab {

namespace {

std::string size_text(int width, int height) {
    return fmt::format("{}x{}", width, height);
}

void require_size(const std::filesystem::path& path, const Image& image, const ReferenceSubject& subject) {
    if (image.width != subject.width || image.height != subject.height)
        throw InputError(path.string(),
                         fmt::format("this reference is {}, the image {}", size_text(image.width, image.height),
                                     size_text(subject.width, subject.height)));
}

ReferenceSubject subject_of(const Json& json) {
    return {json.at("scene").at("hash").get<std::string>(),
            json.at("width").get<int>(),
            json.at("height").get<int>(),
            json.at("samples_per_pixel").get<int>(),
            json.at("max_depth").get<int>(),
            parse_choice<Positions>("positions", json.value("positions", "grid"))};
}

/// Names every difference, with both values.
void require_subject(const std::filesystem::path& folder, const Json& json, const ReferenceSubject& wanted) {
    const ReferenceSubject made = subject_of(json);
    std::string differences;
    const auto compare = [&](std::string_view what, const auto& made_value, const auto& wanted_value) {
        if (made_value == wanted_value) return;
        differences += fmt::format("{}{} is {} in the reference and {} here", differences.empty() ? "" : ", ", what,
                                   made_value, wanted_value);
    };
    compare("the scene's hash", made.scene_hash, wanted.scene_hash);
    compare("the width", made.width, wanted.width);
    compare("the height", made.height, wanted.height);
    if (made.positions == Positions::Grid) {
        compare("samples_per_pixel", made.samples_per_pixel, wanted.samples_per_pixel);
        compare("positions", name_of(made.positions), name_of(wanted.positions));
    }
    compare("max_depth", made.max_depth, wanted.max_depth);
    compare("the version of references", json.at("reference_version").get<int>(), reference_version);
    if (!differences.empty())
        throw InputError(folder.string(), "this is a reference of something else: " + differences);
}

/// Changes with every sample added, as what is judged by it does.
std::string key_with_samples(const Json& json) {
    return fmt::format("{}-{}", json.at("key").get<std::string>(), json.at("samples_per_half").get<std::uint64_t>());
}

}  // namespace

std::string reference_key(const ReferenceSubject& subject) {
    const bool is_grid = subject.positions == Positions::Grid;
    return hash_text(fmt::format(
        "reference {} scene {} width {} height {} {} max_depth {}", reference_version, subject.scene_hash,
        subject.width, subject.height,
        is_grid ? fmt::format("samples_per_pixel {}", subject.samples_per_pixel) : "positions box", subject.max_depth));
}

std::string check_reference(const std::filesystem::path& path, const ReferenceSubject& subject) {
    if (!is_folder(path)) {
        require_size(path, read_exr(path), subject);
        return hash_file(path);
    }
    const Json json = read_reference_json(path);
    require_subject(path, json, subject);
    return key_with_samples(json);
}

Reference load_reference(const std::filesystem::path& path, const std::optional<ReferenceSubject>& subject,
                         const std::string& component) {
    Reference reference;
    reference.path = path;
    if (!is_folder(path)) {
        reference.half_a = read_exr(path, nullptr, component);
        if (subject) require_size(path, reference.half_a, *subject);
        reference.key = hash_file(path);
        return reference;
    }
    const Json json = read_reference_json(path);
    if (subject) require_subject(path, json, *subject);
    reference.key = key_with_samples(json);
    reference.floor_mse = json.at("floor_mse").at("total").get<double>();
    if (json.contains("check"))
        reference.check = {json.at("check").at("verdict").get<std::string>(),
                           json.at("check").at("why").get<std::string>()};
    reference.half_a = read_reference_half(path, json, "half_a");
    reference.half_b = read_reference_half(path, json, "half_b");
    return reference;
}

std::optional<std::string> warning_about(const Reference& reference) {
    if (reference.check.verdict != "disputed") return std::nullopt;
    return fmt::format("the reference {} is disputed: {}", reference.path.string(), reference.check.why);
}

std::vector<ColorD> component_pixels(const Image& image, std::string_view component) {
    if (component == total_component) return total(image);
    const std::vector<Color>* layer = image.find(component);
    if (!layer) return {};
    return {layer->begin(), layer->end()};
}

std::optional<ReferencePixels> reference_pixels(const Reference& reference, std::string_view component,
                                                bool photons_carry_direct) {
    if (photons_carry_direct && component == direct_layer) return std::nullopt;
    const auto of_half = [&](const Image& half) {
        std::vector<ColorD> pixels = component_pixels(half, component);
        if (photons_carry_direct && component == gathered_layer && !pixels.empty()) {
            std::vector<ColorD> direct = component_pixels(half, direct_layer);
            if (direct.empty()) return direct;
            for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] += direct[i];
        }
        return pixels;
    };
    ReferencePixels pixels;
    pixels.mean = of_half(reference.half_a);
    if (pixels.mean.empty()) return std::nullopt;
    if (!reference.half_b.layers.empty()) {
        pixels.half_a = pixels.mean;
        pixels.half_b = of_half(reference.half_b);
        for (std::size_t i = 0; i < pixels.mean.size(); ++i)
            pixels.mean[i] = (pixels.half_a[i] + pixels.half_b[i]) * 0.5;
    }
    return pixels;
}

std::optional<ErrorMetrics> judge(const Image& image, const Reference& reference, std::string_view component,
                                  bool photons_carry_direct) {
    const auto pixels = reference_pixels(reference, component, photons_carry_direct);
    const std::vector<ColorD> judged = component_pixels(image, component);
    if (judged.empty() || !pixels) return std::nullopt;
    try {
        return compare(judged, *pixels);
    } catch (const InputError& error) {
        throw InputError(reference.path.string(), error.what());
    }
}

}  // namespace photonlab
