#include "record/ensemble.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <sstream>

#include "core/error.h"
#include "core/files/files.h"
#include "core/files/kept_files.h"
#include "image/exr.h"

namespace photonlab {

namespace {

constexpr const char* key_attribute = "photonlab.key";
constexpr const char* seeds_attribute = "photonlab.seeds";

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

SlotContent read_slot_content(const std::filesystem::path& file) {
    Metadata metadata = read_sealed_metadata(file);
    SlotContent content{metadata[key_attribute], {}};
    std::istringstream stream(metadata[seeds_attribute]);
    for (std::uint64_t seed = 0; stream >> seed;) content.seeds.push_back(seed);
    if (content.key.empty() || content.seeds.empty() || !stream.eof())
        throw InputError(file.string(), fmt::format("expected the attributes {}, and {}, whole numbers", key_attribute,
                                                    seeds_attribute));
    return content;
}

Ensemble::Ensemble(std::filesystem::path folder, std::string key, Json description)
    : folder_(std::move(folder)), key_(std::move(key)), description_(std::move(description)), slots_(ensemble_slots) {
    description_["schema"] = 2;
    description_["key"] = key_;
    description_["slots"] = ensemble_slots;
    for (std::size_t slot = 0; slot < ensemble_slots; ++slot) {
        if (!is_there(slot_file(slot))) continue;
        try {
            SlotContent content = read_slot_content(slot_file(slot));
            if (content.key == key_) {
                set_slot(slot, std::move(content.seeds));
            } else {
                require_seal(slot_file(slot));  // a key that is damaged says nothing of the other slots
                is_of_others_ = true;
            }
        } catch (const InputError& error) {
            faults_.push_back(error.what());
        }
    }
    if (!is_of_others_) return;
    for (std::size_t slot = 0; slot < ensemble_slots; ++slot) set_slot(slot, {});
    faults_.clear();
}

std::filesystem::path Ensemble::slot_file(std::size_t slot) const {
    return folder_ / fmt::format("slot-{:02}.exr", slot);
}

void Ensemble::set_slot(std::size_t slot, std::vector<std::uint64_t> seeds) {
    slots_[slot] = std::move(seeds);
    seeds_.clear();
    for (const auto& own : slots_) seeds_.insert(own.begin(), own.end());
}

void Ensemble::check_slots() {
    for (std::size_t slot = 0; slot < ensemble_slots; ++slot) {
        if (slots_[slot].empty()) continue;
        try {
            require_seal(slot_file(slot));
        } catch (const InputError& error) {
            faults_.push_back(error.what());
            set_slot(slot, {});
        }
    }
}

void Ensemble::describe() const {
    if (seeds_.empty()) return;
    const std::filesystem::path file = folder_ / "ensemble.json";
    const std::string text = with_checksum(description_);
    if (read_if_there(file) != text) write_text_file(file, text);
}

void Ensemble::add(std::uint64_t seed, const std::vector<PassImage>& images) {
    if (contains(seed)) return;
    if (is_of_others_)
        for (std::size_t slot = 0; slot < ensemble_slots; ++slot) remove_if_there(slot_file(slot));
    is_of_others_ = false;
    make_folder(folder_);

    const auto fewest = std::min_element(slots_.begin(), slots_.end(),
                                         [](const auto& a, const auto& b) { return a.size() < b.size(); });
    const auto slot = static_cast<std::size_t>(fewest - slots_.begin());
    const std::filesystem::path file = slot_file(slot);
    std::vector<std::uint64_t> seeds = *fewest;
    Image sums = stack(images);
    if (!seeds.empty()) {
        try {
            require_seal(file);
        } catch (const InputError& error) {
            throw InputError(fmt::format("{}; remove it, and the runs of its seeds are made again", error.what()));
        }
        const Image stored = read_exr(file);
        for (Layer& layer : sums.layers) {
            const std::vector<Color>* before = stored.find(layer.name);
            if (!before || stored.layers.size() != sums.layers.size() || before->size() != layer.pixels.size())
                throw InputError(file.string(), "expected the sums of other seeds of the same passes");
            for (std::size_t i = 0; i < layer.pixels.size(); ++i) layer.pixels[i] += (*before)[i];
        }
    }
    seeds.push_back(seed);
    set_slot(slot, seeds);
    describe();
    write_sealed_exr(file, sums, {{key_attribute, key_}, {seeds_attribute, fmt::format("{}", fmt::join(seeds, " "))}});
}

}  // namespace photonlab
