// Colours that may be textures, and the environment map, of a scene file.
#pragma once

#include <filesystem>
#include <string>

#include "import/json_cursor.h"
#include "import/scene_files.h"
#include "scene/scene.h"

namespace glint {

class TextureParser {
  public:
    // Textures are added to `scene`; image files are relative to `folder`.
    TextureParser(Scene& scene, const std::filesystem::path& folder, SceneFiles& files)
        : scene_(scene), folder_(folder), files_(files) {}

    // Reads the optional key as a colour, or as a texture and the colour it is multiplied with. True if it is
    // there.
    bool readColor(const JsonCursor& object, std::string_view key, Color& color, uint32_t& texture);
    // "background": a colour or an environment map.
    void readBackground(const JsonCursor& root);

  private:
    Texture parseImage(const JsonCursor& source);
    Texture parseChecker(const JsonCursor& source);
    std::shared_ptr<const Image> load(const JsonCursor& file);

    Scene& scene_;
    const std::filesystem::path& folder_;
    SceneFiles& files_;
};

}  // namespace glint
