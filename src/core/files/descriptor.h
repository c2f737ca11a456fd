// A file as the operating system has it open. Streams do not say whether the disk took what they were given, and have
// nothing that can be locked.

#pragma once

#include <sys/types.h>

#include <filesystem>
#include <optional>
#include <string_view>

namespace photonlab {

/// Which file it is, whatever its name.
struct FileIdentity {
    dev_t device = 0;
    ino_t number = 0;

    bool operator==(const FileIdentity&) const = default;
};

enum class Links { Refused, Followed };

class Descriptor {
public:
    Descriptor() = default;

    /// open() with these flags; errno says why when it is not open. What is written is never written through a link.
    Descriptor(const std::filesystem::path& file, int flags, Links links = Links::Refused);

    Descriptor(Descriptor&& other) noexcept;
    Descriptor& operator=(Descriptor&& other) noexcept;
    ~Descriptor();

    bool is_open() const { return number_ >= 0; }
    int number() const { return number_; }

    /// Empty when it is not open.
    std::optional<FileIdentity> identity() const;

    /// False when the file of this name is another one by now, or there is none.
    bool is_named(const std::filesystem::path& file) const;

    /// Writes all of it from a position on; false when not all was taken, with the reason in errno.
    bool write(std::string_view text, off_t position = 0) const;

private:
    int number_ = -1;
};

}  // namespace photonlab
