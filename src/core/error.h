// Errors that reach the user: one line that says where and what to do, and the exit code that goes with it.
#pragma once

#include <stdexcept>
#include <string>

namespace glint {

// Exit codes of the command line; scripts depend on the values.
enum class ExitCode : int {
    Done = 0,
    Failed = 1,        // could not render or write
    Usage = 2,         // the command line is at fault
    Scene = 3,         // the scene or a file it names is at fault
    Device = 4,        // no usable device, or a Vulkan call failed
    Difference = 5,    // diff or verify found a difference
    Interrupted = 130  // Ctrl-C; the finished part has been saved
};

// Thrown for every failure that a user can cause or must hear of. `what()` is the single line to print.
class Error : public std::runtime_error {
  public:
    Error(ExitCode code, const std::string& message) : std::runtime_error(message), code_(code) {}
    ExitCode code() const { return code_; }

  private:
    ExitCode code_;
};

}  // namespace glint
