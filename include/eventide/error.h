/// @file
/// The one exception of the library: something cannot start, or a device went away.
#pragma once

#include <eventide/version.h>

#include <stdexcept>
#include <string>

namespace eventide {

/// What kind of thing went wrong; the program's exit codes are the same numbers.
enum class ErrorKind {
    failed = 1,  ///< something went wrong while running: a full disk, an encoder
    usage = 2,   ///< an argument, an option or a configuration file: the caller's to change
    input = 3,   ///< a recording or model that cannot be read or is not what it says
    device = 4,  ///< a camera that is missing, cannot be used, or was lost
};

/// The message names the thing, what was expected and what was found, and where it helps, what to
/// do.
class EVENTIDE_API Error : public std::runtime_error {
public:
    /// `message` is what what() says.
    Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
    ErrorKind kind() const noexcept { return kind_; }  ///< of thing that went wrong

private:
    ErrorKind kind_;
};

}  // namespace eventide
