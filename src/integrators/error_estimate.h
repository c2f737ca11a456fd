// How wrong the gathered light is, said by the passes themselves, without a reference: its bias from the Laplacian of
// the light around each hit point, its noise from how a pixel's value varies from pass to pass.
//
// After i passes a pixel's value is off by the bias B = sum over its hit points of c Delta mean(r_k^2), and by noise of
// variance sum (x_k - mean)^2 / (i (i - 1)), x_k being what the passes gave by themselves. Noise is taken of the pixel:
// its hit points see the same photons, so that theirs do not add up by squares. The estimate of B has a noise of its
// own, (c mean(r_k^2))^2 W / i, which is added.
//
// After Hachisuka, Jarosz & Jensen 2010, "A Progressive Error Estimation Framework for Photon Density Estimation". Ours
// are the curvature kernel (gather/moments.h) in place of derivatives of a smooth kernel, and the noise by pixels.

#pragma once

#include <cmath>
#include <vector>

#include "core/files/state_archive.h"
#include "gather/radii/adaptive_radius.h"
#include "image/image.h"
#include "integrators/integrator.h"

namespace photonlab {

/// Of a method whose regions are hit points, or pixels. All values are means of the three channels.
class ErrorEstimate {
public:
    ErrorEstimate(std::size_t pixels, std::size_t regions) : regions_(regions), pixels_(pixels) {}

    /// A region's part of a pass, with the squared radius that it used; on any thread.
    void take_region(std::size_t region, const Curvature& curvature, double squared_radius, std::uint64_t passes) {
        Region& at = regions_[region];
        at.curvature.take(curvature, squared_radius, passes);
        at.mean_squared_radius += (squared_radius - at.mean_squared_radius) / static_cast<double>(passes);
    }

    /// What a pass by itself gave to a pixel.
    void take_pixel(std::size_t pixel, double value, std::uint64_t passes) {
        Pixel& at = pixels_[pixel];
        const double before = value - at.mean;
        at.mean += before / static_cast<double>(passes);
        at.squares += before * (value - at.mean);
    }

    /// The estimates of the image: `add_to_pixels(add)` calls `add(pixel, region, weight)` for every region that
    /// belongs to a pixel, with the weight of its light there; `scale` makes it radiance.
    template <typename AddToPixels>
    EstimatedError of_image(const AddToPixels& add_to_pixels, Kernel kernel, double scale, std::uint64_t passes) const {
        EstimatedError error{.passes = passes,
                             .bias = std::vector<float>(pixels_.size()),
                             .deviation = std::vector<float>(pixels_.size())};
        const double count = static_cast<double>(passes);
        std::vector<double> bias(pixels_.size(), 0.0);
        std::vector<double> variance(pixels_.size(), 0.0);
        add_to_pixels([&](std::size_t pixel, std::size_t region, const ColorD& weight) {
            const Region& at = regions_[region];
            const double share = bias_constant(kernel) * at.mean_squared_radius;
            bias[pixel] += mean_channel(at.curvature.laplacian * weight) * share;
            const double noise = share * mean_channel(weight);
            variance[pixel] += noise * noise * at.curvature.noise / (3.0 * count);  // W is a sum over three channels
        });
        for (std::size_t pixel = 0; pixel < pixels_.size(); ++pixel) {
            if (passes > 1) variance[pixel] += pixels_[pixel].squares / (count * (count - 1.0));
            error.bias[pixel] = static_cast<float>(bias[pixel] * scale);
            error.deviation[pixel] = static_cast<float>(std::sqrt(variance[pixel]) * scale);
        }
        return error;
    }

    void exchange(StateArchive& archive) {
        archive.exchange_as_many(regions_);
        archive.exchange_as_many(pixels_);
    }
    std::uint64_t bytes() const { return regions_.size() * sizeof(Region) + pixels_.size() * sizeof(Pixel); }

private:
    struct Region {
        CurvatureStatistics curvature;
        double mean_squared_radius = 0.0;
    };
    /// Of the passes' own values, mean channel. [Welford 1962]
    struct Pixel {
        double mean = 0.0;
        double squares = 0.0;  // sum of squared differences from the mean
    };

    std::vector<Region> regions_;
    std::vector<Pixel> pixels_;
};

}  // namespace photonlab
