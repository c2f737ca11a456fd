// What takes a surface's texture coordinates to those of a texture.

#pragma once

#include "scene/mitsuba/plugin.h"

namespace photonlab {

/// to_uv of Mitsuba 3, or the scales and offsets that 0.6 has in its place.
Matrix read_uv_transform(Plugin& plugin);

}  // namespace photonlab
