// How bright a texture is on the parts of a shape, so that light begins where it comes from: as many photons would
// start on the black of a textured light as on its white, and carry nothing.
//
// The square of random numbers by which a point is drawn uniform in area is cut into n x n parts, on a mesh that of
// each triangle, and a part is drawn by its area times the mean of the texture on it. Any probability is unbiased that
// is above 0 where the texture is, as what is drawn is divided by it. Means are exact on triangles (texture_mean.h),
// unless they span more than four million texels; elsewhere they are those of a million points spread evenly. Where
// they are not exact, what seems to be black is drawn a little all the same.

#pragma once

#include <vector>

#include "scene/shapes/shape.h"
#include "scene/textures/texture.h"

namespace photonlab {

class BrightParts {
public:
    BrightParts(const Shape& shape, const Texture& texture);

    /// Of the texture over the shape. A channel is 0 only where the texture's is 0 all over it.
    const ColorD& mean() const { return mean_; }

    /// A point of the shape, drawn by brightness.
    struct Draw {
        SurfacePoint point;
        Imath::V2f texture_coordinate;
        double weight;  ///< density of points uniform in area, in units of the one that it was drawn with
    };
    Draw draw(const Shape& shape, const Imath::V2f& u, double u_part) const;

private:
    void measure(const TriangleMesh& mesh, const Texture& texture);
    template <AnalyticKind Kind>
    void measure(const Kind& shape, const Texture& texture);
    void add(double area, const ColorD& mean);
    void set_density(const Color& largest);

    std::size_t per_side_ = 1;  // n
    bool is_exact_ = true;
    ColorD mean_ = ColorD(0.0);
    std::vector<double> cdf_;     // running sum of the parts' probabilities, the last is 1; triangle by triangle
    std::vector<double> weight_;  // share of the area over probability
};

}  // namespace photonlab
