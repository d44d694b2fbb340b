#include <algorithm>
#include <cmath>
#include <numbers>

#include "pack/packed_scene.h"
#include "scene/cameras.h"

namespace glint {
namespace {

// The window as given, or the centred one with square pixels that is `height` high or that `fovY` spans at
// unit distance.
ViewWindow windowOf(const Camera& camera, int width, int height) {
    if (camera.window) return *camera.window;
    const bool parallel = camera.projection == Projection::Orthographic;
    const double top = parallel ? camera.height / 2 : std::tan(camera.fovY * (std::numbers::pi / 360));
    const double right = top * width / height;
    return {-right, right, -top, top};
}

float boundedT(double t) {
    return static_cast<float>(std::min(t, static_cast<double>(shared::kInfinity)));
}

// The film lies at unit distance along the view direction, so the ray of a film point d crosses the plane of
// focus at eye + F d, F the focus distance. From eye + l the ray goes there along d - l / F (R. L. Cook, T.
// Porter, L. Carpenter, "Distributed Ray Tracing", SIGGRAPH 1984).
void packLens(const Camera& camera, const CameraFrame& frame, shared::Camera& out) {
    const double focus =
        camera.focusDistance > 0 ? camera.focusDistance : glm::length(camera.target - camera.eye);
    out.lensX = glm::vec3(camera.lensRadius * frame.u);
    out.lensY = glm::vec3(camera.lensRadius * frame.v);
    out.inverseFocus = static_cast<float>(1 / focus);
}

}  // namespace

// P. Shirley and S. Marschner, "Fundamentals of Computer Graphics", 3rd ed., 4.3: the point of pixel (i, j)
// on the image plane is at u = l + (r - l)(i + 0.5) / nx along the frame's u, and correspondingly along v,
// here with row 0 at the top. It moves the direction of perspective rays and the origin of parallel ones.
// Oblique cameras of both kinds keep the view direction and turn the frame (4.3.1, 4.3.2).
shared::Camera packCamera(const Camera& camera, int width, int height, const glm::dvec3& origin) {
    const CameraFrame frame = cameraFrame(camera);
    const ViewWindow window = windowOf(camera, width, height);
    const glm::dvec3 middle =
        0.5 * (window.left + window.right) * frame.u + 0.5 * (window.bottom + window.top) * frame.v;
    const glm::vec3 stepX((window.right - window.left) / width * frame.u);
    const glm::vec3 stepY(-(window.top - window.bottom) / height * frame.v);

    shared::Camera out;
    if (camera.projection == Projection::Orthographic) {
        out.eye = glm::vec3(camera.eye + middle - origin);
        out.center = glm::vec3(frame.view);
        out.originStepX = stepX;
        out.originStepY = stepY;
    } else {
        out.eye = glm::vec3(camera.eye - origin);
        out.center = glm::vec3(middle + frame.view);
        out.stepX = stepX;
        out.stepY = stepY;
        if (camera.lensRadius > 0) packLens(camera, frame, out);
    }
    out.halfWidth = 0.5f * static_cast<float>(width);
    out.halfHeight = 0.5f * static_cast<float>(height);
    out.nearT = boundedT(camera.nearT);
    out.farT = boundedT(camera.farT);
    return out;
}

}  // namespace glint
