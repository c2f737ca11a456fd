// <bsdf> elements of scene files: what a material's reader is given, and which is called.

#pragma once

#include <set>
#include <string>

#include "scene/materials/lobes/base_and_lobe.h"
#include "scene/materials/material.h"
#include "scene/materials/rough/microfacet.h"
#include "scene/mitsuba/plugin.h"

namespace photonlab {

/// A colour, or the texture that has it.
struct ColorOrTexture {
    Color color;
    std::shared_ptr<const Texture> texture;  ///< null: `color`

    Color largest() const { return texture ? largest_color(*texture) : color; }
};

struct MaterialReader : Plugin {
    MaterialReader(const XmlElement& plugin, const SceneSource& scene);

    Material material;  ///< what read() adds textures and data to

    /// True for a property or a texture of that name.
    bool has(const std::string& name) const { return properties.has(name) || texture_called(name); }

    /// A factor on what a surface reflects or lets through, in [0, 1].
    Color factor(const std::string& name, double missing);

    /// The same, or a texture of that name, which then gives `member`.
    template <typename Kind>
    Color factor_or_texture(const std::string& name, double missing, Color Kind::*member) {
        if (auto texture = find_texture(name, TextureUse::Reflectance))
            material.textures.push_back(textured(member, std::move(texture)));
        return factor(name, missing);
    }

    /// A reflectance as the file has it, which may be above 1 together with others.
    ColorOrTexture color_or_texture(const std::string& name, double missing);

    /// The diffuse_reflectance of a base and the specular_reflectance of a lobe above it, each a colour or a texture,
    /// which then gives that of `member`.
    template <typename Kind>
    BaseAndLobe base_and_lobe(BaseAndLobe Kind::*member) {
        const ScaledBaseAndLobe given = read_base_and_lobe();
        BaseAndLobe colors;
        const auto put = [&](Color BaseAndLobe::*color, const ColorOrTexture& read) {
            colors.*color = read.color * given.scale;
            if (!read.texture) return;
            material.textures.push_back(
                {read.texture, [member, color, scale = given.scale](Bsdf& bsdf, const Color& found) {
                     std::get<Kind>(bsdf).*member.*color = found * scale;
                 }});
        };
        put(&BaseAndLobe::diffuse_reflectance, given.base);
        put(&BaseAndLobe::specular_reflectance, given.lobe);
        return colors;
    }

    /// Throws InputError where the file forbids to scale what reflects more than it gets.
    void require_may_scale(const std::string& place, const std::string& what, double largest) const;

    /// A number, or a texture that then is `put` into its place as one.
    template <typename Kind>
    float mean_or_texture(const std::string& name, float missing, void (*put)(Kind&, float)) {
        if (auto texture = find_texture(name, TextureUse::Share))
            material.textures.push_back(
                {std::move(texture), [put, is_mean = is_version_06()](Bsdf& bsdf, const Color& c) {
                     put(std::get<Kind>(bsdf), as_number(c, is_mean));
                 }});
        return static_cast<float>(properties.number(name).value_or(missing));
    }

    /// The same, brought into [0, 1].
    template <typename Kind>
    float share_or_texture(const std::string& name, float missing, float Kind::*member) {
        if (auto texture = find_texture(name, TextureUse::Share))
            material.textures.push_back(
                {std::move(texture), [member, is_mean = is_version_06()](Bsdf& bsdf, const Color& color) {
                     std::get<Kind>(bsdf).*member = into_unit_range(as_number(color, is_mean));
                 }});
        return into_unit_range(static_cast<float>(properties.number(name).value_or(missing)));
    }

    /// The same from what may be a colour, of which the brightness counts, into all channels of `member`.
    template <typename Kind>
    Color share_of_color_or_texture(const std::string& name, double missing, Color Kind::*member) {
        if (auto texture = find_texture(name, TextureUse::Share))
            material.textures.push_back({std::move(texture), [member](Bsdf& bsdf, const Color& color) {
                                             std::get<Kind>(bsdf).*member = Color(into_unit_range(luminance(color)));
                                         }});
        const ColorD color = properties.reflectance(name).value_or(ColorD(missing));
        return Color(into_unit_range(static_cast<float>(luminance(color))));
    }

    /// How rough a surface is: its distribution, and alpha, or alpha_u and alpha_v, each a number or a texture, which
    /// then gives those of `member`.
    template <typename Kind>
    Microfacets facets(Microfacets Kind::*member) {
        const auto put_at = [&](const std::string& name, std::vector<float Microfacets::*> alphas) {
            auto texture = find_texture(name, TextureUse::Share);
            if (!texture) return false;
            if (name == "alpha") alpha_texture_ = texture;
            material.textures.push_back(
                {std::move(texture), [member, alphas, is_mean = is_version_06()](Bsdf& bsdf, const Color& color) {
                     for (const auto alpha : alphas)
                         std::get<Kind>(bsdf).*member.*alpha = std::max(as_number(color, is_mean), smallest_roughness);
                 }});
            return true;
        };
        const Microfacets facets = read_facets();
        put_at("alpha", {&Microfacets::alpha_u, &Microfacets::alpha_v});
        const bool is_textured =
            put_at("alpha_u", {&Microfacets::alpha_u}) | put_at("alpha_v", {&Microfacets::alpha_v});
        material.is_anisotropic = is_textured || facets.is_anisotropic();
        return facets;
    }

    /// The least and the most that alpha is anywhere. Throws InputError beyond 4, as Mitsuba 0.6 does.
    Imath::V2f range_of_alpha(const Microfacets& facets) const;

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

    struct ScaledBaseAndLobe {
        ColorOrTexture base;
        ColorOrTexture lobe;
        float scale;  // of both
    };
    ScaledBaseAndLobe read_base_and_lobe();

    /// What a colour is as one number: 0.6 has its mean, 3 its brightness.
    static float as_number(const Color& color, bool is_mean) {
        return is_mean ? (color.x + color.y + color.z) / 3.0f : luminance(color);
    }
    static float into_unit_range(float x) { return std::min(std::max(x, 0.0f), 1.0f); }  // NaN is 0

    bool may_scale_ = true;  // what reflects more than it gets
    std::set<std::string> textures_asked_;
    std::shared_ptr<const Texture> alpha_texture_;
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
