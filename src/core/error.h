// The one exception: something cannot start, or a device went away.
#pragma once

#include <stdexcept>
#include <string>

namespace eventide {

/// What the program's exit code says (architecture.md section 5).
enum class ErrorKind {
    failed = 1,  ///< something went wrong while running: a full disk, an encoder
    usage = 2,   ///< an argument or a configuration file
    input = 3,   ///< a recording or model that cannot be read or is not what it says
    device = 4,  ///< a camera that is missing, cannot be used, or was lost
};

/// The message names the thing, what was expected and what was found, and where it helps, what to
/// do.
class Error : public std::runtime_error {
public:
    Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
    ErrorKind kind() const noexcept { return kind_; }

private:
    ErrorKind kind_;
};

}  // namespace eventide
