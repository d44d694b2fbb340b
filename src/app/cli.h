// The command line (docs/reference/command-line.md).
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

#include "app/commands.h"

namespace glint::app {

// Runs `glint ARGS...` and returns the exit code; never throws. Results go to `out`, progress, warnings and
// errors to `err`.
int run(const std::vector<std::string>& args, std::ostream& out, std::ostream& err);

// Declares the program's options and commands. Parsing sets `chosen`, which must outlive `app`, to the work
// of the command that it finds.
void declareProgram(CLI::App& app, Run& chosen);

}  // namespace glint::app
