#include "app/commands.h"

#include <unistd.h>

#include <cerrno>
#include <iostream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "core/file_io.h"
#include "core/image_io.h"
#include "core/text_file.h"

namespace glint::app {

namespace fs = std::filesystem;

bool isTerminal(const std::ostream& err) {
    return &err == &std::cerr && isatty(STDERR_FILENO) == 1;
}

Progress progressOf(const std::string& label, ProgressMode mode, std::ostream& err) {
    return {label, mode, err, isTerminal(err)};
}

std::string formatSeconds(double seconds) {
    return seconds < 1 ? format("%.0f ms", seconds * 1e3) : format("%.2f s", seconds);
}

void printJson(const nlohmann::json& json, std::ostream& out) {
    out << json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
}

std::string shown(const std::filesystem::path& file) {
    return printable(file.string());
}

std::string warningOf(const fs::path& scene) {
    return "glint: warning: " + shown(scene) + ": ";
}

fs::path inFolder(const fs::path& output, const fs::path& name) {
    std::error_code ignored;
    const bool isFolder = !output.has_filename() || fs::is_directory(output, ignored);
    return isFolder ? output / name : output;
}

void checkPicturePath(const fs::path& path) {
    layerPaths(path, {});
    checkOutputPath(path);
}

void checkOutputPath(const fs::path& path) {
    const StagedFile probe(path);
}

void makeFolder(const fs::path& folder) {
    std::error_code wrong;
    fs::create_directories(folder, wrong);
    if (wrong) failWriting(folder, wrong.value());
    if (access(folder.c_str(), W_OK | X_OK) != 0) failWriting(folder, errno);
}

void checkStandardOutput(const std::ostream& out) {
    if (&out != &std::cout || ::write(STDOUT_FILENO, "", 0) == 0) return;
    throw Error(ErrorKind::Failed,
                "cannot write to standard output: " + std::generic_category().message(errno));
}

}  // namespace glint::app
