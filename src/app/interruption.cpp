#include "app/interruption.h"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstdint>
#include <ctime>

namespace photonlab {

namespace {

constexpr std::int64_t time_of_one_wish = 1000;  // ms

// Written by a signal's handler, which can be given nothing.
std::atomic<bool> was_interrupted = false;
std::atomic<std::int64_t> terminated_at = 0;  // ms
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<std::int64_t>::is_always_lock_free);

std::int64_t milliseconds_now() {
    timespec now;
    ::clock_gettime(CLOCK_MONOTONIC, &now);
    return 1000 * static_cast<std::int64_t>(now.tv_sec) + now.tv_nsec / 1'000'000;
}

// Of a job that ends, the queueing system may tell the program, and the script that tells it, too: one wish.
extern "C" void ignore_repetition(int signal) {
    if (milliseconds_now() - terminated_at < time_of_one_wish) return;
    std::signal(signal, SIG_DFL);
    ::raise(signal);  // once this handler has ended
}

extern "C" void remember_interruption(int signal) {
    was_interrupted = true;
    terminated_at = milliseconds_now();
    std::signal(SIGINT, SIG_DFL);
    std::signal(SIGTERM, signal == SIGTERM ? ignore_repetition : SIG_DFL);
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
