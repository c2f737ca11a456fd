// <bsdf> elements of scene files: which kinds there are, and what each is made of.

#pragma once

#include <functional>

#include "scene/material.h"
#include "scene/mitsuba/xml_reader.h"

namespace photonlab {

/// What reading a material may need from the file around it.
struct MaterialSource {
    /// The element itself, or the one that a <ref> names.
    std::function<const XmlElement&(const XmlElement&)> resolve;
    std::string& bytes_read;                       ///< takes the bytes of every file that is read
    std::size_t& texture_pixels;                   ///< of all textures so far
    std::function<void(const std::string&)> note;  ///< takes what the user should know, a sentence each
};

/// The material, without its id. Throws InputError.
Material read_material(const XmlElement& element, const MaterialSource& source);

}  // namespace photonlab
