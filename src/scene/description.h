// What a scene file says, before anything is computed from it: shapes, materials, lights and the camera in scene
// units and double precision. The loader makes one from Mitsuba XML, a test writes one directly, and build_scene()
// (scene.h) turns either into a Scene.

#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/math.h"
#include "scene/emitters/light.h"
#include "scene/materials/material.h"
#include "scene/shapes/shape.h"

namespace photonlab {

struct ShapeDescription {
    Geometry geometry;
    std::size_t material = 0;        ///< index into SceneDescription::materials
    std::optional<ColorD> radiance;  ///< of an area light: W/(m^2 sr), emitted to the side of the normal
    std::string place;               ///< "file:line" for messages
    double sampling_weight = 1.0;    ///< of its light, above 0: how often it is chosen for its power
    std::shared_ptr<const Texture> radiance_texture = {};  ///< a factor on `radiance`, or none
};

inline constexpr int largest_image_side = 65536;  ///< pixels, of an image that is rendered

/// A part of the film, in its pixels, from its upper left corner.
struct FilmCrop {
    int x = 0;
    int y = 0;
    int width = 0;
    int height = 0;
};

/// A pinhole camera, or one with a thin lens. Camera space is Mitsuba's: z forward, y up, x to the left of the image.
struct CameraDescription {
    Matrix to_world;               ///< camera space to world, no shear; Imath's row-vector convention
    double fov_x = 45.0;           ///< full horizontal field of view of the film, degrees, in (0, 180)
    double aperture_radius = 0.0;  ///< of the lens; 0: a pinhole
    double focus_distance = 1.0;   ///< from the camera along its view to the plane that is sharp
    int width = 768;               ///< pixels of the film; changing the resolution keeps fov_x as given here
    int height = 576;
    std::optional<FilmCrop> crop;  ///< what of it is rendered, if not all
    std::string place;             ///< "file:line" for messages, or ""
};

struct SceneDescription {
    std::vector<Material> materials;
    std::vector<ShapeDescription> shapes;
    std::vector<LightDescription> lights;  ///< those that no shape bears
    CameraDescription camera;
    int max_depth = -1;              ///< the scene file's own integrator setting; -1 is unlimited
    std::string name;                ///< of the scene's folder, or of the file if that is not scene.xml
    std::string hash;                ///< hexadecimal, of every byte that was read: XML, includes, meshes
    std::vector<std::string> notes;  ///< what was read past, one sentence each
};

}  // namespace photonlab
