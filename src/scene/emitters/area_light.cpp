#include "scene/emitters/area_light.h"

#include <fmt/format.h>

#include "core/error.h"
#include "scene/emitters/light_reader.h"

namespace photonlab {

std::optional<DirectSample> AreaLight::sample_direct(const std::vector<Shape>& shapes, const Vector& receiver,
                                                     const Imath::V2f& u, double u_triangle) const {
    const std::optional<SeenPoint> seen = sample_seen(shapes[shape], receiver, u, u_triangle);
    if (!seen) return std::nullopt;
    return DirectSample{.position = seen->position,
                        .direction = seen->direction,
                        .radiance = radiance,
                        .density = seen->density,
                        .is_delta = false};
}

namespace {

/// The texture that is its radiance, or none. Only version 3 has such lights.
std::shared_ptr<const Texture> read_radiance_texture(LightReader& reader) {
    if (reader.is_version_06()) {
        reader.require_no_objects();
        return nullptr;
    }
    SceneSource inside = reader.source;
    inside.emits = true;
    std::shared_ptr<const Texture> texture;
    for (const XmlElement* object : reader.properties.objects()) {
        const XmlElement& plugin = reader.source.resolve(*object);
        if (plugin.tag != "texture" || object->attribute("name") != "radiance")
            throw InputError(object->place, fmt::format("area: expected a texture called radiance, got <{}> \"{}\"",
                                                        plugin.tag, object->attribute("name")));
        if (texture) throw InputError(object->place, "area: expected one radiance, got a second texture");
        if (reader.properties.has("radiance"))
            throw InputError(reader.properties.place_of("radiance"),
                             "area: expected one radiance, got a colour and a texture");
        texture = std::make_shared<const Texture>(read_texture(plugin, inside, TextureUse::Light));
    }
    return texture;
}

}  // namespace

AreaLight::Description AreaLight::read(LightReader& reader) {
    const std::shared_ptr<const Texture> texture = read_radiance_texture(reader);
    return {reader.light("radiance", ColorD(1.0)), texture};
}

}  // namespace photonlab
