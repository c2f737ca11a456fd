#include "core/temporary_file.h"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>

#include "core/error.h"
#include "core/number_in.h"

namespace photonlab {

namespace {

constexpr std::string_view infix = ".partial-";  // followed by the process that writes it

bool is_alive(pid_t process) {
    return ::kill(process, 0) == 0 || errno != ESRCH;
}

}  // namespace

void remove_leftovers(const std::filesystem::path& final_name) {
    const std::string start = final_name.filename().string() + std::string(infix);
    std::error_code ignored;
    const std::filesystem::path folder = final_name.has_parent_path() ? final_name.parent_path() : ".";
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
        const std::string name = entry.path().filename().string();
        if (!name.starts_with(start)) continue;
        const std::optional<pid_t> process = number_in<pid_t>(std::string_view(name).substr(start.size()));
        if (process && *process > 0 && !is_alive(*process)) std::filesystem::remove(entry.path(), ignored);
    }
}

TemporaryFile::TemporaryFile(const std::filesystem::path& final_name)
    : final_name_(final_name), path_(final_name.string() + std::string(infix) + std::to_string(::getpid())) {
    remove_leftovers(final_name);
}

TemporaryFile::~TemporaryFile() {
    std::error_code ignored;
    if (!renamed_) std::filesystem::remove(path_, ignored);
}

void TemporaryFile::rename() {
    const int descriptor = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC);
    const bool is_on_disk = descriptor >= 0 && ::fsync(descriptor) == 0;
    const int reason = errno;
    if (descriptor >= 0) ::close(descriptor);
    if (!is_on_disk) throw InputError(final_name_.string(), std::string("cannot be written: ") + std::strerror(reason));
    std::error_code error;
    std::filesystem::rename(path_, final_name_, error);
    if (error) throw InputError(final_name_.string(), "cannot be written: " + error.message());
    renamed_ = true;
}

}  // namespace photonlab
