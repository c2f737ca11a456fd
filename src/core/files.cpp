#include "core/files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <sstream>
#include <system_error>

#include "core/descriptor.h"
#include "core/error.h"
#include "core/temporary_file.h"

namespace photonlab {

void require_ordinary_file(const std::filesystem::path& file) {
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(file, error);
    if (std::filesystem::is_directory(status)) throw InputError(file.string(), "expected a file, this is a folder");
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
        throw InputError(file.string(), "expected a file, this is a pipe or a device");
    if (error) throw InputError(file.string(), "cannot be read: " + error.message());
    if (!std::ifstream(file, std::ios::binary))
        throw InputError(file.string(), std::string("cannot be read: ") + std::strerror(errno));
}

std::string read_text_file(const std::filesystem::path& file, std::uintmax_t largest) {
    require_ordinary_file(file);
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    if (!error && size > largest)
        throw InputError(file.string(),
                         "expected at most " + std::to_string(largest) + " bytes, got " + std::to_string(size));
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    if (stream.bad() || !stream.is_open()) throw InputError(file.string(), "cannot be read to its end");
    return std::move(text).str();
}

void write_text_file(const std::filesystem::path& file, std::string_view text) {
    TemporaryFile temporary(file);
    if (!temporary.descriptor().write(text))
        throw InputError(file.string(), std::string("cannot be written: ") + std::strerror(errno));
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

void AppendedFile::fail(const std::string& what) const {
    throw InputError(file_.string(), what);
}

void AppendedFile::append(std::string_view text) {
    const auto fail_to_write = [&] { fail(std::string("cannot be written: ") + std::strerror(errno)); };
    if (size_ == 0) {
        TemporaryFile temporary(file_);
        if (!temporary.descriptor().write(text)) fail_to_write();
        identity_ = temporary.descriptor().identity();
        temporary.rename();
    } else {
        const Descriptor descriptor(file_, O_WRONLY);
        if (!descriptor.is_open()) fail_to_write();
        struct stat status;
        if (descriptor.identity() != identity_ || ::fstat(descriptor.number(), &status) != 0 ||
            static_cast<std::uint64_t>(status.st_size) != size_)
            fail("was changed by somebody else while it was being written");
        if (!descriptor.write(text, static_cast<off_t>(size_))) {
            const std::string reason = std::strerror(errno);
            if (::ftruncate(descriptor.number(), static_cast<off_t>(size_)) != 0)
                fail("cannot be written: " + reason + "; its last line is incomplete");
            fail("cannot be written: " + reason);
        }
    }
    size_ += text.size();
    hash_.add(text.data(), text.size());
}

void AppendedFile::exchange(StateArchive& archive) {
    std::string hash = hash_.text();
    archive.exchange(size_);
    archive.exchange(hash);
    if (size_ == 0) return;
    const Descriptor descriptor(file_, O_RDWR);
    if (!archive.reads()) {
        if (!descriptor.is_open() || ::fsync(descriptor.number()) != 0)
            fail(std::string("cannot be written: ") + std::strerror(errno));
        return;
    }
    const std::string text = read_text_file(file_).substr(0, size_);
    hash_ = RunningHash();
    hash_.add(text.data(), text.size());
    if (hash_.text() != hash) fail("is not the file that was being written");
    identity_ = descriptor.identity();
    if (!descriptor.is_open() || ::ftruncate(descriptor.number(), static_cast<off_t>(size_)) != 0)
        fail(std::string("cannot be written: ") + std::strerror(errno));
}

void require_writable(const std::filesystem::path& file) {
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(file, error);
    if (std::filesystem::is_directory(status)) throw InputError(file.string(), "expected a file, this is a folder");
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
        throw InputError(file.string(), "expected a file, this is a device or a pipe, which cannot be replaced");
    if (status.type() == std::filesystem::file_type::none)
        throw InputError(file.string(), "cannot be written: " + error.message());
    make_folder(file.parent_path());
    const TemporaryFile temporary(file);
}

void require_space(const std::filesystem::path& folder, std::uint64_t bytes, const std::string& what) {
    make_folder(folder);
    std::error_code error;
    const std::filesystem::space_info space = std::filesystem::space(folder.empty() ? "." : folder, error);
    if (error || bytes <= space.available) return;
    constexpr double mebibyte = 1024.0 * 1024.0;
    throw InputError(folder.string(), fmt::format("{} can take {:.1f} MiB, and {:.1f} MiB are free there", what,
                                                  static_cast<double>(bytes) / mebibyte,
                                                  static_cast<double>(space.available) / mebibyte));
}

}  // namespace photonlab
