// The command line as CLI11 holds it, for man pages and for completions of shells.
#pragma once

#include <string>
#include <vector>

#include "app/commands.h"

namespace CLI {
class Option;
}

namespace glint::app {

// An option as CLI11 holds it.
struct Argument {
    explicit Argument(const CLI::Option& option);

    bool positional = false, many = false, takesValue = false;
    bool file = false, folder = false;  // the value is the name of one
    std::vector<std::string> names;     // "-o" and "--output", or "SCENE"
    std::string form, help;
    std::vector<std::string> choices;  // if the value is one of few
};

std::vector<Argument> argumentsOf(const CLI::App& command);
std::vector<const CLI::App*> commandsOf(const CLI::App& program);

}  // namespace glint::app
