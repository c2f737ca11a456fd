// <bsdf> elements of scene files: what a material's reader is given, and which is called.

#pragma once

#include <set>
#include <string>

#include "scene/materials/material.h"
#include "scene/mitsuba/plugin.h"

namespace photonlab {

struct MaterialReader : Plugin {
    MaterialReader(const XmlElement& plugin, const SceneSource& scene) : Plugin(plugin, scene) {}

    Material material;  ///< what read() adds textures and data to

    /// True for a property or a texture of that name.
    bool has(const std::string& name) const { return properties.has(name) || texture_called(name); }

    /// A factor on what a surface reflects or lets through, in [0, 1].
    Color factor(const std::string& name, double missing);

    /// The same, or a texture of that name, which then gives `member`.
    template <typename Kind>
    Color factor_or_texture(const std::string& name, double missing, Color Kind::*member) {
        if (auto texture = find_texture(name)) material.textures.push_back(textured(member, std::move(texture)));
        return factor(name, missing);
    }

    /// An index of refraction: a number, or the name of a medium.
    float index(const std::string& name, const std::string& missing);

    /// Throws InputError at the first property or nested plugin that nobody asked for.
    void require_all_known() const;

private:
    const XmlElement* texture_called(const std::string& name) const;
    std::shared_ptr<const Texture> find_texture(const std::string& name);

    std::set<std::string> textures_asked_;
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
