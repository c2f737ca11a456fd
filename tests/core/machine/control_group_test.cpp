// Trees of files as kernels and containers show them: what /proc/self/cgroup and /proc/self/mountinfo say is copied
// from the systems that are named.

#include "core/machine/control_group.h"

#include <gtest/gtest.h>

#include <fstream>

#include "tests/image/scratch_folder.h"

namespace photonlab {
namespace {

constexpr double bytes_in_mebibyte = 1024.0 * 1024.0;

class ControlGroup : public ::testing::Test {
protected:
    void write(const std::string& name, const std::string& text) const {
        std::filesystem::create_directories((folder_ / name).parent_path());
        std::ofstream(folder_ / name) << text;
    }
    /// A group of version 2 that uses 100 MiB, 30 of them files that the kernel can drop; `high` may be empty.
    void group_two(const std::string& folder, const std::string& most, const std::string& high = "max") {
        write(folder + "/memory.max", most + "\n");
        write(folder + "/memory.high", high + "\n");
        write(folder + "/memory.current", mebibytes(100) + "\n");
        write(folder + "/memory.stat",
              "anon 5\nfile 7\ninactive_anon 3\nactive_file 11\ninactive_file " + mebibytes(30) + "\nslab 9\n");
    }
    /// The same of version 1, where `inactive_file` is the group's alone and `total_inactive_file` of all below, too.
    void group_one(const std::string& folder, const std::string& limit, const std::string& use_hierarchy = "1") {
        write(folder + "/memory.limit_in_bytes", limit + "\n");
        write(folder + "/memory.usage_in_bytes", mebibytes(100) + "\n");
        write(folder + "/memory.use_hierarchy", use_hierarchy + "\n");
        write(folder + "/memory.stat", "cache 5\ninactive_file 1\nhierarchical_memory_limit 3\ntotal_inactive_file " +
                                           mebibytes(30) + "\ntotal_active_file 9\n");
    }
    static std::string mebibytes(int count) { return std::to_string(count * (1 << 20)); }
    void process(const std::string& cgroup, const std::string& mountinfo) {
        write("proc/self/cgroup", cgroup);
        write("proc/self/mountinfo", mountinfo);
    }
    std::string found() {
        const auto left = memory_left_by_control_groups(folder_ / "");
        return left ? left->group + " leaves " + std::to_string(left->bytes / bytes_in_mebibyte).substr(0, 6)
                    : "no limit";
    }

