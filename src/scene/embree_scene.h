// The scene's shapes inside Embree: meshes as its triangles, all others as user geometry that they intersect
// themselves, in double. A geometry's number is its shape's index in Scene::shapes.

#pragma once

#include <string>
#include <vector>

#include "scene/embree.h"
#include "scene/scene.h"

namespace photonlab {

struct EmbreeScene {
    EmbreeScene() = default;
    EmbreeScene(const EmbreeScene&) = delete;
    EmbreeScene& operator=(const EmbreeScene&) = delete;
    ~EmbreeScene();

    RTCScene scene = nullptr;        ///< holds its device
    std::vector<Analytic> analytic;  ///< what user geometries point to; fixed once built
};

/// Hands the shapes to Embree. Throws std::bad_alloc when memory does not suffice, and std::runtime_error when Embree
/// fails otherwise.
std::unique_ptr<EmbreeScene, EmbreeSceneDeleter> build_embree_scene(const std::vector<Shape>& shapes,
                                                                    const std::string& name);

}  // namespace photonlab
