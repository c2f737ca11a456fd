#include "experiment/files.h"

#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>

#include "core/error.h"

namespace photonlab {

namespace {

/// Beside the file, so that the rename stays within one file system, and of this process alone.
std::filesystem::path temporary_name(const std::filesystem::path& file) {
    std::filesystem::path name = file;
    name += ".part-" + std::to_string(::getpid());
    return name;
}

}  // namespace

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
    const std::filesystem::path temporary = temporary_name(file);
    {
        std::ofstream stream(temporary, std::ios::binary | std::ios::trunc);
        stream.write(text.data(), static_cast<std::streamsize>(text.size()));
        stream.close();
        if (!stream) {
            const std::string reason = std::strerror(errno);
            std::error_code ignored;
            std::filesystem::remove(temporary, ignored);
            throw InputError(file.string(), "cannot be written: " + reason);
        }
    }
    std::error_code error;
    std::filesystem::rename(temporary, file, error);
    if (error) {
        std::error_code ignored;
        std::filesystem::remove(temporary, ignored);
        throw InputError(file.string(), "cannot be written: " + error.message());
    }
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
    const std::filesystem::path temporary = temporary_name(file);
    const bool opened = static_cast<bool>(std::ofstream(temporary));
    const std::string reason = std::strerror(errno);
    std::error_code ignored;
    std::filesystem::remove(temporary, ignored);
    if (!opened) throw InputError(file.string(), "cannot be written: " + reason);
}

}  // namespace photonlab
