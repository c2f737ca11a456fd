// <emitter> elements of scene files: what a light's reader is given, and which is called.

#pragma once

#include "scene/emitters/light.h"
#include "scene/mitsuba/plugin.h"

namespace photonlab {

struct LightReader : Plugin {
    using Plugin::Plugin;

    /// What it emits, at least 0 a channel.
    ColorD light(const std::string& name, const ColorD& missing);
};

/// The radiance of an <emitter> in a shape. Throws InputError.
ColorD read_area_light(const XmlElement& element, const SceneSource& source);

/// A light in the scene itself. Throws InputError.
LightDescription read_scene_light(const XmlElement& element, const SceneSource& source);

}  // namespace photonlab
