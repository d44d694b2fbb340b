// Checks before rendering: output, memory.
#pragma once

#include <cstdint>
#include <filesystem>
#include <iosfwd>

#include "core/available_memory.h"

namespace glint::app {

// Throws Error(Usage) if the extension names no picture format, and Error(Failed) if `path` cannot be written
// as things stand: no such folder, no permission, a folder of that name.
void checkPicturePath(const std::filesystem::path& path);

// The same for a file of any kind: only whether it can be written.
void checkOutputPath(const std::filesystem::path& path);

// Throws Error(Failed) if `folder` is not a folder that can be written to.
void checkOutputFolder(const std::filesystem::path& folder);

// Creates the folder and its parents if they do not exist, and checks it.
void makeFolder(const std::filesystem::path& folder);

// Throws Error(Failed) if `out` is standard output and the system refuses to write there: it is closed, or
// the device behind it is full.
void checkStandardOutput(const std::ostream& out);

}  // namespace glint::app
