// What windows remember. Nothing here is an error: a window must open in a home that is full, or nobody's.
#pragma once

#include <filesystem>
#include <string>

namespace glint::view {

// Where programs keep what they remember (XDG Base Directory Specification 0.8): the file `name` in glint's
// folder in $XDG_STATE_HOME, or else in ~/.local/state. Empty if neither is an absolute path.
std::filesystem::path stateFile(const std::string& name);

// The whole file; empty if there is none that can be read, or it is large.
std::string readState(const std::filesystem::path& file);

// Makes the file, and its folder, if that is possible; an empty name is none.
void writeState(const std::filesystem::path& file, const std::string& text);

}  // namespace glint::view
