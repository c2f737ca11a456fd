#include "app/interruption.h"

#include <unistd.h>

#include <atomic>
#include <csignal>

namespace photonlab {

namespace {

std::atomic<bool> was_interrupted = false;  // written by a signal's handler, which can be given nothing
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void remember_interruption(int) {
    was_interrupted = true;
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, SIG_DFL);
    constexpr char message[] = "\nphotonlab: ends after this pass; once more ends it at once\n";
    const ssize_t ignored = ::write(STDERR_FILENO, message, sizeof(message) - 1);
    static_cast<void>(ignored);
}

}  // namespace

void listen_for_interruptions() {
    std::signal(SIGINT, remember_interruption);
    std::signal(SIGTERM, remember_interruption);
}

bool is_interrupted() {
    return was_interrupted;
}

}  // namespace photonlab
