#include "scene/textures/scale.h"

#include <fmt/format.h>

#include "core/error.h"
#include "scene/mitsuba/plugin.h"
#include "scene/textures/texture.h"

namespace photonlab {

Color Scale::color_at(const Imath::V2f& texture_coordinate) const {
    return nested ? photonlab::color_at(nested->texture, texture_coordinate) * factor : factor;
}

TextureGradient Scale::gradient_at(const Imath::V2f& texture_coordinate) const {
    if (!nested) return {};
    TextureGradient gradient = photonlab::gradient_at(nested->texture, texture_coordinate);
    gradient.by_u *= ColorD(factor);
    gradient.by_v *= ColorD(factor);
    return gradient;
}

Color Scale::largest() const {
    return nested ? largest_color(nested->texture) * factor : factor;
}

Scale Scale::read(Plugin& plugin) {
    Scale scale{.nested = nullptr, .factor = Color(plugin.properties.reflectance("scale").value_or(ColorD(1.0)))};
    if (const auto value = plugin.color("value")) scale.factor *= Color(*value);
    const auto& objects = plugin.properties.objects();
    if (objects.size() + (plugin.properties.has("value") ? 1 : 0) != 1)
        throw InputError(plugin.element.place, "scale: expected one texture, or one colour called value");
    if (objects.empty()) return scale;
    const XmlElement& inner = plugin.source.resolve(*objects.front());
    if (inner.tag != "texture")
        throw InputError(objects.front()->place, fmt::format("scale: expected a texture, got <{}>", inner.tag));
    const SceneSource inside = plugin.source_inside(*objects.front(), "textures");
    scale.nested =
        std::make_shared<const NestedTexture>(NestedTexture{read_texture(inner, inside, TextureUse::Number)});
    return scale;
}

void Scale::check(const std::string& place) const {
    const TextureRange range = range_of(*this);
    if (!(range.least >= 0.0f && range.most <= 1.0f))
        throw InputError(place, fmt::format("scale: expected reflectances in [0, 1], got values from {} to {}",
                                            range.least, range.most));
}

}  // namespace photonlab
