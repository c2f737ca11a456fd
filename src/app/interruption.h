// SIGINT and SIGTERM end the program after the pass it is at, with what it has saved. A second one ends it at once,
// but for a SIGTERM within a second of the first.

#pragma once

#include <stdexcept>

namespace photonlab {

/// What the program ends with when it was asked to end; its message says what was saved.
class Interrupted : public std::runtime_error {
public:
    using std::runtime_error::runtime_error;
};

/// The exit code of an interrupted program.
inline constexpr int interrupted_exit_code = 3;

/// From here on signals are remembered.
void listen_for_interruptions();

/// True once a signal came.
bool is_interrupted();

}  // namespace photonlab
