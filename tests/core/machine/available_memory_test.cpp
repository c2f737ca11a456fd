#include "core/machine/available_memory.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "core/error.h"

namespace photonlab {
namespace {

constexpr std::uint64_t mebibyte = 1 << 20;

std::string refusal_of(std::uint64_t bytes) {
    try {
        require_memory_for("mesh.obj", bytes);
    } catch (const InputError& error) {
        return error.what();
    }
    return "";
}

/// As `ulimit` sets it, for as long as this is there.
class Limit {
public:
    Limit(decltype(RLIMIT_AS) resource, std::uint64_t bytes) : resource_(resource) {
        ::getrlimit(resource_, &before_);
        const rlimit limit{bytes, before_.rlim_max};
        ::setrlimit(resource_, &limit);
    }
    ~Limit() { ::setrlimit(resource_, &before_); }
    Limit(const Limit&) = delete;
    Limit& operator=(const Limit&) = delete;

private:
    decltype(RLIMIT_AS) resource_;
    rlimit before_{};
};

TEST(AvailableMemory, IsTheLeastThatAnyLimitLeaves) {
#ifdef __SANITIZE_ADDRESS__
    GTEST_SKIP() << "the sanitizer cannot work within limits of memory";
#endif
    const AvailableMemory all = available_memory();
    EXPECT_GT(all.mebibytes, 1.0);
    EXPECT_GT(resident_mebibytes(), 1.0);
    {
        const Limit limit(RLIMIT_DATA, 1);  // less than is there
        EXPECT_EQ(available_memory().mebibytes, 0.0);
        EXPECT_EQ(available_memory().limit, "ulimit -d");
        EXPECT_EQ(describe(available_memory()), "0 MiB are left by ulimit -d");
    }
    {
        const Limit limit(RLIMIT_AS, 1);
        EXPECT_EQ(refusal_of(3 * mebibyte), "mesh.obj: needs 3 MiB of memory, and 0 MiB are left by ulimit -v");
        EXPECT_EQ(refusal_of(mebibyte - 1), "");
    }
    EXPECT_EQ(available_memory().limit, all.limit);
}

TEST(AvailableMemory, IsEnoughForWhatFits) {
    const AvailableMemory all = available_memory();
    EXPECT_EQ(refusal_of(static_cast<std::uint64_t>(0.5 * all.mebibytes) * mebibyte), "");
    EXPECT_NE(
        refusal_of(static_cast<std::uint64_t>(2.0 * all.mebibytes) * mebibyte).find("MiB are left by " + all.limit),
        std::string::npos);
}

}  // namespace
}  // namespace photonlab
