#include "core/files/files.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <system_error>
#include <utility>

#include "core/error.h"
#include "core/files/descriptor.h"
#include "core/files/temporary_file.h"

namespace photonlab {

namespace {

std::string cannot_be_read() {
    return std::string("cannot be read: ") + std::strerror(errno);
}

std::uintmax_t size_of(const Descriptor& descriptor) {
    struct stat status;
    return ::fstat(descriptor.number(), &status) == 0 ? static_cast<std::uintmax_t>(status.st_size) : 0;
}

/// Throws InputError where something is at the path that is no ordinary file, a folder or what is called `other`, and
/// where it is not known what is there, which is why the file `cannot`.
void require_ordinary(const std::filesystem::path& file, const std::string& other, const std::string& cannot) {
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(file, error);
    if (std::filesystem::is_directory(status)) throw InputError(file.string(), "expected a file, this is a folder");
    if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
        throw InputError(file.string(), "expected a file, this is " + other);
    if (status.type() == std::filesystem::file_type::none)
        throw InputError(file.string(), cannot + ": " + error.message());
}

/// The file, opened to be read; it is ordinary. Not open, with the reason in errno, when there is none. Nothing is
/// waited for, not even by the files of /proc that look ordinary and end when the kernel has something to say.
Descriptor open_ordinary_file(const std::filesystem::path& file) {
    require_ordinary(file, "a pipe or a device", "cannot be read");
    Descriptor descriptor(file, O_RDONLY | O_NOCTTY, Links::Followed);
    if (!descriptor.is_open()) {
        if (errno == ENOENT || errno == ENOTDIR) return descriptor;
        throw InputError(file.string(), cannot_be_read());
    }
    char byte = 0;
    if (size_of(descriptor) == 0 && ::read(descriptor.number(), &byte, 1) != 0)
        throw InputError(file.string(), "expected a file that has a size, this is one of the kernel's");
    return descriptor;
}

std::string read_all(const std::filesystem::path& file, const Descriptor& descriptor, std::uintmax_t largest) {
    const std::uintmax_t size = size_of(descriptor);
    if (size > largest)
        throw InputError(file.string(), fmt::format("expected at most {} bytes, got {}", largest, size));
    std::string text(size, '\0');
    for (std::size_t done = 0; done < text.size();) {
        const ssize_t count = ::read(descriptor.number(), text.data() + done, text.size() - done);
        if (count < 0 && errno == EINTR) continue;
        if (count < 0) throw InputError(file.string(), cannot_be_read());
        if (count == 0) text.resize(done);  // somebody made it shorter meanwhile
        done += static_cast<std::size_t>(count);
    }
    return text;
}

}  // namespace

void require_ordinary_file(const std::filesystem::path& file) {
    if (!open_ordinary_file(file).is_open()) throw InputError(file.string(), cannot_be_read());
}

std::string read_text_file(const std::filesystem::path& file, std::uintmax_t largest) {
    const Descriptor descriptor = open_ordinary_file(file);
    if (!descriptor.is_open()) throw InputError(file.string(), cannot_be_read());
    return read_all(file, descriptor, largest);
}

std::optional<std::string> read_if_there(const std::filesystem::path& file, std::uintmax_t largest) {
    const Descriptor descriptor = open_ordinary_file(file);
    return descriptor.is_open() ? std::optional(read_all(file, descriptor, largest)) : std::nullopt;
}

bool is_there(const std::filesystem::path& name) {
    std::error_code error;
    const std::filesystem::file_status status = std::filesystem::status(name, error);
    if (status.type() == std::filesystem::file_type::none) throw InputError(name.string(), error.message());
    return std::filesystem::exists(status);
}

bool is_folder(const std::filesystem::path& name) {
    std::error_code error;
    return std::filesystem::is_directory(name, error);
}

std::uintmax_t size_of_file(const std::filesystem::path& file) {
    std::error_code error;
    const std::uintmax_t size = std::filesystem::file_size(file, error);
    if (error) throw InputError(file.string(), "cannot be read: " + error.message());
    return size;
}

std::vector<std::filesystem::path> entries_of(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> entries;
    std::error_code error;
    std::filesystem::directory_iterator entry(folder, error);
    for (; !error && entry != std::filesystem::directory_iterator(); entry.increment(error))
        entries.push_back(entry->path());
    if (error && error != std::errc::no_such_file_or_directory)
        throw InputError(folder.string(), "cannot be read: " + error.message());
    std::sort(entries.begin(), entries.end());
    return entries;
}

std::vector<std::filesystem::path> files_below(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> files;
    for (std::filesystem::path& entry : entries_of(folder)) {
        std::error_code error;
        if (std::filesystem::symlink_status(entry, error).type() != std::filesystem::file_type::directory) {
            files.push_back(std::move(entry));
            continue;
        }
        std::vector<std::filesystem::path> below = files_below(entry);
        std::move(below.begin(), below.end(), std::back_inserter(files));
    }
    return files;
}

void remove_if_there(const std::filesystem::path& name) {
    std::error_code error;
    std::filesystem::remove_all(name, error);
    if (error) throw InputError(name.string(), "cannot be removed: " + error.message());
}

std::string working_directory() {
    std::error_code error;
    return std::filesystem::current_path(error).string();
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
    if (!is_folder(folder))
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
    require_ordinary(file, "a device or a pipe, which cannot be replaced", "cannot be written");
    make_folder(file.parent_path());
    const TemporaryFile temporary(file);
}

void require_space(const std::filesystem::path& folder, std::uint64_t bytes, const std::string& what) {
    make_folder(folder);
    std::error_code error;
    const std::filesystem::space_info space = std::filesystem::space(folder.empty() ? "." : folder, error);
    if (error || bytes <= space.available) return;
    constexpr double mebibyte = 1024.0 * 1024.0;
    throw InputError(
        folder.empty() ? "." : folder.string(),
        fmt::format("{} can take {:.1f} MiB, and {:.1f} MiB are free there", what,
                    static_cast<double>(bytes) / mebibyte, static_cast<double>(space.available) / mebibyte));
}

}  // namespace photonlab
