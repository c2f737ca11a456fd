// The properties of one plugin in a scene file, asked for by name and type. What was never asked for is unknown, and an
// error that lists what would have been: no default is ever silent.

#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <variant>
#include <vector>

#include "core/math.h"
#include "scene/mitsuba/xml_reader.h"

namespace photonlab {

class Properties {
public:
    /// Takes the element's properties; nested plugins and references are left in objects().
    explicit Properties(const XmlElement& plugin);

    std::optional<double> number(const std::string& name);
    std::optional<long> integer(const std::string& name);
    std::optional<bool> boolean(const std::string& name);
    std::optional<std::string> text(const std::string& name);
    std::optional<std::variant<double, std::string>> number_or_text(const std::string& name);
    /// Linear RGB, from rgb, srgb, spectrum or float; what a spectrum is depends on whether it reflects, emits or
    /// refracts, and on the file's family.
    std::optional<ColorD> reflectance(const std::string& name);
    std::optional<ColorD> emission(const std::string& name);
    std::optional<ColorD> index_of_refraction(const std::string& name);
    std::optional<VectorD> vector(const std::string& name);
    std::optional<Matrix> transform(const std::string& name);

    bool has(const std::string& name) const { return properties_.count(name) > 0; }

    /// True when there is one of that name, which then counts as known, but is not among what is said to be known.
    bool pass_over(const std::string& name) { return properties_.erase(name) > 0; }

    MitsubaFamily family() const { return plugin_.family(); }

    /// Nested plugins and references, in their order.
    const std::vector<const XmlElement*>& objects() const { return objects_; }

    /// Throws InputError at the first property that nobody asked for.
    void require_all_known() const;

    /// Names of all properties that nobody asked for.
    std::vector<std::string> unknown() const;

    /// The line of the property called `name`, or the plugin's where there is none.
    const std::string& place_of(const std::string& name) const;

private:
    const XmlElement* take(const std::string& name, const std::set<std::string>& tags);

    const XmlElement& plugin_;
    std::map<std::string, const XmlElement*> properties_;
    std::vector<const XmlElement*> objects_;
    std::set<std::string> asked_;
};

}  // namespace photonlab
