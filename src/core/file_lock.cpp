#include "core/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <string>
#include <thread>
#include <utility>

#include "core/error.h"
#include "core/files.h"

namespace photonlab {

namespace {

/// False when the file was removed, or made anew, since it was opened: its lock is then no one's.
bool has_name(int descriptor, const std::filesystem::path& file) {
    struct stat opened;
    struct stat named;
    return ::fstat(descriptor, &opened) == 0 && ::stat(file.c_str(), &named) == 0 && opened.st_dev == named.st_dev &&
           opened.st_ino == named.st_ino;
}

}  // namespace

std::optional<FileLock> FileLock::try_lock(const std::filesystem::path& file) {
    make_folder(file.parent_path());
    while (true) {
        const int descriptor = ::open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
        if (descriptor < 0) throw InputError(file.string(), std::string("cannot be written: ") + std::strerror(errno));
        const bool is_locked = ::flock(descriptor, LOCK_EX | LOCK_NB) == 0;
        const int reason = errno;
        if (is_locked && has_name(descriptor, file)) return FileLock(file, descriptor);
        ::close(descriptor);
        if (is_locked || reason == EINTR) continue;
        if (reason == EWOULDBLOCK) return std::nullopt;
        throw InputError(file.string(), std::string("cannot be locked: ") + std::strerror(reason));
    }
}

FileLock FileLock::wait_for(const std::filesystem::path& file) {
    while (true) {
        if (auto lock = try_lock(file)) return std::move(*lock);
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
}

FileLock::FileLock(FileLock&& other) noexcept
    : file_(std::move(other.file_)), descriptor_(std::exchange(other.descriptor_, -1)) {}

FileLock::~FileLock() {
    if (descriptor_ < 0) return;
    ::unlink(file_.c_str());  // while it is held, so that nobody else's is removed
    ::close(descriptor_);
}

}  // namespace photonlab
