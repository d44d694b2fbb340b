// What can be opened in a folder.
#pragma once

#include <filesystem>
#include <vector>

namespace glint::view {

struct FileEntry {
    std::filesystem::path path;
    bool folder = false;
};

// Pictures that readImage takes, and scenes that loadScene does, by their extension.
bool isPictureFile(const std::filesystem::path& file);
bool isSceneFile(const std::filesystem::path& file);

// Folders, then such files, each by name; hidden ones are left out. Empty where nothing can be read.
std::vector<FileEntry> listFiles(const std::filesystem::path& folder);

}  // namespace glint::view
