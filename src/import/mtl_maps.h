// The image maps of MTL files.
#pragma once

#include <tiny_obj_loader.h>

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

// Loads the maps of one file's materials. Models often come without their images: one that is missing or
// broken is warned of once, and its material drawn without.
class MtlMaps {
  public:
    MtlMaps(const std::filesystem::path& file, SceneFiles& files, std::vector<Texture>& textures,
            std::vector<std::string>& warnings)
        : file_(file), files_(files), textures_(textures), warnings_(warnings) {}

    // map_Ka, map_Kd, map_Ks as textures; map_d as the diffuse texture's alpha, which is cut at one half.
    void apply(const tinyobj::material_t& from, Material& material);

  private:
    std::optional<Texture> load(const std::string& name, const tinyobj::texture_option_t& options);
    uint32_t add(const std::string& name, const tinyobj::texture_option_t& options);
    void applyAlpha(const tinyobj::material_t& from, Material& material);
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
