#include "app/written_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <map>
#include <system_error>

#include "core/error.h"
#include "core/files/files.h"

namespace photonlab {

const FileKind* kind_named(const std::string& name) {
    const auto ends_as = [&](const FileKind& kind) {
        const std::string_view end = kind.extension;
        return name.size() >= end.size() && std::equal(end.rbegin(), end.rend(), name.rbegin(), [](char a, char b) {
                   return a == std::tolower(static_cast<unsigned char>(b));
               });
    };
    const auto* found = std::find_if(std::begin(file_kinds), std::end(file_kinds), ends_as);
    return found == std::end(file_kinds) ? nullptr : found;
}

std::vector<std::filesystem::path> files_of_reference(const std::filesystem::path& reference) {
    if (reference.empty()) return {};
    return {reference, reference / "half_a.exr", reference / "half_b.exr"};
}

namespace {

void require_possible_name(const WrittenFile& written) {
    std::error_code error;
    if (std::filesystem::status(written.file, error).type() == std::filesystem::file_type::none)
        throw InputError(written.file.string(), written.option + ": cannot be written: " + error.message());
}

/// What is written must be what its name says. A device is refused as such, later.
void require_name_of_kind(const WrittenFile& written) {
    const FileKind* named = kind_named(written.file.string());
    if (named == written.kind ||
        (std::filesystem::exists(written.file) && !std::filesystem::is_regular_file(written.file)))
        return;
    std::string message = written.kind ? fmt::format("{}: writes {}: expected a name that ends in {}", written.option,
                                                     written.kind->name, written.kind->extension)
                                       : written.option + ": writes the state of the render: expected another name";
    if (named) message += fmt::format("; {} writes {}", named->option, named->name);
    throw InputError(written.file.string(), message);
}

}  // namespace

void require_sound_outputs(const std::vector<std::filesystem::path>& inputs, const std::vector<WrittenFile>& written) {
    constexpr const char* input = "";  // in place of an option
    std::map<std::filesystem::path, std::string> taken;
    const auto take = [&](const std::filesystem::path& file, const std::string& by) {
        std::error_code unknown;
        const std::filesystem::path canonical = std::filesystem::weakly_canonical(file, unknown);
        return taken.try_emplace(unknown ? file : canonical, by);
    };
    for (const std::filesystem::path& file : inputs) take(file, input);
    for (const WrittenFile& each : written) {
        const auto& [option, file, kind] = each;
        require_possible_name(each);
        if (const auto [at, is_new] = take(file, option); !is_new)
            throw InputError(file.string(),
                             option + ": is " +
                                 (at->second == input ? "read from here" : "written by " + at->second + " already") +
                                 "; choose another file");
        if (kind && std::filesystem::is_regular_file(file)) {
            std::string found(kind->begins.size(), '\0');
            std::ifstream stream(file, std::ios::binary);
            stream.read(found.data(), static_cast<std::streamsize>(found.size()));
            if (stream.gcount() > 0 && found != kind->begins)
                throw InputError(file.string(), option + ": is there already, and is a file of another kind");
        }
        require_name_of_kind(each);
    }
    for (const WrittenFile& each : written) require_writable(each.file);
}

}  // namespace photonlab
