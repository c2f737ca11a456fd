#include "image/image.h"

#include <cassert>

namespace photonlab {

const std::vector<Color>* Image::find(std::string_view name) const {
    for (const Layer& layer : layers)
        if (layer.name == name) return &layer.pixels;
    return nullptr;
}

std::vector<ColorD> total(const Image& image) {
    std::vector<ColorD> sum(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height),
                            ColorD(0.0));
    for (const Layer& layer : image.layers) {
        assert(layer.pixels.size() == sum.size());
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += ColorD(layer.pixels[i]);
    }
    return sum;
}

}  // namespace photonlab
