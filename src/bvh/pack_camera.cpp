#include <algorithm>
#include <cmath>
#include <numbers>

#include "bvh/packed_scene.h"

namespace glint {
namespace {

// The window that `fovY` spans at unit distance, centred, with square pixels.
ViewWindow windowOf(const Camera& camera, int width, int height) {
    if (camera.window) return *camera.window;
    const double top = std::tan(camera.fovY * (std::numbers::pi / 360));
    const double right = top * width / height;
    return {-right, right, -top, top};
}

float boundedT(double t) {
    return static_cast<float>(std::min(t, static_cast<double>(shared::kInfinity)));
}

}  // namespace

// P. Shirley and S. Marschner, "Fundamentals of Computer Graphics", 3rd ed., 4.3 and 4.4: frame u, v, w with
// w against the view direction, pixel (i, j) at u = l + (r - l)(i + 0.5) / nx, here with row 0 at the top.
shared::Camera packCamera(const Camera& camera, int width, int height, const glm::dvec3& origin) {
    const glm::dvec3 w = glm::normalize(camera.eye - camera.target);
    const glm::dvec3 u = glm::normalize(glm::cross(camera.up, w));
    const glm::dvec3 v = glm::cross(w, u);
    const ViewWindow window = windowOf(camera, width, height);

    shared::Camera out;
    out.eye = glm::vec3(camera.eye - origin);
    out.center =
        glm::vec3(0.5 * (window.left + window.right) * u + 0.5 * (window.bottom + window.top) * v - w);
    out.stepX = glm::vec3((window.right - window.left) / width * u);
    out.stepY = glm::vec3(-(window.top - window.bottom) / height * v);
    out.halfWidth = 0.5f * static_cast<float>(width);
    out.halfHeight = 0.5f * static_cast<float>(height);
    out.nearT = boundedT(camera.nearT);
    out.farT = boundedT(camera.farT);
    return out;
}

}  // namespace glint
