#include "scene/textures/uv_transform.h"

namespace photonlab {

Matrix read_uv_transform(Plugin& plugin) {
    Properties& properties = plugin.properties;
    if (!plugin.is_version_06()) return properties.transform("to_uv").value_or(Matrix());
    const double scale = properties.number("uvscale").value_or(1.0);
    Matrix to_uv;
    to_uv.setScale(
        VectorD(properties.number("uscale").value_or(scale), properties.number("vscale").value_or(scale), 1.0));
    to_uv[3][0] = properties.number("uoffset").value_or(0.0);
    to_uv[3][1] = properties.number("voffset").value_or(0.0);
    return to_uv;
}

}  // namespace photonlab
