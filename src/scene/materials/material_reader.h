// <bsdf> elements of scene files: what a material's reader is given, and which is called.

#pragma once

#include <set>
#include <string>

#include "scene/materials/material.h"
#include "scene/materials/microfacet.h"
#include "scene/mitsuba/plugin.h"

namespace photonlab {

struct MaterialReader : Plugin {
    MaterialReader(const XmlElement& plugin, const SceneSource& scene) : Plugin(plugin, scene) {}

    Material material;  ///< what read() adds textures and data to

    /// True for a property or a texture of that name.
    bool has(const std::string& name) const { return properties.has(name) || texture_called(name); }

    /// A factor on what a surface reflects or lets through, in [0, 1].
    Color factor(const std::string& name, double missing);

    /// The same, or a texture of that name, which then gives `member`; with `as_number` its brightness alone.
    template <typename Kind>
    Color factor_or_texture(const std::string& name, double missing, Color Kind::*member, bool as_number = false) {
        if (auto texture = find_texture(name, TextureUse::Reflectance)) {
            material.textures.push_back(textured(member, std::move(texture)));
            if (as_number)
                material.textures.back().put = [member](Bsdf& bsdf, const Color& color) {
                    std::get<Kind>(bsdf).*member = Color(luminance(color));
                };
        }
        return factor(name, missing);
    }

    /// A number in [0, 1], or a texture whose brightness then gives `member`.
    template <typename Kind>
    float share_or_texture(const std::string& name, float missing, float Kind::*member) {
        if (auto texture = find_texture(name, TextureUse::Reflectance))
            material.textures.push_back({std::move(texture), [member](Bsdf& bsdf, const Color& color) {
                                             std::get<Kind>(bsdf).*member = luminance(color);
                                         }});
        return static_cast<float>(properties.number(name).value_or(missing));
    }

    /// How rough a surface is: its distribution, and alpha as a number or, where `member` says whose, a texture.
    template <typename Kind>
    Microfacets facets(Microfacets Kind::*member) {
        if (!member) return read_facets();
        if (auto texture = find_texture("alpha", TextureUse::Number))
            material.textures.push_back(
                {std::move(texture), [member, is_mean = is_version_06()](Bsdf& bsdf, const Color& color) {
                     const float alpha = is_mean ? (color.x + color.y + color.z) / 3.0f : luminance(color);
                     (std::get<Kind>(bsdf).*member).alpha = std::max(alpha, smallest_roughness);
                 }});
        return read_facets();
    }

    /// Of smooth materials: what says how rough they are is known to other programs alone.
    void pass_over_roughness();

    /// An index of refraction: a number, or the name of a medium.
    float index(const std::string& name, const std::string& missing);

    /// The materials that nest in it, `count` of them, in their order; `material` keeps them.
    const std::vector<Material>& parts(std::size_t count);

    /// The one texture that nests in it, whatever its name.
    std::shared_ptr<const Texture> only_texture(TextureUse use);

    /// Throws InputError at the first property or nested plugin that nobody asked for.
    void require_all_known();

private:
    const XmlElement* texture_called(const std::string& name) const;
    std::shared_ptr<const Texture> find_texture(const std::string& name, TextureUse use);
    Microfacets read_facets();

    std::set<std::string> textures_asked_;
    std::set<const XmlElement*> objects_read_;
};

/// A kind that changes another material, which nests in it. To add one: a file with such a struct, its name in the list
/// in src/scene/CMakeLists.txt, and a test.
template <typename Kind>
concept MaterialWrapperKind = requires(MaterialReader& reader) {
    { Kind::name } -> std::convertible_to<const char*>;
    { Kind::read(reader) } -> std::same_as<Material>;
};

template <MaterialWrapperKind... Kinds>
using MaterialWrapperOf = std::variant<Kinds...>;

/// The material, without its id. Throws InputError.
Material read_material(const XmlElement& element, const SceneSource& source);

/// A medium by its name in scene files, with its index of refraction at 589 nm.
struct NamedMedium {
    std::string name;
    double index;
};
const std::vector<NamedMedium>& named_media();

}  // namespace photonlab
