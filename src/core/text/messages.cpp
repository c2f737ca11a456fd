#include "core/text/messages.h"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>

namespace photonlab {

namespace {

std::atomic<int> output_error = 0;  // the first errno of standard output, which there is only one of

/// Writes all of it; the errno that it failed with, or 0.
int write_all(int descriptor, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
        if (written > 0) {
            bytes.remove_prefix(static_cast<std::size_t>(written));
        } else if (written < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) {
            pollfd room{descriptor, POLLOUT, 0};
            ::poll(&room, 1, -1);
        } else if (written == 0 || errno != EINTR) {
            return written == 0 ? ENOSPC : errno;
        }
    }
    return 0;
}

}  // namespace

void occupy_standard_streams() {
    // A place, opened without reading or writing: there is one everywhere, and both then fail.
    for (int descriptor = STDIN_FILENO; descriptor <= STDERR_FILENO; ++descriptor)
        if (::fcntl(descriptor, F_GETFD) < 0 && errno == EBADF) {
            const int lowest = ::open("/", O_PATH);
            static_cast<void>(lowest);  // is `descriptor`, for those below it are open
        }
}

void write_output(std::string_view bytes) {
    int none = 0;
    if (const int error = write_all(STDOUT_FILENO, bytes)) output_error.compare_exchange_strong(none, error);
}

void write_message(std::string_view bytes) {
    write_all(STDERR_FILENO, bytes);
}

std::string output_failure() {
    const int error = output_error;
    return error == 0 ? "" : std::strerror(error);
}

}  // namespace photonlab
