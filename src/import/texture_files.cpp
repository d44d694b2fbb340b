#include "import/texture_files.h"

#include "core/error.h"
#include "core/image_io.h"

namespace glint {

std::shared_ptr<const Image> TextureFiles::read(const std::filesystem::path& path) {
    const std::string key = path.lexically_normal().string();
    const auto known = images_.find(key);
    if (known != images_.end()) return known->second;
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored))
        throw Error(ErrorKind::Scene, path.string() + ": no such file");
    try {
        auto image = std::make_shared<const Image>(readImage(path));
        images_.emplace(key, image);
        return image;
    } catch (const Error& e) {
        throw Error(ErrorKind::Scene, e.what());
    }
}

}  // namespace glint
