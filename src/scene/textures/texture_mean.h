// Means of textures over parts of triangles, over which texture coordinates are linear. Every texture is bilinear in
// each cell of a lattice (to_cells() in texture.h), so a polygon is cut along the lattice and each piece integrated
// exactly: a bilinear function has degree 2 in the coordinates of a triangle, and three points inside one integrate
// that. [Strang & Fix 1973, "An Analysis of the Finite Element Method", table 4.1, degree 2]

#pragma once

#include <array>
#include <span>

#include "scene/textures/texture.h"

namespace photonlab {

/// A corner of a polygon on a triangle.
struct TexturedCorner {
    Imath::V2d place;  ///< in any coordinates that are affine on the triangle: areas are those there
    Imath::V2d uv;     ///< texture coordinate, an affine function of `place`
};

/// At most so many cells of the texture's lattice, each `coarseness` times as wide, are cut from the triangle with
/// these texture coordinates by lines inside it.
double cells_inside(const Texture& texture, const std::array<Imath::V2f, 3>& corners, double coarseness);

/// Integrates over convex polygons. With `coarseness` 1 exactly but for rounding; above, cells are as many times as
/// wide, which is faster and misses what is small.
class TextureMean {
public:
    explicit TextureMean(const Texture& texture, double coarseness = 1.0);

    /// Mean by area over the polygon of at most four corners, whose area is above 0.
    ColorD over(std::span<const TexturedCorner> polygon) const;

private:
    const Texture& texture_;
    Matrix to_cells_;
};

}  // namespace photonlab
