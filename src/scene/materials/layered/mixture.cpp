#include "scene/materials/layered/mixture.h"

#include <fmt/format.h>

#include <numeric>

#include "core/error.h"

namespace photonlab {

namespace {

/// The two as one material, which keeps them.
Material blend_of(const Material& first, const Material& second, double share_of_second) {
    const auto kept = std::make_shared<const std::vector<Material>>(std::vector<Material>{first, second});
    Blend blend;
    blend.first.material = &(*kept)[0];
    blend.second.material = &(*kept)[1];
    blend.weight = static_cast<float>(share_of_second);
    Material result{.id = "mixture", .bsdf = blend};
    result.data = kept;
    remember_part(result, first);
    remember_part(result, second);
    return result;
}

}  // namespace

Material Mixture::read(MaterialReader& reader) {
    const std::string text = reader.properties.text("weights").value_or("");
    std::vector<double> weights = parse_numbers(text, reader.properties.place_of("weights"));
    if (weights.empty() || *std::min_element(weights.begin(), weights.end()) < 0.0)
        throw InputError(reader.properties.place_of("weights"),
                         fmt::format("mixturebsdf: expected weights of at least 0, got \"{}\"", text));
    std::vector<Material> parts = reader.parts(weights.size());
    double rest = std::accumulate(weights.begin(), weights.end(), 0.0);
    if (!(rest > 0.0 && std::isfinite(rest)))
        throw InputError(reader.properties.place_of("weights"),
                         fmt::format("mixturebsdf: expected weights that add up to more than 0, got \"{}\"", text));
    if (rest > 1.0) {
        reader.require_may_scale(reader.properties.place_of("weights"), "the sum of the weights is", rest);
        reader.source.note(fmt::format("{}: weights that add up to {:g} are scaled", reader.element.place, rest));
        for (double& weight : weights) weight /= rest;
    }
    weights.push_back(std::max(0.0, 1.0 - rest));
    parts.push_back({.id = "black", .bsdf = Diffuse{Color(0.0f)}, .two_sided = true});
    Material result = parts.back();
    rest = weights.back();
    for (std::size_t i = weights.size() - 1; i-- > 0;) {
        const double all = weights[i] + rest;
        result = blend_of(parts[i], result, all > 0.0 ? rest / all : 0.0);
        rest = all;
    }
    return result;
}

}  // namespace photonlab
