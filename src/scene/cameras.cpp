#include "scene/cameras.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/text_file.h"
#include "scene/limits.h"

namespace glint {

int pictureWidth(const ImageSettings& image, double aspect) {
    if (!(aspect > 0)) return image.width;
    return static_cast<int>(std::clamp(std::round(image.height * aspect), 1.0, double{kMaxImageSize}));
}

std::string cameraNames(const Scene& scene, size_t most) {
    std::string text;
    for (size_t i = 0; i < scene.cameras.size(); ++i) {
        text += i == 0 ? "" : ", ";
        if (i == most) return text + "...";
        text += '"' + printable(scene.cameras[i].name) + '"';
    }
    return text;
}

void chooseCamera(Scene& scene, const std::string& name, const std::string& file) {
    constexpr size_t kMostNames = 20;  // in a message of one line
    const auto found = std::find_if(scene.cameras.begin(), scene.cameras.end(),
                                    [&](const NamedCamera& camera) { return camera.name == name; });
    if (found == scene.cameras.end())
        throw Error(ErrorKind::Argument,
                    file + ": no camera \"" + printable(name) + "\" (" +
                        (scene.cameras.empty() ? "none in it has a name"
                                               : "there are " + cameraNames(scene, kMostNames)) +
                        ")");
    scene.camera = found->camera;
    scene.image.width = pictureWidth(scene.image, found->aspect);
}

}  // namespace glint
