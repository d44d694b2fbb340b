// The command line as man pages and as completions for shells, from the texts of --help.
#pragma once

#include <string>
#include <vector>

#include "app/command_list.h"

namespace glint::app {

struct Page {
    std::string path;  // below a share folder, such as "man/man1/glint.1"
    std::string text;
};

// glint(1), and one for each command.
std::vector<Page> manPages(const std::vector<CommandFacts>& commands);

std::string bashCompletion(const std::vector<CommandFacts>& commands);
std::string zshCompletion(const std::vector<CommandFacts>& commands);
std::string fishCompletion(const std::vector<CommandFacts>& commands);

}  // namespace glint::app
