// The image maps of MTL files.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "import/scene_files.h"
#include "scene/scene.h"

namespace glint {

// An image as a material names it.
struct MtlMap {
    std::string file;
    glm::dvec2 scale{1}, offset{0};
    bool clamp = false;
};
using MtlMapTable = std::map<std::string, MtlMap>;  // by key, in lower case: "map_kd"

// Loads the maps of one file's materials. A missing or damaged image gives one warning, and its material is
// drawn without it, as models often come without their images.
class MtlMaps {
  public:
    MtlMaps(const std::filesystem::path& file, SceneFiles& files, std::vector<Texture>& textures,
            std::vector<std::string>& warnings)
        : file_(file), files_(files), textures_(textures), warnings_(warnings) {}

    // map_ka, map_kd, map_ks as textures; map_d as the diffuse texture's alpha, which is cut at one half.
    void apply(const MtlMapTable& maps, Material& material);

  private:
    std::optional<Texture> load(const MtlMap& map);
    uint32_t add(const MtlMapTable& maps, const char* key);
    void applyAlpha(const MtlMap& cover, const std::string& diffuseFile, Material& material);
    std::shared_ptr<const Image> combined(const Image* color, const std::shared_ptr<const Image>& cover);

    std::filesystem::path file_;
    SceneFiles& files_;
    std::vector<Texture>& textures_;
    std::vector<std::string>& warnings_;
    std::set<std::string> warned_;
    // Colours with their coverage, by both: many materials may share one.
    std::map<std::pair<const Image*, const Image*>, std::shared_ptr<const Image>> combined_;
};

}  // namespace glint
