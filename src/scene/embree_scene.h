// The scene's shapes inside Embree: meshes as its triangles, spheres and disks as user geometry that is intersected
// here, in double. A geometry's number is its shape's index in Scene::shapes.

#pragma once

#include <vector>

#include "scene/embree.h"
#include "scene/scene.h"

namespace photonlab {

struct EmbreeScene {
    EmbreeScene() = default;
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;
    ~EmbreeScene();

    RTCDevice device = nullptr;
    RTCScene scene = nullptr;
    std::vector<std::variant<Sphere, Disk>> analytic;  ///< what user geometries point to; fixed once built
};

/// Hands the shapes to Embree. Throws std::runtime_error when Embree fails (it is out of memory).
std::unique_ptr<EmbreeScene, EmbreeSceneDeleter> build_embree_scene(const std::vector<Shape>& shapes);

}  // namespace photonlab
