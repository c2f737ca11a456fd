#include "scene/materials/layered/bump_map.h"

#include <fmt/format.h>

#include "core/error.h"

namespace photonlab {

namespace {

/// Two things that Mitsuba 3 does by default are left out: each makes f one thing for light and another for the view,
/// and photons and paths from the camera would disagree.
void note_what_grazing_light_does(MaterialReader& reader) {
    if (reader.is_version_06()) return;
    const bool is_flipped = reader.properties.boolean("flip_invalid_normals").value_or(true);
    const bool is_shadowed = reader.properties.boolean("use_shadowing_function").value_or(true);
    if (is_flipped || is_shadowed)
        reader.source.note(fmt::format(
            "bsdf \"{}\": rendered without flip_invalid_normals and use_shadowing_function, which Mitsuba 3 "
            "has by default and which change what is seen or lit at grazing angles",
            reader.element.attribute("type")));
}

}  // namespace

Material read_with_normals(MaterialReader& reader, NormalTexture normals) {
    Material material = reader.parts(1).front();
    if (has_turned_normals(material))
        throw InputError(reader.element.place,
                         fmt::format("{}: expected a material whose normals no other texture turns",
                                     reader.element.attribute("type")));
    note_what_grazing_light_does(reader);
    material.normals_behind = normals;
    material.normals = std::move(normals);
    return material;
}

Material BumpMap::read(MaterialReader& reader) {
    const double scale = reader.is_version_06() ? 1.0 : reader.properties.number("scale").value_or(1.0);
    return read_with_normals(reader, {reader.only_texture(TextureUse::Height), true, scale});
}

}  // namespace photonlab
