#include "core/machine/version.h"

#include "photonlab_version.h"

namespace photonlab {

ProgramVersion program_version() {
    return {PHOTONLAB_VERSION, PHOTONLAB_COMMIT, PHOTONLAB_COMPILER, PHOTONLAB_COMPILER_FLAGS};
}

}  // namespace photonlab
