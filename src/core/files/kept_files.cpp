#include "core/files/kept_files.h"

#include <fmt/format.h>

#include <string_view>

#include "core/error.h"
#include "core/files/files.h"
#include "core/hash.h"

namespace photonlab {

namespace {

constexpr std::string_view before_checksum = ",\n  \"checksum\": \"";
constexpr std::string_view after_checksum = "\"\n}\n";

std::string other_size(const std::filesystem::path& file, std::uintmax_t bytes, const FileStamp& stamp) {
    return fmt::format("{}: has {} bytes, and had {} when it was written", file.string(), bytes, stamp.bytes);
}

std::optional<std::string> other_hash(const std::filesystem::path& file, const std::string& hash,
                                      const FileStamp& stamp) {
    if (hash == stamp.hash) return std::nullopt;
    return file.string() + ": is not what was written: its checksum is another";
}

}  // namespace

FileStamp stamp_of(const std::filesystem::path& file) {
    return {size_of_file(file), hash_file(file)};
}

FileStamp stamp_of_text(const std::string& text) {
    return {text.size(), hash_text(text)};
}

Json stamp_json(const FileStamp& stamp) {
    return {{"bytes", stamp.bytes}, {"hash", stamp.hash}};
}

std::optional<FileStamp> stamp_from(const Json& json) {
    if (!json.is_object() || !json.contains("bytes") || !json.contains("hash")) return std::nullopt;
    const Json& bytes = json["bytes"];
    const Json& hash = json["hash"];
    if (!bytes.is_number_unsigned() || !hash.is_string()) return std::nullopt;
    return FileStamp{bytes.get<std::uint64_t>(), hash.get<std::string>()};
}

std::optional<std::string> fault_of(const std::filesystem::path& file, const FileStamp& stamp, Check check) {
    std::error_code reason;
    const std::uintmax_t bytes = std::filesystem::file_size(file, reason);
    if (reason) return fmt::format("{}: {}", file.string(), reason.message());
    if (bytes != stamp.bytes) return other_size(file, bytes, stamp);
    if (check == Check::Sizes || (check == Check::Records && file.extension() != ".csv")) return std::nullopt;
    try {
        return other_hash(file, hash_file(file), stamp);
    } catch (const InputError& error) {
        return error.what();
    }
}

std::optional<std::string> fault_of_text(const std::filesystem::path& file, const std::string& text,
                                         const FileStamp& stamp) {
    if (text.size() != stamp.bytes) return other_size(file, text.size(), stamp);
    return other_hash(file, hash_text(text), stamp);
}

std::string with_checksum(const Json& json) {
    std::string text = json_text(json);
    text.resize(text.size() - 2);  // "\n}"
    const std::string hash = hash_text(text);
    return text + std::string(before_checksum) + hash + std::string(after_checksum);
}

std::optional<Json> checked_json(const std::string& text) {
    const std::size_t end = text.rfind(before_checksum);
    if (end == std::string::npos) return std::nullopt;
    const std::string_view before = std::string_view(text).substr(0, end);
    if (std::string_view(text).substr(end) !=
        std::string(before_checksum) + hash_text(before) + std::string(after_checksum))
        return std::nullopt;
    std::optional<Json> json = parse_sound_json(text);
    if (!json || !json->is_object()) return std::nullopt;
    json->erase("checksum");
    return json;
}

}  // namespace photonlab
