#include "image/difference.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "image/png.h"
#include "image/read_image.h"

namespace photonlab {

namespace {

/// The value that 99% of those that differ are within; 0 where none does.
double largest_of(const std::vector<float>& values) {
    std::vector<double> sizes;
    for (const float value : values)
        if (std::isfinite(value) && value != 0.0f) sizes.push_back(std::abs(value));
    if (sizes.empty()) return 0.0;
    const auto place = sizes.begin() + static_cast<std::ptrdiff_t>(0.99 * static_cast<double>(sizes.size() - 1));
    std::nth_element(sizes.begin(), place, sizes.end());
    return *place;
}

/// From blue at -1 over white to red at 1, as a colour on the screen, in linear light.
ColorD color_of(double value) {
    const ColorD end = value < 0.0 ? ColorD(0.13, 0.40, 0.67) : ColorD(0.70, 0.09, 0.17);
    const double share = std::min(std::abs(value), 1.0);
    ColorD color;
    for (int i = 0; i < 3; ++i) color[i] = srgb_to_linear(0.97 + share * (end[i] - 0.97));
    return color;
}

}  // namespace

std::vector<float> difference(const std::vector<ColorD>& image, const std::vector<ColorD>& reference) {
    std::vector<float> values(image.size());
    for (std::size_t i = 0; i < image.size(); ++i) {
        const ColorD error = image[i] - reference[i];
        values[i] = static_cast<float>((error.x + error.y + error.z) / 3.0);
    }
    return values;
}

double write_difference_picture(const std::filesystem::path& file, int width,
                                const std::vector<std::vector<float>>& differences) {
    double largest = 0.0;
    for (const auto& values : differences) largest = std::max(largest, largest_of(values));
    if (largest == 0.0) largest = 1.0;
    const auto columns = static_cast<std::size_t>(width);
    const std::size_t height = differences[0].size() / columns;
    std::vector<ColorD> pixels;
    for (std::size_t y = 0; y < height; ++y)
        for (const auto& values : differences)
            for (std::size_t x = 0; x < columns; ++x) {
                const float value = values[y * columns + x];
                pixels.push_back(std::isfinite(value) ? color_of(value / largest)
                                                      : ColorD(std::numeric_limits<double>::quiet_NaN()));
            }
    write_png(file, width * static_cast<int>(differences.size()), static_cast<int>(height), pixels);
    return largest;
}

}  // namespace photonlab
