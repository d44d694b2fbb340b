#include "view/file_list.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

namespace glint::view {

namespace {

template <size_t N>
bool endsIn(const std::filesystem::path& file, const std::array<const char*, N>& extensions) {
    std::string extension = file.extension().string();
    std::transform(extension.begin(), extension.end(), extension.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return std::find(extensions.begin(), extensions.end(), extension) != extensions.end();
}

}  // namespace

bool isPictureFile(const std::filesystem::path& file) {
    return endsIn(file, std::array{".png", ".exr", ".pfm", ".hdr", ".jpg", ".jpeg"});
}

bool isSceneFile(const std::filesystem::path& file) {
    return endsIn(file, std::array{".json", ".gltf", ".glb", ".nff", ".obj", ".ply", ".stl"});
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
