#include "app/common.h"

#include <unistd.h>

#include <cerrno>
#include <iostream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "core/error.h"
#include "core/image_io.h"
#include "core/text_file.h"

namespace glint::app {

namespace {

namespace fs = std::filesystem;

[[noreturn]] void cannotWrite(const fs::path& path, const std::string& reason) {
    throw Error(ErrorKind::Failed, path.string() + ": cannot write: " + reason);
}

std::string reasonOf(int errorNumber) {
    return std::generic_category().message(errorNumber);
}

}  // namespace

bool isTerminal(const std::ostream& err) {
    return &err == &std::cerr && isatty(STDERR_FILENO) == 1;
}

Progress progressOf(const std::string& label, ProgressMode mode, std::ostream& err) {
    return {label, mode, err, isTerminal(err)};
}

std::string formatSeconds(double seconds) {
    return seconds < 1 ? format("%.0f ms", seconds * 1e3) : format("%.2f s", seconds);
}

std::string joined(const std::vector<std::string>& words, const std::string& between) {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
    return text;
}

void printJson(const nlohmann::json& json, std::ostream& out) {
    out << json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
}

std::string shown(const std::filesystem::path& file) {
    return printable(file.string());
}

void checkPicturePath(const fs::path& path) {
    if (!isWritableImagePath(path)) {
        throw Error(ErrorKind::Argument,
                    path.string() + ": unknown picture format (use .png, .exr, .pfm or .hdr)");
    }
    checkOutputPath(path);
}

void checkOutputPath(const fs::path& path) {
    std::error_code ignored;
    const fs::path linked = fs::canonical(path, ignored);  // empty if there is no such file
    const fs::path target = linked.empty() ? path : linked;
    std::error_code wrong;  // such as a name that is too long
    const fs::file_status status = fs::status(target, wrong);
    if (fs::is_directory(status)) cannotWrite(path, "it is a folder");
    if (wrong && status.type() != fs::file_type::not_found) cannotWrite(path, wrong.message());
    if (fs::exists(status)) {
        if (access(target.c_str(), W_OK) != 0) cannotWrite(path, reasonOf(errno));
        if (!fs::is_regular_file(status)) return;  // a device or pipe is written to in place
    }
    const fs::path folder = target.has_parent_path() ? target.parent_path() : fs::path(".");
    if (!fs::exists(folder, ignored)) cannotWrite(path, "there is no folder " + folder.string());
    if (!fs::is_directory(folder, ignored)) cannotWrite(path, folder.string() + " is not a folder");
    if (access(folder.c_str(), W_OK | X_OK) != 0) cannotWrite(path, reasonOf(errno));
}

void checkOutputFolder(const fs::path& folder) {
    std::error_code ignored;
    if (!fs::exists(folder, ignored)) cannotWrite(folder, "there is no such folder");
    if (!fs::is_directory(folder, ignored)) cannotWrite(folder, "not a folder");
    if (access(folder.c_str(), W_OK | X_OK) != 0) cannotWrite(folder, reasonOf(errno));
}

void makeFolder(const fs::path& folder) {
    std::error_code ignored;  // the check below gives the reason
    fs::create_directories(folder, ignored);
    checkOutputFolder(folder);
}

void checkStandardOutput(const std::ostream& out) {
    if (&out != &std::cout || ::write(STDOUT_FILENO, "", 0) == 0) return;
    throw Error(ErrorKind::Failed, "cannot write to standard output: " + reasonOf(errno));
}

}  // namespace glint::app
