// What the readers of mesh files share: from a file's vertices to the world.

#pragma once

#include <optional>
#include <vector>

#include "scene/shapes/shape_reader.h"

namespace photonlab {

/// Computes the normals that are not there, as Mitsuba does: face normals weighted by the angle at the vertex.
/// [Thuermer & Wuethrich 1998, "Computing Vertex Normals from Polygonal Facets"]
void fill_in_normals(MeshDescription& mesh);

struct MeshPlacing {
    bool face_normals = false;   ///< no normals of vertices
    bool keeps_outside = false;  ///< in 0.6 too, a mesh without normals that to_world mirrors is not turned inside out
    std::optional<double> max_smooth_angle = {};  ///< degrees: normals of vertices are computed, and end at creases
    std::vector<std::uint32_t> groups = {};       ///< of its triangles, which share no vertices then; empty: one
};

/// The angle that 0.6 has for it. Throws InputError together with `face_normals`.
std::optional<double> read_max_smooth_angle(ShapeReader& reader, bool face_normals);

/// Takes the mesh to the world, where normals that the file does not give (none, or 0) are computed, and texture
/// coordinates that it does not give (none, or not a number) made up where its material needs some.
MeshDescription place_mesh(MeshDescription mesh, const ShapeReader& reader, const MeshPlacing& placing);

}  // namespace photonlab
