#include "experiment/ensemble.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>

#include "core/error.h"
#include "core/files.h"
#include "image/exr.h"

namespace photonlab {

namespace {

constexpr const char* seeds_attribute = "photonlab.seeds";

std::vector<std::uint64_t> read_seeds(const std::filesystem::path& file, const Metadata& metadata) {
    const auto found = metadata.find(seeds_attribute);
    std::vector<std::uint64_t> seeds;
    if (found != metadata.end()) {
        std::istringstream stream(found->second);
        for (std::uint64_t seed = 0; stream >> seed;) seeds.push_back(seed);
    }
    if (seeds.empty())
        throw InputError(file.string(), fmt::format("expected the attribute {}, whole numbers; remove the folder {}",
                                                    seeds_attribute, file.parent_path().string()));
    return seeds;
}

/// One image of all passes: emission, which is the same in all of them, and each pass's other layers under its name.
Image stack(const std::vector<PassImage>& images) {
    const Image& first = images.at(0).image;
    Image all{first.width, first.height, {}};
    all.layers.push_back({std::string(emission_layer), *first.find(emission_layer)});
    for (const PassImage& one : images)
        for (const Layer& layer : one.image.layers)
            if (layer.name != emission_layer)
                all.layers.push_back({fmt::format("pass-{:06}-{}", one.pass, layer.name), layer.pixels});
    return all;
}

}  // namespace

Ensemble::Ensemble(std::filesystem::path folder, std::string key, Json description)
    : folder_(std::move(folder)), key_(std::move(key)), description_(std::move(description)), seeds_(ensemble_slots) {
    description_["schema"] = 1;
    description_["key"] = key_;
    description_["slots"] = ensemble_slots;
    const std::filesystem::path file = folder_ / "ensemble.json";
    if (!std::filesystem::exists(file)) return;
    const Json stored = Json::parse(read_text_file(file), nullptr, false);
    is_described_ = stored.is_object() && stored.contains("key") && stored["key"] == key_;
    if (!is_described_) return;
    for (std::size_t slot = 0; slot < ensemble_slots; ++slot) {
        if (!std::filesystem::exists(slot_file(slot))) continue;
        seeds_[slot] = read_seeds(slot_file(slot), read_exr_metadata(slot_file(slot)));
    }
}

std::filesystem::path Ensemble::slot_file(std::size_t slot) const {
    return folder_ / fmt::format("slot-{:02}.exr", slot);
}

bool Ensemble::contains(std::uint64_t seed) const {
    return std::any_of(seeds_.begin(), seeds_.end(), [&](const std::vector<std::uint64_t>& seeds) {
        return std::find(seeds.begin(), seeds.end(), seed) != seeds.end();
    });
}

void Ensemble::describe() const {
    if (is_described_) write_text_file(folder_ / "ensemble.json", description_.dump(2) + "\n");
}

void Ensemble::add(std::uint64_t seed, const std::vector<PassImage>& images) {
    if (contains(seed)) return;
    if (!is_described_) {
        std::filesystem::remove_all(folder_);
        make_folder(folder_);
    }
    is_described_ = true;
    describe();

    const auto fewest = std::min_element(seeds_.begin(), seeds_.end(),
                                         [](const auto& a, const auto& b) { return a.size() < b.size(); });
    const std::filesystem::path file = slot_file(static_cast<std::size_t>(fewest - seeds_.begin()));
    Image sums = stack(images);
    if (!fewest->empty()) {
        const Image stored = read_exr(file);
        for (Layer& layer : sums.layers) {
            const std::vector<Color>* before = stored.find(layer.name);
            if (!before || stored.layers.size() != sums.layers.size() || before->size() != layer.pixels.size())
                throw InputError(file.string(), fmt::format("expected the sums of other seeds of the same passes; "
                                                            "remove the folder {}",
                                                            folder_.string()));
            for (std::size_t i = 0; i < layer.pixels.size(); ++i) layer.pixels[i] += (*before)[i];
        }
    }
    std::vector<std::uint64_t> seeds = *fewest;
    seeds.push_back(seed);
    write_exr(file, sums, {{seeds_attribute, fmt::format("{}", fmt::join(seeds, " "))}});
    *fewest = std::move(seeds);
}

}  // namespace photonlab
