// Which program this is: what a record needs to say so that a run can be repeated.

#pragma once

#include <string_view>

namespace photonlab {

struct ProgramVersion {
    std::string_view version;   ///< of the release
    std::string_view commit;    ///< of git, "+changes" appended when files differ from it; "unknown" without git
    std::string_view compiler;  ///< name and version
    std::string_view compiler_flags;
};

ProgramVersion program_version();

}  // namespace photonlab
