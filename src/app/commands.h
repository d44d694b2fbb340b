// The commands, each with its options and its work in a file named after it (merge in units.cpp), and steps
// that several take.
#pragma once

#include <filesystem>
#include <functional>
#include <iosfwd>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "app/options.h"
#include "core/error.h"
#include "core/format.h"
#include "core/progress.h"

namespace glint::app {

// Scripts depend on the values (docs/reference/exit-codes.md), most of which are those of ErrorKind.
enum class ExitCode : int {
    Done = 0,
    Failed = 1,
    Usage = 2,
    Scene = 3,
    Device = 4,
    Difference = 5,  // diff or verify found a difference, render --strict an error
    Interrupted = 130
};

constexpr ExitCode exitCodeOf(ErrorKind kind) {
    return static_cast<ExitCode>(kind);
}

// Does the command's work once its options have their values. Results go to `out`, warnings and progress to
// `err`.
using Run = std::function<ExitCode(std::ostream& out, std::ostream& err)>;

// Declares the options of a Command and returns the function that runs with their values.
template <typename Command>
Run commandOf(OptionTable& table, void (*declare)(OptionTable&, Command&),
              ExitCode (*run)(const Command&, std::ostream&, std::ostream&)) {
    const auto command = std::make_shared<Command>();
    declare(table, *command);
    return [command, run](std::ostream& out, std::ostream& err) { return run(*command, out, err); };
}

Run renderCommand(OptionTable& table);
Run mergeCommand(OptionTable& table);
Run viewCommand(OptionTable& table);
Run verifyCommand(OptionTable& table);
Run reportCommand(OptionTable& table);
Run benchCommand(OptionTable& table);
Run traceCommand(OptionTable& table);
Run diffCommand(OptionTable& table);
Run infoCommand(OptionTable& table);
Run devicesCommand(OptionTable& table);
Run pagesCommand(OptionTable& table);

// The commit that the program was built from, as git describes it ("unknown" outside a repository, except in
// an archive that names it).
const char* builtCommit();

// Prints the completions of the last word of an unfinished command line, one a line, each with a tab and its
// help: commands, options or an option's values.
void complete(const CLI::App& program, const std::vector<std::string>& words, std::ostream& out);

// This process among those of an MPI launcher; 0 without one.
int rankOfLauncher();
// Ends all ranks with this exit code; does nothing without ranks.
void abortRanks(int exitCode);
// True if the module for MPI is installed.
bool hasRanksModule();

// ---- steps that several commands take

// True if standard error is a terminal and `err` is it.
bool isTerminal(const std::ostream& err);

// Progress on `err`.
Progress progressOf(const std::string& label, ProgressMode mode, std::ostream& err);

std::string formatSeconds(double seconds);

// Prints a document; bytes of file names that are not UTF-8 are replaced.
void printJson(const nlohmann::json& json, std::ostream& out);

// A file's name for the terminal: it may be a stranger's too.
std::string shown(const std::filesystem::path& file);

// "glint: warning: SCENE: "
std::string warningOf(const std::filesystem::path& scene);

// `output`, or the file `name` in it if it is a folder or ends in a slash.
std::filesystem::path inFolder(const std::filesystem::path& output, const std::filesystem::path& name);

// Throws Error(Argument) if the extension names no image format, and the errors of checkOutputPath().
void checkPicturePath(const std::filesystem::path& path);

// Throws Error(Failed) if no file can be written there: no such folder, no permission, a folder of that name.
void checkOutputPath(const std::filesystem::path& path);

// Creates the folder and its parents if they do not exist. Throws Error(Failed) if it cannot be written to.
void makeFolder(const std::filesystem::path& folder);

// Throws Error(Failed) if `out` is standard output and the system refuses to write there: it is closed, or
// the device behind it is full.
void checkStandardOutput(const std::ostream& out);

}  // namespace glint::app
