#include "view/files.h"

#include <algorithm>
#include <cstdlib>
#include <string>

#include "core/error.h"
#include "core/file_io.h"
#include "core/text_file.h"

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

bool isThere(const fs::path& file) {
    std::error_code error;
    return file.is_absolute() && fs::is_regular_file(file, error);
}

bool endsIn(const fs::path& file, std::initializer_list<const char*> extensions) {
    return std::find(extensions.begin(), extensions.end(), lowerExtension(file)) != extensions.end();
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

RecentFiles::RecentFiles(fs::path file) : file_(std::move(file)) {
    read();
}

void RecentFiles::read() {
    const std::string text = readState(file_);
    if (!text.empty()) list_.clear();
    for (size_t at = 0; at < text.size() && list_.size() < kMost;) {
        const size_t end = std::min(text.find('\n', at), text.size());
        const fs::path path = text.substr(at, end - at);
        at = end + 1;
        if (isThere(path) && std::find(list_.begin(), list_.end(), path) == list_.end())
            list_.push_back(path);
    }
}

void RecentFiles::add(const fs::path& scene) {
    std::error_code error;
    const fs::path path = fs::absolute(scene, error).lexically_normal();
    if (error || path.string().find('\n') != std::string::npos) return;
    read();
    std::erase_if(list_, [&](const fs::path& other) { return other == path || !isThere(other); });
    list_.insert(list_.begin(), path);
    if (list_.size() > kMost) list_.resize(kMost);
    std::string text;
    for (const fs::path& line : list_) text += line.string() + '\n';
    writeState(file_, text);
}

bool isPictureFile(const std::filesystem::path& file) {
    return endsIn(file, {".png", ".exr", ".pfm", ".hdr", ".jpg", ".jpeg", ".webp"});
}

bool isSceneFile(const std::filesystem::path& file) {
    return endsIn(file, {".json", ".gltf", ".glb", ".nff", ".obj", ".ply", ".stl"});
}

std::vector<FileEntry> listFiles(const std::filesystem::path& folder) {
    std::vector<FileEntry> entries;
    std::error_code error;
    for (std::filesystem::directory_iterator i(folder, error), end; !error && i != end; i.increment(error)) {
        const std::filesystem::path& path = i->path();
        if (path.filename().string().rfind('.', 0) == 0) continue;
        std::error_code unknown;
        const bool isFolder = i->is_directory(unknown);
        if (isFolder || isSceneFile(path) || isPictureFile(path)) entries.push_back({path, isFolder});
    }
    std::sort(entries.begin(), entries.end(), [](const FileEntry& a, const FileEntry& b) {
        return a.folder != b.folder ? a.folder : a.path < b.path;
    });
    return entries;
}

}  // namespace glint::view
