// Which files a scene is made of, and whether they have changed.
#pragma once

#include <filesystem>
#include <map>
#include <vector>

namespace glint::view {

// The scene's file and every file it names, as far as they can be found now: any text in a JSON or glTF scene
// that is the path of a file (meshes, pictures, buffers), and the material libraries of OBJ files.
std::vector<std::filesystem::path> sceneFiles(const std::filesystem::path& scene);

class FileWatch {
  public:
    // Remembers how the files are now.
    void watch(const std::vector<std::filesystem::path>& files);
    // True once for each change: a file has another time or size than at the last call, and both have been
    // the same for two calls, so that a file which is still being written is left in peace.
    bool changed();

  private:
    struct Stamp {
        std::filesystem::file_time_type time{};
        std::uintmax_t size = 0;
        bool operator==(const Stamp&) const = default;
    };
    static Stamp stampOf(const std::filesystem::path& file);
    std::map<std::filesystem::path, Stamp> known_, seen_;
};

}  // namespace glint::view
