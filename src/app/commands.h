// The commands. Each stands in a file of its own, with its options and what it does.
#pragma once

#include <functional>
#include <iosfwd>

#include "app/option_table.h"

namespace glint::app {

// Does the command's work once its options have their values, and returns the exit code (app/exit_code.h).
// Results go to `out`, warnings and progress to `err`.
using Run = std::function<int(std::ostream& out, std::ostream& err)>;

// Declares the options and returns what runs with their values.
Run renderCommand(OptionTable& table);
Run mergeCommand(OptionTable& table);
Run viewCommand(OptionTable& table);
Run verifyCommand(OptionTable& table);
Run reportCommand(OptionTable& table);
Run benchCommand(OptionTable& table);
Run traceCommand(OptionTable& table);
Run diffCommand(OptionTable& table);
Run infoCommand(OptionTable& table);
Run devicesCommand(OptionTable& table);
Run pagesCommand(OptionTable& table);

}  // namespace glint::app
