#include "scene/textures/texture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "scene/mitsuba/plugin.h"

namespace photonlab {

namespace {

template <typename... Kinds>
std::vector<NamedKind<Plugin, Texture>> kinds_of(const std::variant<Kinds...>*) {
    return {{Kinds::name, read_whole<Kinds, Plugin, Texture>}...};
}

void include(TextureRange& range, const Color& color) {
    for (int channel = 0; channel < 3; ++channel) {
        range.least = std::min(range.least, color[channel]);
        range.most = std::max(range.most, color[channel]);
    }
    range.darkest = std::min(range.darkest, max_channel(color));
    if (!is_finite(color))
        range = {std::nanf(""), std::nanf(""), std::nanf("")};  // which no comparison changes any more
}

constexpr TextureRange nothing{infinity, -infinity, infinity};

TextureRange range_of_kind(const Bitmap& bitmap) {
    TextureRange range = nothing;
    for (const Color& pixel : bitmap.image->pixels) include(range, pixel);
    for (const TextureWrap wrap : {bitmap.wrap_u, bitmap.wrap_v}) {
        if (wrap == TextureWrap::Zero) include(range, Color(0.0f));
        if (wrap == TextureWrap::One) include(range, Color(1.0f));
    }
    return range;
}

TextureRange range_of_kind(const Checkerboard& board) {
    TextureRange range = nothing;
    include(range, board.first);
    include(range, board.second);
    return range;
}

TextureRange range_of_kind(const Scale& scale) {
    const TextureRange inside = scale.nested ? range_of(scale.nested->texture) : TextureRange{1.0f, 1.0f, 1.0f};
    TextureRange range = nothing;
    for (const float value : {inside.least, inside.most}) include(range, scale.factor * value);
    range.darkest = inside.darkest * std::min({scale.factor.x, scale.factor.y, scale.factor.z});
    return range;
}

Matrix scaled(const Matrix& to_uv, double x, double y) {
    Matrix scale;
    scale.setScale(VectorD(x, y, 1.0));
    return to_uv * scale;
}

Matrix to_cells_of_kind(const Bitmap& bitmap) {
    Matrix to_cells = scaled(bitmap.to_uv, bitmap.image->width, bitmap.image->height);
    for (const int axis : {0, 1}) to_cells[3][axis] -= bitmap.is_nearest ? 0.0 : 0.5;
    return to_cells;
}

Matrix to_cells_of_kind(const Checkerboard& board) {
    return scaled(board.to_uv, 2.0, 2.0);
}

Matrix to_cells_of_kind(const Scale& scale) {
    return scale.nested ? to_cells(scale.nested->texture) : scaled(Matrix(), 0.0, 0.0);
}

}  // namespace

Matrix to_cells(const Texture& texture) {
    return std::visit([](const auto& kind) { return to_cells_of_kind(kind); }, texture);
}

TextureRange range_of(const Texture& texture) {
    return std::visit([](const auto& kind) { return range_of_kind(kind); }, texture);
}

void require_factor_on_light(const Texture& texture, const std::string& place, std::string_view what) {
    const TextureRange range = range_of(texture);
    if (!(range.least >= 0.0f))
        throw InputError(place, fmt::format("{}: expected finite values of at least 0, got {}", what, range.least));
}

void require_reflectance(const Texture& texture, const std::string& place) {
    std::visit([&](const auto& kind) { kind.check(place); }, texture);
}

Texture read_texture(const XmlElement& element, const SceneSource& source, TextureUse use) {
    const auto kinds = kinds_of(static_cast<const Texture*>(nullptr));
    const auto& kind = find_kind(kinds, element);
    Plugin plugin(element, source);
    Texture texture = kind.read(plugin);
    if (auto* board = std::get_if<Checkerboard>(&texture); board && use == TextureUse::Share && !plugin.is_version_06())
        std::swap(board->first, board->second);  // so does Mitsuba 3 where a checkerboard is one number
    const std::string& place = plugin.properties.place_of("filename");
    if (use == TextureUse::Reflectance) require_reflectance(texture, place);
    if (use == TextureUse::Light) require_factor_on_light(texture, place, element.attribute("name"));
    return texture;
}

}  // namespace photonlab
