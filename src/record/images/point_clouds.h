// Photons and hit points as point clouds that other programs show: binary PLY, positions in scene units. Of more than
// are wanted, a sample that is spread evenly over their order.

#pragma once

#include <cstddef>
#include <string>

#include "scene/scene.h"
#include "transport/camera/camera_pass.h"
#include "transport/light/photons.h"

namespace photonlab {

/// A vertex a photon: where it lies (x, y, z), in which direction it flew (dx, dy, dz, unit), the power that it brought
/// (power_r, power_g, power_b, in the unit of light power, its path's share of all of the pass), whether it came by
/// mirrors and glass alone (caustic, 0 or 1), and the edges of its path. Comments say of how many it is a sample.
std::string photons_as_ply(const Scene& scene, const PhotonPass& pass, std::size_t most);

/// A vertex a hit point: where it lies (x, y, z), the normal there (nx, ny, nz), the pixel that it belongs to (column,
/// row, from the top left), its share of the light of that pixel (weight, mean channel), and the edges to the camera.
std::string hit_points_as_ply(const Scene& scene, const HitPoints& hit_points, std::size_t most);

}  // namespace photonlab
