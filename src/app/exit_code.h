// Exit codes of the command line; scripts depend on the values (docs/reference/command-line.md).
#pragma once

#include "core/error.h"

namespace glint::app {

enum class ExitCode : int {
    Done = 0,
    Failed = 1,        // could not render or write
    Usage = 2,         // the command line is at fault
    Scene = 3,         // the scene or a file it names is at fault
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

}  // namespace glint::app
