#include "scene/mitsuba/xml_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>
#include <pugixml.hpp>
#include <set>

#include "core/error.h"
#include "core/files/files.h"
#include "core/text/number_in.h"
#include "core/text/text.h"

namespace photonlab {

namespace {

constexpr int include_limit = 15;                 // nested files, as in Mitsuba
constexpr int nesting_limit = 100;                // elements inside elements of one file
constexpr std::size_t element_limit = 1'000'000;  // in all files together
constexpr std::size_t file_limit = 1000;          // files read: what includes each other twice doubles at every level
constexpr std::size_t value_limit = 65'536;       // characters, once $names are put in
constexpr std::size_t xml_size_limit = std::size_t{32} << 20;  // of all files together; geometry is in files of its own
constexpr std::uintmax_t size_limit = std::uintmax_t{2} << 30;

/// Offsets at which lines start, to turn pugixml's byte offsets into line numbers.
class LineNumbers {
public:
    explicit LineNumbers(std::string_view text) {
        for (std::size_t i = 0; i < text.size(); ++i)
            if (text[i] == '\n') ends_.push_back(i);
    }
    std::size_t at(std::ptrdiff_t offset) const {
        const auto found =
            std::lower_bound(ends_.begin(), ends_.end(), static_cast<std::size_t>(std::max<std::ptrdiff_t>(0, offset)));
        return static_cast<std::size_t>(found - ends_.begin()) + 1;
    }

private:
    std::vector<std::size_t> ends_;
};

/// "toWorld" to "to_world" and "intIOR" to "int_ior": the names of Mitsuba 0.6 in the spelling of Mitsuba 2 and 3, by
/// Mitsuba 3's own rule: capitals become a word of their own where they follow a small letter.
std::string to_snake_case(std::string_view name) {
    std::string result;
    bool in_capitals = false;
    for (const char c : name) {
        const auto character = static_cast<unsigned char>(c);
        if (!std::isupper(character)) {
            in_capitals = false;
            result += c;
            continue;
        }
        if (!in_capitals && !result.empty() && std::islower(static_cast<unsigned char>(result.back()))) {
            in_capitals = true;
            result += '_';
        }
        result += in_capitals ? static_cast<char>(std::tolower(character)) : c;
    }
    return result;
}

/// The attributes that Mitsuba gives to an element. An attribute that nobody reads is a mistake that would otherwise
/// pass for a default. Elements that are not listed are unknown, which whoever meets them says.
const std::set<std::string>* known_attributes(const std::string& tag) {
    static const std::set<std::string> plugin{"id", "name", "type"};
    static const std::set<std::string> value{"name", "value"};
    static const std::set<std::string> color{"intent", "name", "type", "value"};
    static const std::set<std::string> vector{"name", "value", "x", "y", "z"};
    static const std::set<std::string> step{"value", "x", "y", "z"};
    static const std::set<std::string> look_at{"origin", "target", "up"};
    static const std::map<std::string, std::set<std::string>> others{{"scene", {"id", "name", "version"}},
                                                                     {"transform", {"name"}},
                                                                     {"include", {"filename"}},
                                                                     {"path", {"value"}},
                                                                     {"alias", {"as", "id"}},
                                                                     {"ref", {"id", "name"}},
                                                                     {"matrix", {"value"}},
                                                                     {"rotate", {"angle", "value", "x", "y", "z"}}};
    for (const char* name : {"bsdf", "emitter", "film", "integrator", "medium", "phase", "rfilter", "sampler", "sensor",
                             "shape", "texture"})
        if (tag == name) return &plugin;
    for (const char* name : {"boolean", "default", "float", "integer", "srgb", "string"})
        if (tag == name) return &value;
    // The numbers mean the same whatever their intent or an <rgb>'s type: RGB is what is computed in.
    if (tag == "rgb" || tag == "spectrum") return &color;
    if (tag == "point" || tag == "vector") return &vector;
    if (tag == "translate" || tag == "scale") return &step;
    if (tag == "lookat" || tag == "lookAt" || tag == "look_at") return &look_at;
    const auto found = others.find(tag);
    return found == others.end() ? nullptr : &found->second;
}

/// True for elements that have a place for others inside them.
bool may_have_children(const std::set<std::string>& known, const XmlElement& element) {
    if (element.tag == "rgb") return false;
    if (element.tag == "spectrum") return !element.attribute("type").empty();
    return known.count("type") || element.tag == "scene" || element.tag == "transform";
}

void require_structure(const XmlElement& element, const pugi::xml_node& node) {
    const std::set<std::string>* known = known_attributes(element.tag);
    if (!known) return;
    for (const auto& [name, value] : element.attributes)
        if (!known->count(name))
            throw InputError(element.place, fmt::format("unknown attribute \"{}\" of <{}>; known here: {}", name,
                                                        element.tag, fmt::join(*known, ", ")));
    if (may_have_children(*known, element)) return;
    for (const pugi::xml_node& child : node.children())
        if (child.type() == pugi::node_element)
            throw InputError(element.place, fmt::format("unexpected <{}> inside <{}>", child.name(), element.tag));
}

std::string_view trim(std::string_view text) {
    const auto is_space = [](char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; };
    while (!text.empty() && is_space(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_space(text.back())) text.remove_suffix(1);
    return text;
}

std::ptrdiff_t leading_blanks(std::string_view text) {
    return static_cast<std::ptrdiff_t>(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
}

bool is_name_character(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_';
}

/// By the version of <scene>. Both Mitsubas demand one of three numbers; 0.6 takes files of 0.4 and 0.5 as they are,
/// and older ones only once they are rewritten.
MitsubaFamily family_of(const pugi::xml_node& scene, const std::string& place) {
    const pugi::xml_attribute attribute = scene.attribute("version");
    if (!attribute)
        throw InputError(place,
                         "<scene> needs an attribute \"version\", that of the Mitsuba it is written for: three "
                         "numbers such as 0.6.0 or 3.0.0");
    std::vector<long> numbers;
    for (std::string_view rest = trim(attribute.value());;) {
        const std::size_t dot = rest.find('.');
        numbers.push_back(number_in<long>(rest.substr(0, dot)).value_or(-1));
        if (dot == rest.npos) break;
        rest.remove_prefix(dot + 1);
    }
    if (numbers.size() == 3 && std::min(numbers[1], numbers[2]) >= 0) {
        if (numbers[0] == 0 && numbers[1] >= 4 && numbers[1] <= 6) return MitsubaFamily::Version06;
        if (numbers[0] == 2 || numbers[0] == 3) return MitsubaFamily::Version3;
    }
    throw InputError(place,
                     fmt::format("version: expected 0.4.0 to 0.6.0, or 2 or 3 in three numbers such as 3.0.0, got "
                                 "\"{}\"",
                                 excerpt(attribute.value())));
}

/// What exists of `candidates`, the last where nothing does: whoever reads it says what is wrong with its name.
std::filesystem::path first_existing(const std::vector<std::filesystem::path>& candidates) {
    std::error_code ignored;
    for (const std::filesystem::path& candidate : candidates)
        if (std::filesystem::exists(candidate, ignored)) return candidate;
    return candidates.back();
}

class Reader {
public:
    Reader(const std::map<std::string, std::string>& parameters, BytesRead& bytes_read)
        : parameters_(parameters), bytes_read_(bytes_read), values_(parameters.begin(), parameters.end()) {}

    XmlElement read_file(const std::filesystem::path& file, const std::string& from,
                         std::shared_ptr<const SceneFile> includer) {
        std::error_code ignored;
        const std::filesystem::path canonical = std::filesystem::weakly_canonical(file, ignored);
        if (std::find(open_files_.begin(), open_files_.end(), canonical) != open_files_.end())
            throw InputError(from, fmt::format("\"{}\" includes itself", file.string()));
        if (open_files_.size() >= include_limit)
            throw InputError(from, fmt::format("expected at most {} nested includes", include_limit));
        open_files_.push_back(canonical);

        if (++files_ > file_limit)
            throw InputError(from, fmt::format("expected at most {} files included", file_limit));
        const std::string text = read_whole_file(file, from);
        bytes_read_.add(text);
        if (bytes_read_.size > xml_size_limit)
            throw InputError(from, fmt::format("expected a scene file and what it includes to have at most {} bytes",
                                               xml_size_limit));
        const LineNumbers lines(text);
        const auto place_at = [&](std::ptrdiff_t offset) {
            return fmt::format("{}:{}", file.string(), lines.at(offset));
        };
        if (const std::size_t bad = find_no_text(text); bad != text.npos)
            throw InputError(
                place_at(static_cast<std::ptrdiff_t>(bad)),
                fmt::format("expected UTF-8 text, got byte {:#04x}", static_cast<unsigned char>(text[bad])));
        // As a fragment, so that text and a second root are seen, which would otherwise be dropped without a word.
        pugi::xml_document document;
        const pugi::xml_parse_result parsed = document.load_buffer(
            text.data(), text.size(), pugi::parse_default | pugi::parse_fragment, pugi::encoding_utf8);
        if (!parsed)
            throw InputError(place_at(parsed.offset), fmt::format("not well-formed XML: {}", parsed.description()));
        const pugi::xml_node root = document.document_element();
        if (!root) throw InputError(place_at(0), "expected <scene>, got no element");
        for (const pugi::xml_node& node : document.children())
            if (node != root)
                throw InputError(place_at(node.offset_debug() + leading_blanks(node.value())),
                                 node.type() == pugi::node_element
                                     ? fmt::format("expected one <scene>, got <{}> beside it", excerpt(node.name()))
                                     : fmt::format("unexpected text \"{}\" outside <scene>", excerpt(node.value())));
        if (std::string_view(root.name()) != "scene")
            throw InputError(place_at(root.offset_debug()),
                             fmt::format("expected <scene>, got <{}>", excerpt(root.name())));
        const auto scene_file = std::make_shared<SceneFile>();
        scene_file->folder = file.parent_path();
        scene_file->family = family_of(root, place_at(root.offset_debug()));
        scene_file->includer = std::move(includer);
        XmlElement scene = convert(root, file, scene_file, lines, 1);
        open_files_.pop_back();
        return scene;
    }

    /// Parameters given from outside must be names of the file.
    void require_all_used(const std::filesystem::path& file) const {
        for (const auto& [name, value] : parameters_)
            if (!used_.count(name))
                throw InputError(file.string(), fmt::format("no parameter ${} in this scene", name));
    }

private:
    XmlElement convert(const pugi::xml_node& node, const std::filesystem::path& file,
                       const std::shared_ptr<SceneFile>& scene_file, const LineNumbers& lines, int depth) {
        XmlElement element;
        element.tag = node.name();
        element.place = fmt::format("{}:{}", file.string(), lines.at(node.offset_debug()));
        if (++elements_ > element_limit)
            throw InputError(element.place, fmt::format("expected at most {} elements", element_limit));
        if (depth > nesting_limit)
            throw InputError(element.place,
                             fmt::format("expected at most {} elements inside each other", nesting_limit));
        element.file = scene_file;
        for (const pugi::xml_attribute& attribute : node.attributes()) {
            const std::string name = attribute.name();
            std::string value = replace_names(attribute.value(), element.place);
            if (name == "name" && element.tag != "default") value = to_snake_case(value);
            if (!element.attributes.emplace(name, value).second)
                throw InputError(element.place, fmt::format("attribute \"{}\" stands twice", name));
        }
        require_structure(element, node);
        for (const pugi::xml_node& child : node.children()) {
            if (child.type() == pugi::node_pcdata || child.type() == pugi::node_cdata)
                throw InputError(element.place, fmt::format("unexpected text \"{}\" inside <{}>",
                                                            excerpt(child.value()), element.tag));
            if (child.type() != pugi::node_element) continue;
            XmlElement converted = convert(child, file, scene_file, lines, depth + 1);
            if (converted.tag == "default") {
                const std::string& name = converted.require("name");
                if (!parameters_.count(name)) values_.emplace(name, converted.require("value"));
                used_.insert(name);
            } else if (converted.tag == "include") {
                XmlElement included = read_file(included_file(converted), converted.place, scene_file);
                for (XmlElement& inner : included.children) element.children.push_back(std::move(inner));
            } else if (converted.tag == "path" && depth == 1) {
                if (const auto folder = search_folder(converted)) {
                    scene_file->search_folders.push_back(*folder);
                } else {
                    element.children.push_back(std::move(converted));
                }
            } else {
                element.children.push_back(std::move(converted));
            }
        }
        return element;
    }

    /// The file of an <include>, which Mitsuba 3 looks for beside the file that it stands in first.
    static std::filesystem::path included_file(const XmlElement& element) {
        const std::string& name = element.require("filename");
        const std::filesystem::path called = element.file_called(name);
        if (element.family() == MitsubaFamily::Version06) return called;
        return first_existing({element.file->folder / name, called});
    }

    /// The folder that a <path> adds to those in which files are looked for; empty when it is not there.
    static std::optional<std::filesystem::path> search_folder(const XmlElement& element) {
        const std::string& name = element.require("value");
        const std::filesystem::path folder = first_existing({element.file->folder / name, element.file_called(name)});
        std::error_code ignored;
        if (!std::filesystem::is_directory(folder, ignored)) return std::nullopt;
        return folder;
    }

    /// Puts values in for $names; the longest known name wins, as in Mitsuba.
    std::string replace_names(std::string_view text, const std::string& place) {
        std::string result;
        for (std::size_t i = 0; i < text.size();) {
            if (text[i] != '$') {
                result += text[i++];
                continue;
            }
            std::size_t end = i + 1;
            while (end < text.size() && is_name_character(text[end])) ++end;
            const std::string_view name = text.substr(i + 1, end - i - 1);
            const auto known = longest_known(name);
            if (known == values_.end())
                throw InputError(place,
                                 fmt::format("${} has no <default> before it and no value was given", excerpt(name)));
            if (parameters_.count(known->first)) used_.insert(known->first);
            result += known->second;
            if (result.size() > value_limit) break;
            i += 1 + known->first.size();
        }
        if (result.size() > value_limit)
            throw InputError(place, fmt::format("expected at most {} characters in a value", value_limit));
        return result;
    }

    using Values = std::map<std::string, std::string, std::less<>>;

    /// The longest name with a value that `text` begins with. Names may be long, so it is not tried length by length:
    /// the last name up to `text` in the alphabet begins with every name that `text` begins with.
    Values::const_iterator longest_known(std::string_view text) const {
        while (true) {
            const auto after = values_.upper_bound(text);
            if (after == values_.begin()) return values_.end();
            const auto candidate = std::prev(after);
            const std::string& name = candidate->first;
            const auto differs = std::mismatch(name.begin(), name.end(), text.begin(), text.end());
            if (differs.first == name.end()) return candidate;
            text = text.substr(0, static_cast<std::size_t>(differs.first - name.begin()));
        }
    }

    const std::map<std::string, std::string>& parameters_;
    BytesRead& bytes_read_;
    Values values_;  // of parameters_, and of the <default>s read so far
    std::set<std::string> used_;
    std::vector<std::filesystem::path> open_files_;
    std::size_t elements_ = 0;
    std::size_t files_ = 0;
};

}  // namespace

std::string XmlElement::attribute(std::string_view name) const {
    const auto found = attributes.find(std::string(name));
    return found == attributes.end() ? std::string() : found->second;
}

const std::string& XmlElement::require(std::string_view name) const {
    const auto found = attributes.find(std::string(name));
    if (found == attributes.end()) throw InputError(place, fmt::format("<{}> needs an attribute \"{}\"", tag, name));
    return found->second;
}

std::filesystem::path XmlElement::file_called(const std::string& name) const {
    if (name.empty()) throw InputError(place, fmt::format("<{}>: expected the name of a file, it is empty", tag));
    std::vector<std::filesystem::path> candidates;
    const SceneFile* outermost = file.get();
    for (const SceneFile* from = file.get(); from; from = from->includer.get()) {
        for (auto folder = from->search_folders.rbegin(); folder != from->search_folders.rend(); ++folder)
            candidates.push_back(*folder / name);
        outermost = from;
    }
    candidates.push_back(outermost->folder / name);
    candidates.push_back(file->folder / name);
    // The scene's folder is where a missing file is said to be missing.
    candidates.push_back(outermost->folder / name);
    return first_existing(candidates);
}

XmlElement read_scene_xml(const std::filesystem::path& file, const std::map<std::string, std::string>& parameters,
                          BytesRead& bytes_read) {
    Reader reader(parameters, bytes_read);
    XmlElement scene = reader.read_file(file, file.string(), nullptr);
    reader.require_all_used(file);
    return scene;
}

std::string read_whole_file(const std::filesystem::path& file, const std::string& place) {
    try {
        return read_text_file(file, size_limit);
    } catch (const InputError& error) {
        if (place == file.string()) throw;
        throw InputError(place, error.what());
    }
}

std::string read_part(const std::filesystem::path& file, const std::string& place, BytesRead& bytes_read) {
    std::string bytes = read_whole_file(file, place);
    if (bytes_read.size + bytes.size() > size_limit)
        throw InputError(place,
                         fmt::format("expected a scene and the files that it names to have at most {} bytes, each "
                                     "counted as often as it is named",
                                     size_limit));
    bytes_read.add(bytes);
    return bytes;
}

std::string excerpt(std::string_view text) {
    constexpr std::size_t longest = 60;
    const std::string_view line = trim(trim(text).substr(0, trim(text).find_first_of("\r\n")));
    return std::string(line.substr(0, longest)) + (line.size() > longest ? "..." : "");
}

double parse_number(std::string_view text, const std::string& place) {
    std::string_view digits = trim(text);
    if (!digits.empty() && digits.front() == '+') digits.remove_prefix(1);
    double value = 0.0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
    if (digits.empty() || error == std::errc::invalid_argument || end != digits.data() + digits.size() ||
        (error == std::errc() && !std::isfinite(value)))
        throw InputError(place, fmt::format("expected a finite number, got \"{}\"", excerpt(text)));
    if (error == std::errc::result_out_of_range) {
        // Too small is 0 for every purpose here; too large is not a number to render with.
        const double rough = std::strtod(std::string(digits).c_str(), nullptr);
        if (!std::isfinite(rough))
            throw InputError(place, fmt::format("expected a finite number, got \"{}\"", excerpt(text)));
        return rough;
    }
    return value;
}

long parse_integer(std::string_view text, const std::string& place) {
    const std::optional<long> value = number_in<long>(trim(text));
    if (!value) throw InputError(place, fmt::format("expected a whole number, got \"{}\"", excerpt(text)));
    return *value;
}

bool parse_boolean(std::string_view text, const std::string& place) {
    std::string word(text);
    for (char& c : word) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    if (word == "true") return true;
    if (word == "false") return false;
    throw InputError(place, fmt::format("expected true or false, got \"{}\"", excerpt(text)));
}

std::vector<double> parse_numbers(std::string_view text, const std::string& place) {
    std::vector<double> numbers;
    std::size_t i = 0;
    const auto is_separator = [](char c) { return c == ',' || std::isspace(static_cast<unsigned char>(c)) != 0; };
    while (i < text.size()) {
        while (i < text.size() && is_separator(text[i])) ++i;
        std::size_t end = i;
        while (end < text.size() && !is_separator(text[end])) ++end;
        if (end > i) numbers.push_back(parse_number(text.substr(i, end - i), place));
        i = end;
    }
    return numbers;
}

}  // namespace photonlab
