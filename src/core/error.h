// Errors that reach the user: one line that names the place and the remedy, and the kind of failure.
#pragma once

#include <stdexcept>
#include <string>

namespace glint {

// Kind of an error; the value is the exit code of the command line (docs/reference/exit-codes.md).
enum class ErrorKind {
    Failed = 1,        // could not render or write
    Argument = 2,      // the caller's request is invalid
    Scene = 3,         // the scene or a file that it names is faulty
    Device = 4,        // no usable device, or a Vulkan call failed
    Interrupted = 130  // by the user; finished work has been saved
};

// Thrown for every failure that a user can cause or must hear of. `what()` is the single line to print.
class Error : public std::runtime_error {
  public:
    Error(ErrorKind kind, const std::string& message) : std::runtime_error(message), kind_(kind) {}
    ErrorKind kind() const { return kind_; }

  private:
    ErrorKind kind_;
};

}  // namespace glint
