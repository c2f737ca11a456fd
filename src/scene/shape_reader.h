// <shape> elements of scene files: which kinds there are, and the geometry of each, in the world.

#pragma once

#include <functional>
#include <string>

#include "scene/description.h"
#include "scene/mitsuba/properties.h"

namespace photonlab {

/// What reading a shape may need from the file around it.
struct ShapeSource {
    bool has_bsdf;                                 ///< in its element
    bool has_texture;                              ///< in its material, which then needs texture coordinates
    std::string& bytes_read;                       ///< takes the bytes of every file that is read
    std::function<void(const std::string&)> note;  ///< takes what the user should know, a sentence each
};

/// The geometry of a <shape>, whose properties these are. Throws InputError.
Geometry read_geometry(const XmlElement& element, Properties& properties, const ShapeSource& source);

}  // namespace photonlab
