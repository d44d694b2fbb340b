// Errors that reach the user: one line that names the place and the remedy, and the kind of failure.
#pragma once

#include <stdexcept>
#include <string>

namespace glint {

// Kind of an error. The command line maps kinds to exit codes (app/commands.h).
enum class ErrorKind {
    Failed,      // could not render or write
    Argument,    // the caller's request is invalid
    Scene,       // the scene or a file that it names is faulty
    Device,      // no usable device, or a Vulkan call failed
    Interrupted  // by the user; finished work has been saved
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
