#include "core/files/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <string>
#include <thread>

#include "core/error.h"
#include "core/files/files.h"

namespace photonlab {

namespace {

bool is_empty_file(const Descriptor& descriptor) {
    struct stat status;
    return ::fstat(descriptor.number(), &status) == 0 && S_ISREG(status.st_mode) && status.st_size == 0;
}

}  // namespace

std::optional<FileLock> FileLock::try_lock(const std::filesystem::path& file) {
    make_folder(file.parent_path());
    while (true) {
        Descriptor descriptor(file, O_RDWR | O_CREAT);
        if (!descriptor.is_open())
            throw InputError(file.string(), std::string("cannot be written: ") + std::strerror(errno));
        if (!is_empty_file(descriptor))
            throw InputError(file.string(), "is in the way: expected the empty file of a lock here, or none");
        const bool is_locked = ::flock(descriptor.number(), LOCK_EX | LOCK_NB) == 0;
        const int reason = errno;
        // Removed, or made anew, since it was opened: its lock is then no one's.
        if (is_locked && descriptor.is_named(file)) return FileLock(file, std::move(descriptor));
        if (is_locked || reason == EINTR || reason == ESTALE) continue;
        if (reason == EWOULDBLOCK) return std::nullopt;
        throw InputError(file.string(), std::string("cannot be locked: ") + std::strerror(reason));
    }
}

std::optional<FileLock> FileLock::wait_for(const std::filesystem::path& file,
                                           const std::function<bool()>& is_interrupted) {
    while (true) {
        if (auto lock = try_lock(file)) return lock;
        if (is_interrupted()) return std::nullopt;
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
}

FileLock::~FileLock() {
    if (!descriptor_.is_open()) return;
    if (descriptor_.is_named(file_)) ::unlink(file_.c_str());  // while it is held, so that nobody else's is removed
}

}  // namespace photonlab
