#include "core/files/temporary_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <random>
#include <string>
#include <system_error>

#include "core/error.h"

namespace photonlab {

namespace {

constexpr std::string_view infix = ".partial-";  // followed by random digits
constexpr std::size_t digits = 16;               // hexadecimal
constexpr std::size_t longest_name = 255;        // bytes, in every file system that matters

/// Names that are too long for their temporary one are cut, between the bytes of no character.
std::filesystem::path random_name(const std::filesystem::path& final_name) {
    const std::string name = final_name.filename().string();
    std::size_t length = std::min(name.size(), longest_name - infix.size() - digits);
    while (length > 0 && length < name.size() && (static_cast<unsigned char>(name[length]) & 0xc0) == 0x80) --length;
    std::random_device random;
    return final_name.parent_path() /
           fmt::format("{}{}{:08x}{:08x}", std::string_view(name).substr(0, length), infix, random(), random());
}

bool is_random_name(std::string_view name) {
    if (name.size() < infix.size() + digits) return false;
    const std::string_view end = name.substr(name.size() - digits);
    return name.substr(0, name.size() - digits).ends_with(infix) &&
           end.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

enum class Hold { Mine, Others, Unknown };

/// The lock lasts as long as the file is open. It is on a byte that nobody writes: where locks bind, as over SMB, one
/// on all of the file would keep its own writer out. On file systems without locks nobody knows.
Hold hold(const Descriptor& descriptor) {
    struct flock lock {};
    lock.l_type = F_WRLCK;
    lock.l_whence = SEEK_SET;
    lock.l_start = off_t{1} << 62;
    lock.l_len = 1;
    if (::fcntl(descriptor.number(), F_OFD_SETLK, &lock) == 0) return Hold::Mine;
    return errno == EAGAIN || errno == EACCES ? Hold::Others : Hold::Unknown;
}

}  // namespace

void remove_leftovers(const std::filesystem::path& folder) {
    std::error_code ignored;
    const std::filesystem::directory_iterator files(folder.empty() ? "." : folder, ignored);
    for (const auto& entry : files) {
        if (!is_random_name(entry.path().filename().string())) continue;
        const Descriptor descriptor(entry.path(), O_RDWR);
        // Its writer may have renamed it, and let go of it, since the folder was read.
        if (descriptor.is_open() && hold(descriptor) == Hold::Mine && descriptor.is_named(entry.path()))
            std::filesystem::remove(entry.path(), ignored);
    }
}

TemporaryFile::TemporaryFile(const std::filesystem::path& final_name) : final_name_(final_name) {
    if (final_name.filename().string().size() > longest_name)
        throw InputError(final_name.string(), std::string("cannot be written: ") + std::strerror(ENAMETOOLONG));
    remove_leftovers(final_name.parent_path());
    while (true) {
        path_ = random_name(final_name);
        descriptor_ = Descriptor(path_, O_RDWR | O_CREAT | O_EXCL);
        if (!descriptor_.is_open() && errno == EEXIST) continue;
        if (!descriptor_.is_open())
            throw InputError(final_name.string(), std::string("cannot be written: ") + std::strerror(errno));
        // Who looks for leftovers may have been there between the two, and then removes it.
        if (hold(descriptor_) != Hold::Others && descriptor_.is_named(path_)) return;
    }
}

TemporaryFile::~TemporaryFile() {
    std::error_code ignored;
    if (!renamed_) std::filesystem::remove(path_, ignored);
}

void TemporaryFile::rename() {
    std::error_code error;
    if (!descriptor_.is_named(path_))
        throw InputError(final_name_.string(), std::filesystem::exists(path_, error)
                                                   ? "cannot be written: somebody else replaced its temporary file"
                                                   : std::string("cannot be written: ") + std::strerror(ENOENT));
    if (::fsync(descriptor_.number()) != 0)
        throw InputError(final_name_.string(), std::string("cannot be written: ") + std::strerror(errno));
    std::filesystem::rename(path_, final_name_, error);
    if (error) throw InputError(final_name_.string(), "cannot be written: " + error.message());
    renamed_ = true;
    descriptor_ = Descriptor();
}

}  // namespace photonlab
