// Whole files in memory, and the messages for those that cannot be read.
#pragma once

#include <filesystem>
#include <string>

namespace glint {

// The bytes of a regular file. Throws Error(Scene): "PATH: no such file", "is a folder, not a file", "the
// file is empty" ...
std::string readWholeFile(const std::filesystem::path& path);

// Text of a file for use in a message: control characters, which would break the line or steer the terminal,
// become '?'.
std::string printable(std::string text);

// The extension in lower case, with its dot.
std::string lowerExtension(const std::filesystem::path& path);

}  // namespace glint
