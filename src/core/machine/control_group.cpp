#include "core/machine/control_group.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <string_view>
#include <vector>

namespace photonlab {

namespace {

enum class Version { One, Two };

/// A group of the process, from the root of its hierarchy.
struct Membership {
    Version version;
    std::filesystem::path group;
};

/// A hierarchy that is mounted, from its group `top` on.
struct Mount {
    Version version;
    std::filesystem::path top;
    std::filesystem::path folder;
};

/// The names of a version's files.
struct Files {
    std::vector<const char*> limits;
    const char* used;
    std::string_view droppable;  ///< in memory.stat, of the group with all below it
};

const Files& files_of(Version version) {
    static const Files one{{"memory.limit_in_bytes"}, "memory.usage_in_bytes", "total_inactive_file"};
    static const Files two{{"memory.max", "memory.high"}, "memory.current", "inactive_file"};
    return version == Version::One ? one : two;
}

bool has_word(const std::string& list, std::string_view wanted) {
    std::istringstream stream(list);
    for (std::string word; std::getline(stream, word, ',');)
        if (word == wanted) return true;
    return false;
}

/// Lines such as "4:memory:/user/a" (version 1, with the controllers of its hierarchy) and "0::/user/a" (version 2).
std::vector<Membership> memberships(const std::filesystem::path& root) {
    std::vector<Membership> found;
    std::ifstream stream(root / "proc/self/cgroup");
    for (std::string line; std::getline(stream, line);) {
        const std::size_t first = line.find(':');
        const std::size_t second = line.find(':', first + 1);
        if (first == std::string::npos || second == std::string::npos) continue;
        const std::string controllers = line.substr(first + 1, second - first - 1);
        if (controllers.empty())
            found.push_back({Version::Two, line.substr(second + 1)});
        else if (has_word(controllers, "memory"))
            found.push_back({Version::One, line.substr(second + 1)});
    }
    return found;
}

/// Blanks and backslashes are written as \040 and the like.
std::string unescaped(const std::string& text) {
    const auto is_octal = [](char c) { return c >= '0' && c <= '7'; };
    std::string plain;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool is_escape = text[i] == '\\' && i + 3 < text.size() && is_octal(text[i + 1]) &&
                               is_octal(text[i + 2]) && is_octal(text[i + 3]);
        plain += is_escape ? static_cast<char>((text[i + 1] - '0') * 64 + (text[i + 2] - '0') * 8 + text[i + 3] - '0')
                           : text[i];
        if (is_escape) i += 3;
    }
    return plain;
}

/// Lines such as "35 31 0:32 /docker/a /sys/fs/cgroup/memory rw,relatime master:5 - cgroup cgroup rw,memory": the
/// fourth word is the group that is mounted, the fifth where; after the dash come the kind, the source and the options.
std::vector<Mount> mounts(const std::filesystem::path& root) {
    std::vector<Mount> found;
    std::ifstream stream(root / "proc/self/mountinfo");
    for (std::string line; std::getline(stream, line);) {
        std::istringstream words(line);
        std::string word, top, folder, kind, source, options;
        words >> word >> word >> word >> top >> folder;
        while (words >> word && word != "-") {
        }
        words >> kind >> source >> options;
        const bool is_two = kind == "cgroup2";
        if (!is_two && !(kind == "cgroup" && has_word(options, "memory"))) continue;
        found.push_back({is_two ? Version::Two : Version::One, unescaped(top),
                         root / std::filesystem::path(unescaped(folder)).relative_path()});
    }
    return found;
}

/// The number in a file of the kernel; empty for "max" or no file.
std::optional<double> number_in_file(const std::filesystem::path& file) {
    double number = 0.0;
    return std::ifstream(file) >> number ? std::optional(number) : std::nullopt;
}

double statistic(const std::filesystem::path& folder, std::string_view wanted) {
    std::ifstream stream(folder / "memory.stat");
    std::string name;
    for (double value = 0.0; stream >> name >> value;)
        if (name == wanted) return value;
    return 0.0;
}

/// What the group of this folder leaves; empty without a limit.
std::optional<double> left_in(const std::filesystem::path& folder, Version version) {
    const Files& files = files_of(version);
    std::optional<double> limit;
    for (const char* name : files.limits)
        if (const auto number = number_in_file(folder / name)) limit = std::min(limit.value_or(*number), *number);
    const std::optional<double> used = number_in_file(folder / files.used);
    if (!limit || !used) return std::nullopt;
    return std::max(0.0, *limit - std::max(0.0, *used - statistic(folder, files.droppable)));
}

/// The group by its path from the mounted one on, or what of that is there; the mounted one itself when the path leads
/// elsewhere, as seen from outside a container.
std::filesystem::path below(const Mount& mount, const std::filesystem::path& group) {
    std::filesystem::path path = group.lexically_relative(mount.top);
    if (path.empty() || *path.begin() == ".." || path == ".") return {};
    while (!path.empty() && !std::filesystem::is_directory(mount.folder / path)) path = path.parent_path();
    return path;
}

}  // namespace

std::optional<MemoryLeft> memory_left_by_control_groups(const std::filesystem::path& root) {
    const std::vector<Mount> mounted = mounts(root);
    std::optional<MemoryLeft> least;
    for (const Membership& member : memberships(root))
        for (const Mount& mount : mounted) {
            if (mount.version != member.version) continue;
            std::filesystem::path path = below(mount, member.group);
            while (true) {
                const std::filesystem::path folder = mount.folder / path;
                const auto left = left_in(folder, mount.version);
                if (left && (!least || *left < least->bytes))
                    least = {*left, (path.empty() ? mount.top : mount.top / path).string()};
                if (path.empty()) break;
                path = path.parent_path();
                // In version 1 a group may keep out of what is below it.
                if (number_in_file(mount.folder / path / "memory.use_hierarchy") == 0.0) break;
            }
        }
    return least;
}

}  // namespace photonlab
