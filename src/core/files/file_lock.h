// A lock between processes, also of several machines that share a folder: whoever holds the file's lock works on what
// it stands for. A process that ends, however it ends, gives its locks up; the file is there only while somebody holds
// it or was killed, and says who that is:
//
//     {"photonlab": "lock", "host": "n17", "process": 4711, "boot": "0f5c2f0e-...", "nonce": "5a3c91..."}
//
// What holds is flock(). Not every network file system carries it from one machine to another (NFS before 3 without
// its lock daemon, NFS with local_lock, Lustre with localflock, most of FUSE), and such a one says nothing of it: each
// machine then has locks of its own. So a lock has a lease, too: while it is held its file is touched every few
// seconds. Who is given a lock whose file names a process of another machine, with a lease that is not over, does not
// take it: that process has either died a moment ago, or is at work where locks do not reach. Both are decided by
// waiting for the end of the lease. Times are compared on the file system's own clock. A lock is taken by renaming its
// file, which one of many can, and making a new one: its nonce tells who had it before that it is gone.

#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/error.h"

namespace photonlab {

/// How long a lock of another machine is believed without a sign of life.
inline constexpr double lease_seconds = 60.0;

/// Who has a lock that was asked for in vain.
struct LockHolder {
    std::string host;         ///< empty where the file does not say
    long process = 0;         ///< its id there
    bool is_certain = false;  ///< the file system says so; otherwise the lease alone does
    std::string nonce = "";   ///< of this lock and no other; empty where the file does not say
    double touched = 0.0;     ///< s, when the file last was, by the file system's clock
};

/// What the program ends with where it was asked for what another process is making, and is not to wait for that.
class HeldElsewhere : public InputError {
public:
    using InputError::InputError;
};

/// "process 4711 on n17".
std::string describe(const LockHolder& holder);

class LeaseKeeper;
struct SignedFile;

class FileLock {
public:
    /// Makes the file, and its folder, where needed; empty when another process holds it, which `holder` then is.
    /// Throws InputError when there can be no lock, or when the file is none of a lock and so is somebody else's.
    static std::optional<FileLock> try_lock(const std::filesystem::path& file, LockHolder* holder = nullptr);

    /// Waits for it; empty when it was interrupted before that.
    static std::optional<FileLock> wait_for(const std::filesystem::path& file,
                                            const std::function<bool()>& is_interrupted);

    FileLock(FileLock&&) = default;
    FileLock& operator=(FileLock&&) = delete;

    /// Removes the file.
    ~FileLock();

    /// Throws InputError when the file is gone or another process's: somebody removed it, or took this process for
    /// dead.
    void require_held() const;

private:
    explicit FileLock(std::shared_ptr<const SignedFile> held);

    std::shared_ptr<const SignedFile> held_;
    std::shared_ptr<LeaseKeeper> keeper_;
};

}  // namespace photonlab
