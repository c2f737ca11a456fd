// What belongs to the program and stands in files: the analysis, the examples, and what a new study begins with. It is
// looked for from the program's own folder, so that all of it can be installed and moved together; where the program is
// built, links to the repository's files stand in the same places.

#pragma once

#include <filesystem>
#include <string_view>

namespace photonlab {

/// The file of this program, without links. Throws InputError where the system does not tell.
std::filesystem::path program_file();

/// "analysis", "experiments", "reference", "scenes" or "study". Throws InputError when it is not there.
std::filesystem::path installed_folder(std::string_view name);

}  // namespace photonlab
