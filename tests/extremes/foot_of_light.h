// A point light over the middle of a floor, in a scene as large as is wanted around it: irradiance at the foot has a
// closed form at every radius of the disc that estimates it, from far below the light's height to far beyond the floor.

#pragma once

#include "integrators/settings/settings.h"
#include "tests/statistical/scenes.h"

namespace photonlab::test {

/// Lengths in scene units. The scene is a cube of edge 1 around the origin when nothing here is outside of it: two
/// specks in its corners see to that, so the unit box is the scene.
struct FootOfLight {
    double height = 0.25;
    double floor_radius = 0.125;
    double intensity = 3.0;
    double floor_level = -0.25;
    Color reflectance = Color(0.5f, 0.25f, 0.75f);

    /// Seen by one pixel, exactly at the foot. A floor of two triangles instead of a disk is a square around it.
    SceneDescription description(bool of_triangles = false) const {
        SceneDescription scene;
        scene.materials = {diffuse(reflectance), diffuse(Color(0.0f))};
        const VectorD foot(0.0, floor_level, 0.0);
        if (of_triangles)
            scene.shapes = {
                shape(parallelogram(foot - VectorD(floor_radius, 0.0, floor_radius),
                                    VectorD(0.0, 0.0, 2.0 * floor_radius), VectorD(2.0 * floor_radius, 0.0, 0.0)),
                      0)};
        else
            scene.shapes = {disk(foot, VectorD(0, 1, 0), floor_radius, 0)};
        for (const double side : {-0.5, 0.5})
            scene.shapes.push_back(
                shape({.positions = {VectorD(side), VectorD(side * 0.99, side, side), VectorD(side, side * 0.99, side)},
                       .normals = {},
                       .texture_coordinates = {},
                       .triangles = {{0, 1, 2}}},
                      1));
        scene.lights = {point_light(VectorD(0.0, floor_level + height, 0.0), ColorD(intensity))};
        // From the side, below the light, so that nothing is in between.
        scene.camera = look_at(VectorD(0.4, floor_level + 0.1, 0.3), foot);
        return scene;
    }

    /// Expectation of the estimate over a disc of this radius: docs/theory.md, section 5. Beyond the rim of a disk it
    /// is all that the floor gets over the area of the larger disc.
    ColorD radiance(double radius) const {
        const double reached = std::min(radius, floor_radius);
        const double q = std::sqrt(height * height + reached * reached);
        const double irradiance = 2.0 * intensity / (q * (q + height)) * (reached / radius) * (reached / radius);
        return ColorD(reflectance) * (irradiance / pi);
    }

    /// Share of all emitted photons that land in the disc.
    double share_found(double radius) const {
        const double reached = std::min(radius, floor_radius);
        const double q = std::sqrt(height * height + reached * reached);
        return 0.5 * reached * reached / (q * (q + height));
    }
};

}  // namespace photonlab::test
