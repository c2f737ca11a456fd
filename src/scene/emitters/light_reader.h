// <emitter> elements of scene files: what a light's reader is given, and which is called.

#pragma once

#include "scene/emitters/light.h"
#include "scene/mitsuba/plugin.h"

namespace photonlab {

struct LightReader : Plugin {
    using Plugin::Plugin;

    /// What it emits, at least 0 a channel.
    ColorD light(const std::string& name, const ColorD& missing);

    /// The world's directions of the local axes: unit, at right angles, left-handed where mirrored.
    TextureAxes axes();
};

/// A light's position in the unit box. InputError at `place` where it is too far out for that.
Vector place_point(const VectorD& position, const SceneExtent& extent, const std::string& place);

/// The <emitter> of a shape. Throws InputError.
AreaLight::Description read_area_light(const XmlElement& element, const SceneSource& source);

/// A light in the scene itself. Throws InputError.
LightDescription read_scene_light(const XmlElement& element, const SceneSource& source);

}  // namespace photonlab
