// Files of the window: scene files that it watches, files that it lists and names, and its state. Errors of
// remembered files are ignored: a window must open in a home that is full or read-only.
#pragma once

#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/enum_names.h"
#include "scene/scene.h"

namespace glint::view {

// ---- the scene's files ----

// The scene's file and the files that it was read from.
std::vector<std::filesystem::path> sceneFiles(const std::filesystem::path& scene, const Scene& read);

class FileWatch {
  public:
    // Remembers how the files are now.
    void watch(const std::vector<std::filesystem::path>& files);
    // True once for each change: a file has another time or size than at the last call, and both have been
    // the same for two calls, so that a file which is still being written is left in peace.
    bool changed();

  private:
    using Stamp = std::pair<std::filesystem::file_time_type, std::uintmax_t>;  // time, size
    static Stamp stampOf(const std::filesystem::path& file);
    std::map<std::filesystem::path, Stamp> known_, seen_;
};

// ---- files to open and to save ----

// True for images that readImage reads, by their extension.
bool isPictureFile(const std::filesystem::path& file);

// Names of a folder's entries that can be opened: "../", folders ("parts/"), then images and scenes, without
// hidden ones.
std::vector<std::string> listFiles(const std::filesystem::path& folder);

// STEM-view-001.png in `folder`, or the first free number. Creates the file, empty, so that no other process
// takes the name. Throws Error(Failed) if it cannot create a file.
std::filesystem::path claimName(const std::filesystem::path& folder, const std::string& stem,
                                const std::string& extension);

// ---- remembered files ----

// Path of a file of remembered state (XDG Base Directory Specification 0.8): the file `name` in glint's
// folder in $XDG_STATE_HOME, or else in ~/.local/state. Empty if neither is an absolute path.
std::filesystem::path stateFile(const std::string& name);

// Lines of a remembered file, the latest first, each once.
class Remembered {
  public:
    // Leaves out lines that `keeps` does not keep. Without a file name nothing is remembered.
    Remembered(std::filesystem::path file, bool (*keeps)(const std::string& line));

    const std::vector<std::string>& lines() const { return lines_; }
    bool has(std::string_view line) const {
        return std::find(lines_.begin(), lines_.end(), line) != lines_.end();
    }
    // Puts it first and writes the file, with what other windows have added meanwhile.
    void add(const std::string& line);

    static constexpr size_t kMost = 12;

  private:
    void read();

    std::filesystem::path file_;
    bool (*keeps_)(const std::string& line);
    std::vector<std::string> lines_;
};

// Absolute paths of scenes; those of files that are gone are left out.
class RecentFiles : public Remembered {
  public:
    explicit RecentFiles(const std::filesystem::path& file = {});
    const std::vector<std::string>& list() const { return lines(); }
    void add(const std::filesystem::path& scene);
};

// The first steps of a new user.
enum class Hint { Turn, Pick, Save, Compare };
constexpr auto entriesOf(Hint) {
    return std::to_array<EnumEntry<Hint>>(
        {{Hint::Turn, "turn", "Drag: turn around. Wheel: nearer."},
         {Hint::Pick, "pick", "Click: what is there, and where its light comes from."},
         {Hint::Save, "save", "S: save the image."},
         {Hint::Compare, "compare", "K: keep the image. Change something, then B: compare."}});
}

// The steps that were taken, also in earlier windows.
class Hints : public Remembered {
  public:
    explicit Hints(const std::filesystem::path& file = {});
    bool wanted(Hint hint) const { return !has(nameOf(hint)); }
    bool any() const { return lines().size() < kEnumNames<Hint>.size(); }
    // True if that was the last of them.
    bool done(Hint hint);
    // Hides all hints.
    void close();
};

}  // namespace glint::view
