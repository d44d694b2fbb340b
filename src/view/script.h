// The language of `glint view --script`: one command a line, `#` begins a comment (docs/guide/window.md).
#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace glint::view {

struct ScriptWord {
    const char* name;
    const char* form;  // of its arguments
    size_t least, most;
    const char* help;
};
std::span<const ScriptWord> scriptWords();

struct ScriptCommand {
    std::string name;
    std::vector<std::string> arguments;
    std::string rest;   // of the line after the name
    std::string place;  // "demo.txt:3"
};

// Throws Error(Usage) "NAME:LINE: ..." for an unknown command or a wrong number of arguments.
std::vector<ScriptCommand> parseScript(const std::string& text, const std::string& name);
std::vector<ScriptCommand> readScript(const std::filesystem::path& file);

// A number argument; throws Error(Usage) with the command's place.
double numberOf(const ScriptCommand& command, size_t argument);
int wholeOf(const ScriptCommand& command, size_t argument);

}  // namespace glint::view
