// The commands. Each stands in a file of its own, with its options and its work.
#pragma once

#include <functional>
#include <iosfwd>
#include <memory>

#include "app/exit_code.h"
#include "app/option_table.h"

namespace glint::app {

// Does the command's work once its options have their values. Results go to `out`, warnings and progress to
// `err`.
using Run = std::function<ExitCode(std::ostream& out, std::ostream& err)>;

// Declares the options of a Command and returns the function that runs with their values.
template <typename Command>
Run commandOf(OptionTable& table, void (*declare)(OptionTable&, Command&),
              ExitCode (*run)(const Command&, std::ostream&, std::ostream&)) {
    const auto command = std::make_shared<Command>();
    declare(table, *command);
    return [command, run](std::ostream& out, std::ostream& err) { return run(*command, out, err); };
}

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