    const ScratchFolder folder_;
    const std::string two_ = "35 24 0:30 / /sys/fs/cgroup rw,nosuid,nodev shared:9 - cgroup2 cgroup2 rw,nsdelegate\n";
    const std::string unlimited_ = "9223372036854771712";  // of version 1: all pages that there can be
};

// systemd, version 2 alone.
TEST_F(ControlGroup, TheGroupsOwnLimitIsSeenAndThoseAboveIt) {
    process("0::/user.slice/user-1000.slice/session-2.scope\n",
            "24 30 0:22 / /sys rw shared:7 - sysfs sysfs rw\n" + two_ +
                "36 24 0:31 / /sys/fs/pstore rw shared:10 - pstore pstore rw\n");
    const std::string slice = "sys/fs/cgroup/user.slice";
    group_two(slice + "/user-1000.slice/session-2.scope", "max");
    EXPECT_EQ(found(), "no limit");
    group_two(slice, mebibytes(500));
    EXPECT_EQ(found(), "/user.slice leaves 430.00");
    group_two(slice + "/user-1000.slice/session-2.scope", mebibytes(300));
    EXPECT_EQ(found(), "/user.slice/user-1000.slice/session-2.scope leaves 230.00");
    group_two(slice + "/user-1000.slice", mebibytes(200));
    EXPECT_EQ(found(), "/user.slice/user-1000.slice leaves 130.00");
    group_two("sys/fs/cgroup/system.slice", mebibytes(100));  // of others
    EXPECT_EQ(found(), "/user.slice/user-1000.slice leaves 130.00");
}

TEST_F(ControlGroup, BeyondMemoryHighAProcessIsPutToSleep) {
    process("0::/a\n", two_);
    group_two("sys/fs/cgroup/a", mebibytes(500), mebibytes(250));
    EXPECT_EQ(found(), "/a leaves 180.00");
}

TEST_F(ControlGroup, AGroupThatIsBeyondItsLimitLeavesNothing) {
    process("0::/a\n", two_);
    group_two("sys/fs/cgroup/a", mebibytes(50));
    EXPECT_EQ(found(), "/a leaves 0.0000");
    group_two("sys/fs/cgroup/a", "0");
    EXPECT_EQ(found(), "/a leaves 0.0000");
}

// Docker with version 2: the container's group is the root of what it sees.
TEST_F(ControlGroup, InAContainerTheRootHasALimit) {
    process("0::/\n", "612 610 0:27 / /sys/fs/cgroup ro,nosuid,nodev - cgroup2 cgroup rw,nsdelegate\n");
    group_two("sys/fs/cgroup", mebibytes(400));
    EXPECT_EQ(found(), "/ leaves 330.00");
}

// Docker with version 1: the path is the host's, and of the hierarchy only the container's own group is mounted.
TEST_F(ControlGroup, OfAPathThatAContainerDoesNotSeeTheMountedPartCounts) {
    const std::string cgroup =
        "12:pids:/docker/4f1e\n9:cpu,cpuacct:/docker/4f1e\n5:memory:/docker/4f1e\n1:name=systemd:/docker/4f1e\n";
    const std::string mounts =
        "711 705 0:33 /docker/4f1e /sys/fs/cgroup/cpu,cpuacct ro master:15 - cgroup cgroup rw,cpu,cpuacct\n"
        "715 705 0:37 /docker/4f1e /sys/fs/cgroup/memory ro,nosuid master:19 - cgroup cgroup rw,memory\n";
    process(cgroup, mounts);
    group_one("sys/fs/cgroup/memory", mebibytes(300));
    EXPECT_EQ(found(), "/docker/4f1e leaves 230.00");
    // A group that was made inside it.
    process("5:memory:/docker/4f1e/job\n", mounts);
    group_one("sys/fs/cgroup/memory/job", mebibytes(200));
    EXPECT_EQ(found(), "/docker/4f1e/job leaves 130.00");
    // Seen from elsewhere: another container's path, or one outside of the namespace.
    for (const char* elsewhere : {"/docker/9a3c", "/../9a3c", "/"}) {
        process("5:memory:" + std::string(elsewhere) + "\n", mounts);
        EXPECT_EQ(found(), "/docker/4f1e leaves 230.00");
    }
}

TEST_F(ControlGroup, AGroupThatIsNotMountedIsLookedForAbove) {
    process("0::/a/b/c\n", two_);
    group_two("sys/fs/cgroup/a", mebibytes(300));
    EXPECT_EQ(found(), "/a leaves 230.00");
}

// Both versions at once: the memory controller is version 1's, and version 2's hierarchy has no memory files.
TEST_F(ControlGroup, InAMixedSystemTheMemoryControllersHierarchyCounts) {
    process("9:name=systemd:/\n8:pids:/\n4:memory:/jobs/a\n1:cpu:/\n0::/jobs/a\n",
            "31 23 0:28 / /sys/fs/cgroup rw,relatime - tmpfs tmpfs rw,mode=755\n"
            "35 31 0:32 / /sys/fs/cgroup/memory rw,relatime - cgroup cgroup rw,memory\n"
            "41 31 0:38 / /sys/fs/cgroup/unified rw,relatime - cgroup2 cgroup2 rw\n");
    write("sys/fs/cgroup/unified/jobs/a/cgroup.procs", "1\n");
    group_one("sys/fs/cgroup/memory/jobs/a", unlimited_);
    group_one("sys/fs/cgroup/memory/jobs", mebibytes(200));
    group_one("sys/fs/cgroup/memory", unlimited_);
    EXPECT_EQ(found(), "/jobs leaves 130.00");
}

TEST_F(ControlGroup, OfVersionOneAGroupMayKeepOutOfThoseBelow) {
    process("4:memory:/a/b\n", "35 31 0:32 / /sys/fs/cgroup/memory rw - cgroup cgroup rw,memory\n");
    group_one("sys/fs/cgroup/memory/a/b", mebibytes(400));
    group_one("sys/fs/cgroup/memory/a", mebibytes(200), "0");
    EXPECT_EQ(found(), "/a/b leaves 330.00");
    group_one("sys/fs/cgroup/memory/a", mebibytes(200), "1");
    EXPECT_EQ(found(), "/a leaves 130.00");
}

TEST_F(ControlGroup, MountPointsAndGroupsMayHaveBlanks) {
    process("0::/a b:c\n", "35 24 0:30 / /my\\040groups rw - cgroup2 cgroup2 rw\n");
    group_two("my groups/a b:c", mebibytes(300));
    EXPECT_EQ(found(), "/a b:c leaves 230.00");
}

TEST_F(ControlGroup, WithoutGroupsThereIsNoLimit) {
    EXPECT_EQ(found(), "no limit");
    process("", "");
    EXPECT_EQ(found(), "no limit");
    process("garbage\n:\n0::\n5:memory\n", "garbage\n35 24\n1 2 3 / /x rw -\n - - - - - cgroup2\n" + two_);
    EXPECT_EQ(found(), "no limit");
}

}  // namespace
}  // namespace photonlab
