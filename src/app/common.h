// Steps that several commands take.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/format.h"
#include "core/progress.h"

namespace glint::app {

// True if standard error is a terminal and `err` is it.
bool isTerminal(const std::ostream& err);

// Progress on `err`.
Progress progressOf(const std::string& label, ProgressMode mode, std::ostream& err);

std::string formatSeconds(double seconds);

// "a, b, c"
std::string joined(const std::vector<std::string>& words, const std::string& between = ", ");

// Prints a document; bytes of file names that are not UTF-8 are replaced.
void printJson(const nlohmann::json& json, std::ostream& out);

// A file's name for the terminal: it may be a stranger's too.
std::string shown(const std::filesystem::path& file);

// Throws Error(Argument) if the extension names no image format, and what checkOutputPath() throws.
void checkPicturePath(const std::filesystem::path& path);

// Throws Error(Failed) if no file can be written there: no such folder, no permission, a folder of that name.
void checkOutputPath(const std::filesystem::path& path);

// Creates the folder and its parents if they do not exist. Throws Error(Failed) if it cannot be written to.
void makeFolder(const std::filesystem::path& folder);

// Throws Error(Failed) if `out` is standard output and the system refuses to write there: it is closed, or
// the device behind it is full.
void checkStandardOutput(const std::ostream& out);

}  // namespace glint::app
