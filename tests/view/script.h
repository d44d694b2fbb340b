// The language of scripts that drive the window in tests: one command a line, `#` starts a comment.
// script.cpp lists the commands. A script makes the same events as a user; coordinates are pixels of the
// image.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace glint::view::test {

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

struct KeyPress {
    int key = 0;
    int mods = 0;
};

// A key by its name in keyBindings(), in any case, and those of flying ("W"). Empty for an unknown name.
std::optional<KeyPress> keyNamed(const std::string& name);

}  // namespace glint::view::test
