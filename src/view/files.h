// Files that windows remember and list. Errors are ignored: a window must open in a home that is full or
// read-only.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace glint::view {

// Path of a file of remembered state (XDG Base Directory Specification 0.8): the file `name` in glint's
// folder in $XDG_STATE_HOME, or else in ~/.local/state. Empty if neither is an absolute path.
std::filesystem::path stateFile(const std::string& name);

// The whole file; empty if there is none that can be read, or it is large.
std::string readState(const std::filesystem::path& file);

// Makes the file, and its folder, if that is possible; an empty name is none.
void writeState(const std::filesystem::path& file, const std::string& text);

class RecentFiles {
  public:
    // `file` holds the list, a path a line; empty: nothing is remembered. That it cannot be read or written
    // is no error.
    explicit RecentFiles(std::filesystem::path file = {});

    // Absolute paths, the latest first, each once; files that are gone are left out.
    const std::vector<std::filesystem::path>& list() const { return list_; }
    // Puts it first and writes the list, with what other windows have added meanwhile.
    void add(const std::filesystem::path& scene);

    static constexpr size_t kMost = 12;

  private:
    void read();

    std::filesystem::path file_;
    std::vector<std::filesystem::path> list_;
};

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
