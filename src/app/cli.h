// The command line (docs/reference/command-line.md).
#pragma once

#include <iosfwd>
#include <string>
#include <vector>

namespace glint::app {

// Runs `glint ARGS...` and returns the exit code; never throws. Results go to `out`, progress, warnings and
// errors to `err`.
int run(const std::vector<std::string>& args, std::ostream& out, std::ostream& err);

}  // namespace glint::app
