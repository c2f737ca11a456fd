// The one exception that bad input raises. The program prints its message and exits with code 2.

#pragma once

#include <stdexcept>
#include <string>

namespace photonlab {

/// Input that cannot be used. The message says where ("file:line: ..."), what was found and what was expected.
class InputError : public std::runtime_error {
public:
    explicit InputError(const std::string& message) : std::runtime_error(message) {}
    InputError(const std::string& place, const std::string& message) : std::runtime_error(place + ": " + message) {}
};

}  // namespace photonlab
