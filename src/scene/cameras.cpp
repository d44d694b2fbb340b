#include "scene/cameras.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/text_file.h"
#include "scene/limits.h"

namespace glint {

// The squares that normalize takes are safe in double: a valid camera's vectors are 1e-18 to 4e18 long.
CameraFrame cameraFrame(const Camera& camera) {
    CameraFrame frame;
    frame.view = glm::normalize(camera.target - camera.eye);
    frame.w = -frame.view;
    if (camera.planeNormal) {
        const glm::dvec3 normal = glm::normalize(*camera.planeNormal);
        frame.w = glm::dot(normal, frame.view) < 0 ? normal : -normal;
    }
    frame.u = glm::normalize(glm::cross(camera.up, frame.w));
    frame.v = glm::cross(frame.w, frame.u);
    return frame;
}

const char* cameraKind(const Camera& camera) {
    if (camera.projection == Projection::Orthographic)
        return camera.planeNormal ? "oblique parallel" : "orthographic";
    return camera.planeNormal ? "oblique perspective" : "perspective";
}

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
    const auto found = std::ranges::find(scene.cameras, name, &NamedCamera::name);
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
