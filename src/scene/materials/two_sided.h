// A material that looks from behind as from the front.

#pragma once

#include <fmt/format.h>

#include "core/error.h"
#include "scene/materials/material_reader.h"

namespace photonlab {

struct TwoSided {
    static constexpr const char* name = "twosided";

    static Material read(MaterialReader& reader) {
        const auto& objects = reader.properties.objects();
        if (objects.size() != 1)
            throw InputError(reader.element.place,
                             fmt::format("twosided: expected one nested bsdf, got {}", objects.size()));
        const XmlElement& inner = reader.source.resolve(*objects.front());
        const auto fail = [&] {
            throw InputError(inner.place, fmt::format("twosided: expected a one-sided bsdf, got {} \"{}\"", inner.tag,
                                                      inner.attribute("type")));
        };
        if (inner.tag != "bsdf" || inner.attribute("type") == name) fail();
        Material material = read_material(inner, reader.source);
        if (is_transmissive(material.bsdf)) fail();
        material.two_sided = true;
        return material;
    }
};

}  // namespace photonlab
