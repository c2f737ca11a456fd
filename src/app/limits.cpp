#include "app/limits.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <condition_variable>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>
#include <vector>

#include "core/error.h"
#include "core/machine/available_memory.h"

namespace photonlab {

namespace {

constexpr rlim_t usual_stack = rlim_t{8} << 20;
constexpr rlim_t least_stack = rlim_t{1} << 20;

/// Raises a limit to `wanted`, or to what is allowed of it; true when it was lower.
bool raise(__rlimit_resource_t resource, rlim_t wanted) {
    rlimit limit{};
    if (::getrlimit(resource, &limit) != 0) return false;
    const rlim_t most = std::min(wanted, limit.rlim_max);  // RLIM_INFINITY is the largest number
    if (limit.rlim_cur >= most) return false;
    limit.rlim_cur = most;
    return ::setrlimit(resource, &limit) == 0;
}

/// How many of `threads` can be there at once, this one included, and why no more.
struct StartedThreads {
    int count = 1;
    std::string why_no_more;
};

StartedThreads try_threads(int threads) {
    StartedThreads result;
    std::mutex mutex;
    std::condition_variable end;
    bool is_over = false;
    std::vector<std::thread> started;
    try {
        for (; result.count < threads; ++result.count)
            started.emplace_back([&] {
                std::unique_lock lock(mutex);
                end.wait(lock, [&] { return is_over; });
            });
    } catch (const std::system_error& error) {
        result.why_no_more = error.code().message();
    } catch (const std::bad_alloc&) {
        result.why_no_more = "no memory is left";
    }
    {
        const std::lock_guard lock(mutex);
        is_over = true;
    }
    end.notify_all();
    for (std::thread& thread : started) thread.join();
    return result;
}

/// OpenMP keeps its threads. From then on their stacks are part of what the process has. Returns how many there are; of
/// a loop that does nothing the compiler would leave nothing.
int start_threads_of_openmp(int threads) {
    int started = 0;
#pragma omp parallel num_threads(threads) reduction(+ : started)
    started += 1;
    return started;
}

/// How many threads have stacks in half of the memory that is left.
int threads_in_half_of_memory() {
    rlimit stack{};
    const bool is_known = ::getrlimit(RLIMIT_STACK, &stack) == 0 && stack.rlim_cur != RLIM_INFINITY;
    const double stack_mebibytes = static_cast<double>(is_known ? stack.rlim_cur : usual_stack) / (1 << 20);
    return 1 + static_cast<int>(std::min(1024.0, 0.5 * available_memory().mebibytes / stack_mebibytes));
}

}  // namespace

bool raise_limits() {
    raise(RLIMIT_NOFILE, RLIM_INFINITY);
    return raise(RLIMIT_STACK, usual_stack);
}

void require_stack() {
    rlimit limit{};
    if (::getrlimit(RLIMIT_STACK, &limit) != 0 || limit.rlim_cur >= least_stack) return;
    throw InputError(
        fmt::format("the stack: {} KiB are needed, and ulimit -s allows {}", least_stack >> 10, limit.rlim_cur >> 10));
}

void start_threads(int threads) {
    const StartedThreads possible = try_threads(threads);
    if (possible.count < threads)
        throw InputError(fmt::format(
            "threads: {} are asked for, and {} can be started: {} (ulimit -u and -v, and pids.max of control groups, "
            "are what limits them); set threads to fewer",
            threads, possible.count, possible.why_no_more));
    start_threads_of_openmp(threads);
}

int start_threads_up_to(int threads) {
    return start_threads_of_openmp(try_threads(std::min(threads, threads_in_half_of_memory())).count);
}

std::string no_memory_message() {
    return fmt::format("memory: more was needed than there is: the program holds {:.0f} MiB, and {}",
                       resident_mebibytes(), describe(available_memory()));
}

std::string limit_message() {
    constexpr double as_good_as_none = 16.0;  // MiB
    if (available_memory().mebibytes < as_good_as_none) return no_memory_message();
    const StartedThreads possible = try_threads(2);
    return possible.count < 2 ? "threads: no more can be started: " + possible.why_no_more : "";
}

}  // namespace photonlab
