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

namespace {

/// A POSIX file descriptor: streams do not say whether the disk took what they were given.
class Descriptor {
public:
    Descriptor(const std::filesystem::path& file, int flags) : number_(::open(file.c_str(), flags | O_CLOEXEC, 0666)) {}
    ~Descriptor() {
        if (number_ >= 0) ::close(number_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;

    bool is_open() const { return number_ >= 0; }
    int number() const { return number_; }

private:
    int number_;
};

}  // namespace

void AppendedFile::fail(const std::string& what) const {
    throw InputError(file_.string(), what);
}

void AppendedFile::append(std::string_view text) {
    const Descriptor descriptor(file_, O_WRONLY | (size_ == 0 ? O_CREAT | O_TRUNC : 0));
    if (!descriptor.is_open()) fail(std::string("cannot be written: ") + std::strerror(errno));
    struct stat status;
    if (::fstat(descriptor.number(), &status) != 0 || static_cast<std::uint64_t>(status.st_size) != size_)
        fail("was changed by somebody else while it was being written");
    for (std::size_t done = 0; done < text.size();) {
        const ssize_t written =
            ::pwrite(descriptor.number(), text.data() + done, text.size() - done, static_cast<off_t>(size_ + done));
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) {
            const std::string reason = written < 0 ? std::strerror(errno) : "nothing more is taken";
            if (::ftruncate(descriptor.number(), static_cast<off_t>(size_)) != 0)
                fail("cannot be written: " + reason + "; its last line is incomplete");
            fail("cannot be written: " + reason);
        }
        done += static_cast<std::size_t>(written);
    }
    size_ += text.size();
    hash_.add(text.data(), text.size());
}

void AppendedFile::exchange(StateArchive& archive) {
    std::string hash = hash_.text();
    archive.exchange(size_);
    archive.exchange(hash);
    if (size_ == 0) return;
    if (!archive.reads()) {
        const Descriptor descriptor(file_, O_WRONLY);
        if (!descriptor.is_open() || ::fsync(descriptor.number()) != 0)
            fail(std::string("cannot be written: ") + std::strerror(errno));
        return;
    }
    const std::string text = read_text_file(file_).substr(0, size_);
    hash_ = RunningHash();
    hash_.add(text.data(), text.size());
    if (hash_.text() != hash) fail("is not the file that was being written");
    std::filesystem::resize_file(file_, size_);
}

void require_writable(const std::filesystem::path& file) {
    if (std::filesystem::is_directory(file)) throw InputError(file.string(), "expected a file, this is a folder");
    if (std::filesystem::exists(file) && !std::filesystem::is_regular_file(file))
        throw InputError(file.string(), "expected a file, this is a device or a pipe, which cannot be replaced");
    make_folder(file.parent_path());
    const TemporaryFile temporary(file);
    if (!std::ofstream(temporary.path()))
        throw InputError(file.string(), std::string("cannot be written: ") + std::strerror(errno));
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
