#include "view/state_folder.h"

#include <cstdlib>

#include "core/error.h"
#include "core/file_io.h"

namespace glint::view {

namespace {

namespace fs = std::filesystem;

constexpr size_t kMostBytes = 1 << 20;  // of what somebody else may have written

fs::path folderIn(const char* variable) {
    const char* value = std::getenv(variable);
    const fs::path folder = value == nullptr ? "" : value;
    return folder.is_absolute() ? folder : fs::path();
}

// For the owner alone, as the specification asks.
void makeFolder(const fs::path& folder) {
    std::error_code error;
    if (fs::exists(folder, error)) return;
    fs::create_directories(folder, error);
    fs::permissions(folder, fs::perms::owner_all, error);
}

}  // namespace

fs::path stateFile(const std::string& name) {
    const fs::path state = folderIn("XDG_STATE_HOME");
    if (!state.empty()) return state / "glint" / name;
    const fs::path home = folderIn("HOME");
    return home.empty() ? home : home / ".local" / "state" / "glint" / name;
}

std::string readState(const fs::path& file) {
    if (file.empty()) return "";
    try {
        const std::vector<uint8_t> bytes = readFile(file);
        return bytes.size() > kMostBytes ? "" : std::string(bytes.begin(), bytes.end());
    } catch (const Error&) {
        return "";
    }
}

void writeState(const fs::path& file, const std::string& text) {
    if (file.empty()) return;
    makeFolder(file.parent_path());
    try {
        writeTextFile(file, text);
    } catch (const Error&) {
        return;
    }
}

}  // namespace glint::view
