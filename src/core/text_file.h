// Whole files in memory, and text for messages about them.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace glint {

// The bytes of a regular file. Throws Error(Scene): "PATH: no such file", "is a folder, not a file", "the
// file is empty" ...
std::string readWholeFile(const std::filesystem::path& path);

// Text of a file for use in a message: control characters, which would break the line or steer the terminal,
// become '?'.
std::string printable(std::string text);

// A number as it is shown in messages: the shortest text that reads back as the same.
std::string describe(double number);

// One step of a JSON pointer (RFC 6901): ~ and / written as ~0 and ~1.
std::string escapePointer(std::string_view key);

// The extension in lower case, with its dot.
std::string lowerExtension(const std::filesystem::path& path);

}  // namespace glint
