// The commands and the texts of `glint --help`.
#pragma once

#include <span>
#include <vector>

#include "app/commands.h"

namespace CLI {
class App;
}

namespace glint::app {

struct Command {
    const char* name;
    const char* help;
    Run (*declare)(OptionTable& table);
};

// In the order of the help text.
std::span<const Command> commands();

// Declares the program's options and commands; one Run for each of commands(). `verbose`, for --verbose, must
// outlive the parsing.
std::vector<Run> declareProgram(CLI::App& app, bool& verbose);

}  // namespace glint::app
