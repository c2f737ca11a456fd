#include "core/files/file_lock.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <random>
#include <thread>
#include <vector>

#include "core/error.h"
#include "core/files/files.h"
#include "core/files/json.h"
#include "core/machine/host.h"

namespace photonlab {

namespace {

constexpr double seconds_between_signs = 10.0;  // of life
constexpr double seconds_to_sign = 5.0;         // that who makes the file has to say who it is
constexpr double seconds_between_asks = 2.0;    // where a lease alone tells
constexpr std::size_t longest_text = 1024;      // bytes

/// What the file of a lock says.
struct LockText {
    bool is_signed = false;  // not empty, as it is for a moment
    LockHolder holder;
    std::string boot;
};

/// What no two locks have in common.
std::string new_nonce() {
    std::random_device device;
    return fmt::format("{:08x}{:08x}", device(), device());
}

std::string text_of_this_process(const std::string& nonce) {
    return Json{{"photonlab", "lock"},
                {"host", host_name()},
                {"process", ::getpid()},
                {"boot", boot_id()},
                {"nonce", nonce}}
               .dump(-1, ' ', false, Json::error_handler_t::replace) +
           "\n";
}

double seconds_of(const timespec& time) {
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// Empty when it is not the file of a lock.
std::optional<LockText> read_lock(const Descriptor& descriptor) {
    struct stat status;
    if (::fstat(descriptor.number(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
    std::array<char, longest_text> buffer;
    const ssize_t count = ::pread(descriptor.number(), buffer.data(), buffer.size(), 0);
    if (count < 0 || status.st_size > static_cast<off_t>(buffer.size())) return std::nullopt;
    LockText text;
    text.holder.touched = seconds_of(status.st_mtim);
    if (count == 0) return text;
    const auto json = parse_sound_json(std::string(buffer.data(), static_cast<std::size_t>(count)));
    if (!json || !json->is_object() || json->value("photonlab", Json()) != "lock") return std::nullopt;
    try {
        text.is_signed = true;
        text.holder.host = json->at("host").get<std::string>();
        text.holder.process = json->at("process").get<long>();
        text.holder.nonce = json->value("nonce", "");
        text.boot = json->at("boot").get<std::string>();
        return text;
    } catch (const Json::exception&) {
        return std::nullopt;
    }
}

/// Whether the name leads to this very file, and this very lock: over a network an inode may be another file's by now.
bool is_lock(const std::filesystem::path& file, const Descriptor& descriptor, const std::string& nonce) {
    const Descriptor named(file, O_RDWR);  // opened: over a network, stat() alone may answer from memory
    if (!named.is_open() || named.identity() != descriptor.identity()) return false;
    const auto text = read_lock(named);
    return text && text->holder.nonce == nonce;
}

/// A name beside the file that nobody else uses. It is that of a temporary file.
std::filesystem::path name_beside(const std::filesystem::path& file) {
    return fmt::format("{}.partial-{}", file.string(), new_nonce());
}

/// Takes the file of a lock that is free away. False when it is another one by now: of two that found it free at a
/// time, one takes it, and the other puts back the new one that it got hold of, whose holder keeps it.
bool take_away(const std::filesystem::path& file, const Descriptor& descriptor, const LockText& text) {
    if (!is_lock(file, descriptor, text.holder.nonce)) return false;
    const std::filesystem::path aside = name_beside(file);
    if (::rename(file.c_str(), aside.c_str()) != 0) return false;
    const bool is_it = is_lock(aside, descriptor, text.holder.nonce);
    if (!is_it) {
        const int ignored = ::link(aside.c_str(), file.c_str());  // fails where there is one again: its holder ends
        static_cast<void>(ignored);
    }
    ::unlink(aside.c_str());
    return is_it;
}

/// Since the file was touched, by the clock of its file system: that of a file which is touched beside it now. It
/// clears up no others: where locks do not reach, those of a process at work are taken for left over.
double seconds_since_touched(const std::filesystem::path& file, const Descriptor& descriptor) {
    const std::filesystem::path clock = name_beside(file);
    const Descriptor now(clock, O_RDWR | O_CREAT);
    struct stat then;
    struct stat made;
    const bool is_known = now.is_open() && ::futimens(now.number(), nullptr) == 0 &&
                          ::fstat(descriptor.number(), &then) == 0 && ::fstat(now.number(), &made) == 0;
    ::unlink(clock.c_str());
    return is_known ? std::max(0.0, seconds_of(made.st_mtim) - seconds_of(then.st_mtim)) : 0.0;
}

/// Whether the lock may be taken, which flock() has just given.
bool is_free(const std::filesystem::path& file, const Descriptor& descriptor, const LockText& text) {
    if (text.is_signed && text.boot == boot_id()) return true;  // here flock() tells: its process has ended
    return seconds_since_touched(file, descriptor) >= (text.is_signed ? lease_seconds : seconds_to_sign);
}

[[noreturn]] void fail(const std::filesystem::path& file, const char* what, int reason) {
    throw InputError(file.string(), fmt::format("{}: {}", what, std::strerror(reason)));
}

/// Of flock(), 0 or its errno. Who has made the file waits for others who have a look at it.
int lock(const Descriptor& descriptor, bool is_made) {
    while (::flock(descriptor.number(), LOCK_EX | LOCK_NB) != 0) {
        const int reason = errno;
        const bool is_looked_at =
            reason == EWOULDBLOCK && is_made && !read_lock(descriptor).value_or(LockText{}).is_signed;
        if (!is_looked_at && reason != EINTR) return reason;
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    return 0;
}

/// Says in a file that this process has made whose it is, to other machines as well. False when it was taken away
/// meanwhile.
bool sign(const std::filesystem::path& file, const Descriptor& descriptor, const std::string& nonce) {
    if (!descriptor.write(text_of_this_process(nonce)) || ::fsync(descriptor.number()) != 0) {
        const int reason = errno;
        if (descriptor.is_named(file)) ::unlink(file.c_str());
        fail(file, "cannot be written", reason);
    }
    return is_lock(file, descriptor, nonce);
}

}  // namespace

/// The file of a lock that this process has.
struct SignedFile {
    std::filesystem::path file;
    Descriptor descriptor;
    std::string nonce;

    /// False once it was removed, or taken by another process.
    bool is_held() const { return is_lock(file, descriptor, nonce); }
};

/// Touches the files of a process's locks, on a thread that is there as long as there are any.
class LeaseKeeper {
public:
    /// There is one, as there is one process.
    static std::shared_ptr<LeaseKeeper> of_this_process() {
        static std::mutex mutex;
        static std::weak_ptr<LeaseKeeper> keeper;
        const std::lock_guard guard(mutex);
        auto found = keeper.lock();
        if (!found) keeper = found = std::make_shared<LeaseKeeper>();
        return found;
    }

    ~LeaseKeeper() {
        {
            const std::lock_guard guard(mutex_);
            is_over_ = true;
        }
        ended_.notify_all();
        thread_.join();
    }

    void add(const SignedFile* held) {
        const std::lock_guard guard(mutex_);
        files_.push_back(held);
    }

    void remove(const SignedFile* held) {
        const std::lock_guard guard(mutex_);
        std::erase(files_, held);
    }

private:
    void keep() {
        std::unique_lock lock(mutex_);
        const std::chrono::duration<double> time(seconds_between_signs);
        while (!ended_.wait_for(lock, time, [&] { return is_over_; }))
            for (const SignedFile* held : files_)
                if (held->is_held()) ::futimens(held->descriptor.number(), nullptr);
    }

    std::mutex mutex_;
    std::condition_variable ended_;
    bool is_over_ = false;
    std::vector<const SignedFile*> files_;
    std::thread thread_{[this] { keep(); }};  // last, for it uses the others
};

FileLock::FileLock(std::shared_ptr<const SignedFile> held)
    : held_(std::move(held)), keeper_(LeaseKeeper::of_this_process()) {
    keeper_->add(held_.get());
}

std::optional<FileLock> FileLock::try_lock(const std::filesystem::path& file, LockHolder* holder) {
    make_folder(file.parent_path());
    while (true) {
        Descriptor descriptor(file, O_RDWR | O_CREAT | O_EXCL);
        const bool is_made = descriptor.is_open();
        if (!is_made && errno != EEXIST) fail(file, "cannot be written", errno);
        if (!is_made) descriptor = Descriptor(file, O_RDWR);
        if (!descriptor.is_open() && errno == ENOENT) continue;  // removed since
        if (!descriptor.is_open()) fail(file, "cannot be written", errno);
        const int reason = lock(descriptor, is_made);
        const std::optional<LockText> text = read_lock(descriptor);
        if (!text) throw InputError(file.string(), "is in the way: expected the file of a lock here, or none");
        // Removed, or made anew, since it was opened: its lock is then no one's.
        if (reason == ESTALE || (reason == 0 && !descriptor.is_named(file))) continue;
        if (reason != 0 && reason != EWOULDBLOCK) fail(file, "cannot be locked", reason);
        if (is_made && reason == 0) {
            const std::string nonce = new_nonce();
            if (!sign(file, descriptor, nonce)) continue;
            return FileLock(std::make_shared<SignedFile>(SignedFile{file, std::move(descriptor), nonce}));
        }
        if (reason == 0 && is_free(file, descriptor, *text)) {
            take_away(file, descriptor, *text);
            continue;  // whoever makes it anew has it
        }
        if (holder) {
            *holder = text->holder;
            holder->is_certain = reason != 0 && text->is_signed;
        }
        return std::nullopt;
    }
}

std::optional<FileLock> FileLock::wait_for(const std::filesystem::path& file,
                                           const std::function<bool()>& is_interrupted) {
    using Clock = std::chrono::steady_clock;
    while (true) {
        LockHolder holder;
        if (auto lock = try_lock(file, &holder)) return lock;
        const bool is_leased = !holder.is_certain && !holder.host.empty();
        const auto next = Clock::now() + std::chrono::duration<double>(is_leased ? seconds_between_asks : 0.0);
        do {
            if (is_interrupted()) return std::nullopt;
            std::this_thread::sleep_for(std::chrono::milliseconds(20));
        } while (Clock::now() < next);
    }
}

FileLock::~FileLock() {
    if (!held_) return;
    keeper_->remove(held_.get());
    if (held_->is_held()) ::unlink(held_->file.c_str());  // while it is held, so that nobody else's is removed
}

void FileLock::require_held() const {
    if (!held_->is_held())
        throw InputError(
            held_->file.string(),
            "was removed, or taken by another process; nothing more is written, so that no two work on one "
            "thing, and what was saved is gone on from");
}

std::string describe(const LockHolder& holder) {
    if (holder.host.empty()) return "another process";
    return fmt::format("process {} on {}", holder.process, holder.host);
}

}  // namespace photonlab
