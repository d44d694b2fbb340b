// The command line (docs/reference/command-line.md).
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "core/error.h"

namespace glint::app {

// Scripts depend on the values (docs/reference/exit-codes.md).
enum class ExitCode : int {
    Done = 0,
    Failed = 1,        // could not render or write
    Usage = 2,         // the command line is invalid
    Scene = 3,         // the scene or a file that it names is faulty
    Device = 4,        // no usable device, or a Vulkan call failed
    Difference = 5,    // diff or verify found a difference, render --strict an error
    Interrupted = 130  // Ctrl-C; the finished part has been saved
};

constexpr ExitCode exitCodeOf(ErrorKind kind) {
    switch (kind) {
        case ErrorKind::Failed:
            return ExitCode::Failed;
        case ErrorKind::Argument:
            return ExitCode::Usage;
        case ErrorKind::Scene:
            return ExitCode::Scene;
        case ErrorKind::Device:
            return ExitCode::Device;
        case ErrorKind::Interrupted:
            return ExitCode::Interrupted;
    }
    return ExitCode::Failed;
}

// Runs `glint ARGS...` and returns the exit code; never throws. Results go to `out`, progress, warnings and
// errors to `err`.
int run(const std::vector<std::string>& args, std::ostream& out, std::ostream& err);

// The commit that the program was built from, as git describes it ("unknown" outside a repository, except in
// an archive that names it).
const char* builtCommit();

}  // namespace glint::app
