// An image of linear radiance, as named layers of equal size whose sum is the picture.

#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/math.h"

namespace photonlab {

struct Layer {
    std::string name;
    std::vector<Color> pixels;  ///< row by row from the top: pixels[y * width + x]
};

/// What a method says of the error of its layer "gathered", without a reference: mean channel, a value a pixel.
struct EstimatedError {
    std::uint64_t passes = 0;      ///< that it was made of: their number less one are its degrees of freedom
    std::vector<float> bias;       ///< expectation of image minus truth
    std::vector<float> deviation;  ///< standard deviation of image minus bias; 0 after one pass, which knows none
};

struct Image {
    int width = 0;
    int height = 0;
    std::vector<Layer> layers;
    // No layers: beside the picture.
    std::optional<EstimatedError> estimated_error = std::nullopt;
    std::vector<float> radius = {};   ///< scene units, a value a pixel, 0 where nothing is gathered; or empty
    std::vector<float> count = {};    ///< photons, likewise; where it was asked for
    std::vector<float> density = {};  ///< photons a squared scene unit, likewise

    /// The layer's pixels; nullptr when there is none of that name.
    const std::vector<Color>* find(std::string_view name) const;
};

/// Names of the three layers of every estimator.
inline constexpr std::string_view emission_layer = "emission";
inline constexpr std::string_view direct_layer = "direct";
inline constexpr std::string_view gathered_layer = "gathered";

/// Sum of all layers, in double.
std::vector<ColorD> total(const Image& image);

}  // namespace photonlab
