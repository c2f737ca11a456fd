#include "core/files.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>

#include "core/error.h"
#include "core/temporary_file.h"

namespace photonlab {

std::string read_text_file(const std::filesystem::path& file) {
    std::error_code error;
    if (std::filesystem::is_directory(file, error))
        throw InputError(file.string(), "expected a file, this is a folder");
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw InputError(file.string(), std::string("cannot be read: ") + std::strerror(errno));
    std::ostringstream text;
    text << stream.rdbuf();
    return std::move(text).str();
}

void write_text_file(const std::filesystem::path& file, std::string_view text) {
    TemporaryFile temporary(file);
    std::ofstream stream(temporary.path(), std::ios::binary | std::ios::trunc);
    stream.write(text.data(), static_cast<std::streamsize>(text.size()));
    stream.close();
    if (!stream) throw InputError(file.string(), std::string("cannot be written: ") + std::strerror(errno));
    temporary.rename();
}

void make_folder(const std::filesystem::path& folder) {
    if (folder.empty()) return;
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (!std::filesystem::is_directory(folder))
        throw InputError(folder.string(),
                         "folder cannot be made: " + (error ? error.message() : "a file has this name"));
}

void require_writable(const std::filesystem::path& file) {
    if (std::filesystem::is_directory(file)) throw InputError(file.string(), "expected a file, this is a folder");
    make_folder(file.parent_path());
    const TemporaryFile temporary(file);
    if (!std::ofstream(temporary.path()))
        throw InputError(file.string(), std::string("cannot be written: ") + std::strerror(errno));
}

}  // namespace photonlab
