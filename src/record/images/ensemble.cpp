#include "record/images/ensemble.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>

#include "core/error.h"
#include "core/files/files.h"
#include "core/files/kept_files.h"
#include "core/text/number_in.h"
#include "image/exr.h"

namespace photonlab {

namespace {

constexpr const char* key_attribute = "photonlab.key";
constexpr const char* seeds_attribute = "photonlab.seeds";
constexpr const char* inexact_attribute = "photonlab.inexact";
constexpr std::string_view rest_suffix = "-rest";

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

/// Adds `value` to sum + rest, of which sum stays the nearest float. False when something was lost.
/// [Knuth 1997, The Art of Computer Programming 2, section 4.2.2, theorem B: what an addition loses]
bool add_exactly(float& sum, float& rest, float value) {
    double lost = 0.0;
    const auto plus = [&](double a, double b) {
        const double both = a + b;
        const double b_of_both = both - a;
        lost += std::abs((a - (both - b_of_both)) + (b - b_of_both));
        return both;
    };
    const double all = plus(plus(sum, rest), value);
    sum = static_cast<float>(all);
    const double left = std::isfinite(sum) ? all - static_cast<double>(sum) : 0.0;
    rest = static_cast<float>(left);
    return lost == 0.0 && static_cast<double>(rest) == left;
}

/// Adds the stored sums to the images of one more seed, and returns of how many additions something was lost.
std::uint64_t add_to(Image& sums, const Image& stored, const std::filesystem::path& file) {
    std::uint64_t inexact = 0;
    std::vector<Layer> rests;  // of one seed there are none yet
    const std::size_t count = sums.layers.size();
    if (stored.layers.size() != count && stored.layers.size() != 2 * count)
        throw InputError(file.string(), "expected the sums of other seeds of the same passes");
    for (Layer& layer : sums.layers) {
        const std::vector<Color>* before = stored.find(layer.name);
        const std::string rest_name = layer.name + std::string(rest_suffix);
        const std::vector<Color>* rest_before = stored.find(rest_name);
        if (!before || before->size() != layer.pixels.size() || (stored.layers.size() > count && !rest_before))
            throw InputError(file.string(), "expected the sums of other seeds of the same passes");
        Layer rest{rest_name, rest_before ? *rest_before : std::vector<Color>(before->size(), Color(0.0f))};
        for (std::size_t i = 0; i < layer.pixels.size(); ++i) {
            const Color value = layer.pixels[i];
            layer.pixels[i] = (*before)[i];
            for (int channel = 0; channel < 3; ++channel)
                inexact += !add_exactly(layer.pixels[i][channel], rest.pixels[i][channel], value[channel]);
        }
        rests.push_back(std::move(rest));
    }
    std::move(rests.begin(), rests.end(), std::back_inserter(sums.layers));
    return inexact;
}

}  // namespace

SlotContent read_slot_content(const std::filesystem::path& file) {
    Metadata metadata = read_sealed_metadata(file);
    SlotContent content{metadata[key_attribute], {}};
    content.inexact = number_in<std::uint64_t>(metadata[inexact_attribute]).value_or(0);
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

void Ensemble::add(std::uint64_t seed, std::size_t place, const std::vector<PassImage>& images) {
    if (contains(seed)) return;
    if (is_of_others_)
        for (std::size_t slot = 0; slot < ensemble_slots; ++slot) remove_if_there(slot_file(slot));
    is_of_others_ = false;
    make_folder(folder_);

    const std::size_t slot = place % ensemble_slots;
    const std::filesystem::path file = slot_file(slot);
    std::vector<std::uint64_t> seeds = slots_[slot];
    Image sums = stack(images);
    std::uint64_t inexact = 0;
    if (!seeds.empty()) {
        try {
            require_seal(file);
        } catch (const InputError& error) {
            throw InputError(fmt::format("{}; remove it, and the runs of its seeds are made again", error.what()));
        }
        inexact = read_slot_content(file).inexact + add_to(sums, read_exr(file), file);
    }
    seeds.insert(std::upper_bound(seeds.begin(), seeds.end(), seed), seed);
    set_slot(slot, seeds);
    describe();
    write_sealed_exr(file, sums,
                     {{key_attribute, key_},
                      {seeds_attribute, fmt::format("{}", fmt::join(seeds, " "))},
                      {inexact_attribute, fmt::format("{}", inexact)}});
}

}  // namespace photonlab
