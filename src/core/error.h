// Errors that reach the user: one line that says where and what to do, and of what kind the failure is.
#pragma once

#include <stdexcept>
#include <string>

namespace glint {

// Kind of an error. The command line maps kinds to exit codes (app/cli.h).
enum class ErrorKind {
    Failed,      // could not render or write
    Argument,    // what the caller asked for is at fault
    Scene,       // the scene or a file it names is at fault
    Device,      // no usable device, or a Vulkan call failed
    Interrupted  // by the user; what was finished has been saved
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
