#include "core/files/descriptor.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace photonlab {

// O_NONBLOCK is for a pipe that has the name, which would wait for somebody at its other end.
Descriptor::Descriptor(const std::filesystem::path& file, int flags, Links links)
    : number_(::open(file.c_str(), flags | O_CLOEXEC | O_NONBLOCK | (links == Links::Refused ? O_NOFOLLOW : 0), 0666)) {
}

Descriptor::Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}

Descriptor& Descriptor::operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
}

Descriptor::~Descriptor() {
    if (number_ >= 0) ::close(number_);
}

std::optional<FileIdentity> Descriptor::identity() const {
    struct stat status;
    if (::fstat(number_, &status) != 0) return std::nullopt;
    return FileIdentity{status.st_dev, status.st_ino};
}

bool Descriptor::is_named(const std::filesystem::path& file) const {
    const Descriptor named(file, O_RDONLY);  // opened: over a network, stat() alone may answer from memory
    return named.is_open() && named.identity() == identity();
}

bool Descriptor::write(std::string_view text, off_t position) const {
    while (!text.empty()) {
        const ssize_t written = ::pwrite(number_, text.data(), text.size(), position);
        if (written < 0 && errno == EINTR) continue;
        if (written == 0) errno = ENOSPC;
        if (written <= 0) return false;
        text.remove_prefix(static_cast<std::size_t>(written));
        position += written;
    }
    return true;
}

}  // namespace photonlab
