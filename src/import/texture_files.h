// Images for textures, each file read once.
#pragma once

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "core/image.h"

namespace glint {

class TextureFiles {
  public:
    // The image in linear samples: PNG and JPEG are decoded from sRGB (their alpha is linear already), HDR,
    // EXR and PFM are linear. Throws Error(Scene) "PATH: reason" if there is none.
    std::shared_ptr<const Image> read(const std::filesystem::path& path);

  private:
    std::map<std::string, std::shared_ptr<const Image>> images_;  // by normal path
};

}  // namespace glint
