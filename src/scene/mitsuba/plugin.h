// What the reader of a kind is given: a plugin of a scene file, and the file around it. A room's list of kinds is read
// here, too: which of them has the name that the plugin's type says.

#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "scene/mitsuba/properties.h"

namespace photonlab {

struct ColorImage;
struct RoughCoats;

/// What reading a plugin may need from the scene around it.
struct SceneSource {
    /// The element itself, or the one that a <ref> names.
    std::function<const XmlElement&(const XmlElement&)> resolve;
    BytesRead& bytes_read;                         ///< takes the bytes of every file that is read
    std::size_t& image_pixels;                     ///< of all textures and surroundings so far
    std::function<void(const std::string&)> note;  ///< takes what the user should know, a sentence each
    std::map<std::string, std::shared_ptr<const ColorImage>>& images;  ///< of textures, by file and decoding
    std::map<std::array<double, 4>, std::shared_ptr<const RoughCoats>>& rough_coats;  ///< by slopes, least and most
                                                                                      ///< alpha, and index
    int depth = 0;                        ///< of materials or textures inside each other
    std::size_t* nested_count = nullptr;  ///< of all materials inside the outermost one
    bool emits = false;                   ///< textures in it are light, and not reflectances
};

struct Plugin {
    Plugin(const XmlElement& plugin, const SceneSource& scene) : element(plugin), source(scene), properties(plugin) {}

    const XmlElement& element;
    const SceneSource& source;
    Properties properties;

    bool is_version_06() const { return element.family() == MitsubaFamily::Version06; }

    /// The file that its property "filename" names. Throws InputError where there is none.
    std::filesystem::path require_file();

    /// A colour of what it is: of light where the source emits, else a reflectance.
    std::optional<ColorD> color(const std::string& name) {
        return source.emits ? properties.emission(name) : properties.reflectance(name);
    }

    /// Refuses what nests in it. Throws InputError.
    void require_no_objects() const;

    /// The source for the reader of `object`, which nests in it. Throws InputError where too many are inside each
    /// other, or one is inside itself; `kinds` are what they are.
    SceneSource source_inside(const XmlElement& object, std::string_view kinds) const;

    /// Reads past those of the properties `names` that are there, which change nothing here, and notes them.
    void pass_over(const std::vector<std::string>& names, const std::string& why);

    /// Refuses properties that nobody asked for, but for those of other programs that are known to change no image,
    /// which are noted. Throws InputError.
    void require_all_known();
};

/// A kind of a room's list: what scene files call it, and how it is read.
template <typename Reader, typename Result>
struct NamedKind {
    std::string_view name;
    Result (*read)(Reader&);
};

/// A kind, which leaves nothing unread.
template <typename Kind, typename Reader, typename Result>
Result read_whole(Reader& reader) {
    Result result = Kind::read(reader);
    reader.require_all_known();
    return result;
}

/// Throws the InputError for a plugin whose type is none of `known`.
[[noreturn]] void fail_unknown(const XmlElement& element, std::vector<std::string_view> known);

/// The kind that is called what the element's type says.
template <typename Reader, typename Result>
const NamedKind<Reader, Result>& find_kind(const std::vector<NamedKind<Reader, Result>>& kinds,
                                           const XmlElement& element) {
    std::vector<std::string_view> known;
    for (const auto& kind : kinds) {
        if (kind.name == element.require("type")) return kind;
        known.push_back(kind.name);
    }
    fail_unknown(element, std::move(known));
}

}  // namespace photonlab
