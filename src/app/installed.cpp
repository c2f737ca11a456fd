#include "app/installed.h"

#include <fmt/format.h>

#include "core/error.h"
#include "core/files/files.h"

namespace photonlab {

std::filesystem::path program_file() {
    std::error_code error;
    const std::filesystem::path file = std::filesystem::read_symlink("/proc/self/exe", error);
    if (error) throw InputError("/proc/self/exe", "cannot be read: " + error.message());
    return file;
}

std::filesystem::path installed_folder(std::string_view name) {
    const std::filesystem::path folder =
        (program_file().parent_path() / PHOTONLAB_DATA_FROM_PROGRAM / name).lexically_normal();
    if (!is_folder(folder))
        throw InputError(folder.string(), "is not there; expected it where it was installed with the program");
    return folder;
}

}  // namespace photonlab
