// The commands and the texts of `glint --help`, from which man pages and the completions of shells are made
// too.
#pragma once

#include <span>
#include <string>
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

struct ExitCodeText {
    int code;
    const char* meaning;
};

// In the order of the help text.
std::span<const Command> commands();

extern const char* const kDescription;
extern const char* const kCommandHelpHint;
std::span<const char* const> exampleLines();
std::span<const ExitCodeText> exitCodeTexts();

// Options that stand without a command.
struct ProgramFlags {
    bool verbose = false;
};

// `flags` must outlive the parsing. One Run for each of commands().
std::vector<Run> declareProgram(CLI::App& app, ProgramFlags& flags);

struct CommandFacts {
    std::string name, help;
    std::vector<OptionFacts> options;
};

// Every command's options, as they are declared.
std::vector<CommandFacts> commandFacts();

// Options of the program itself: -h, --version, --verbose.
std::vector<OptionFacts> programOptions();

}  // namespace glint::app
