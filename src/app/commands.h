// The commands. Each stands in a file of its own, with its options and its work.
#pragma once

#include <functional>
#include <iosfwd>
#include <memory>

#include "app/cli.h"
#include "app/options.h"

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

// Declares the program's options and commands. Parsing sets `verbose` for --verbose, and `chosen` to the work
// of the command that it finds; both must outlive `app`.
void declareProgram(CLI::App& app, bool& verbose, Run& chosen);

// This process among those of an MPI launcher; 0 without one.
int rankOfLauncher();
// Ends all ranks with this exit code; does nothing without ranks.
void abortRanks(int exitCode);
// True if the module for MPI is installed.
bool hasRanksModule();

}  // namespace glint::app
