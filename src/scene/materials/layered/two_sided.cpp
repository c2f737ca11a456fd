#include "scene/materials/layered/two_sided.h"

#include <fmt/format.h>

#include "core/error.h"

namespace photonlab {

Material TwoSided::read(MaterialReader& reader) {
    const auto& objects = reader.properties.objects();
    if (objects.empty() || objects.size() > 2)
        throw InputError(reader.element.place,
                         fmt::format("twosided: expected one or two nested bsdfs, got {}", objects.size()));
    for (const XmlElement* object : objects) {
        const XmlElement& inner = reader.source.resolve(*object);
        if (inner.tag != "bsdf" || inner.attribute("type") == name)
            throw InputError(inner.place, fmt::format("twosided: expected a one-sided bsdf, got {} \"{}\"", inner.tag,
                                                      inner.attribute("type")));
    }
    const std::vector<Material>& sides = reader.parts(objects.size());
    for (const Material& side : sides)
        if (is_transmissive(side.bsdf) || side.two_sided)
            throw InputError(side.place,
                             fmt::format("twosided: expected a one-sided bsdf, got bsdf \"{}\"", material_kind(side)));
    Material material = sides.front();
    material.two_sided = true;
    material.is_anisotropic = material.is_anisotropic || sides.back().is_anisotropic;
    if (sides.size() == 2) material.back = std::make_shared<const Material>(sides.back());
    // A side is seen from behind as from the front, and so are its normals.
    material.normals_behind = sides.back().normals;
    if (material.normals_behind) material.normals_behind->is_mirrored = true;
    return material;
}

}  // namespace photonlab
