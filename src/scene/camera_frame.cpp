#include "scene/camera_frame.h"

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

}  // namespace glint
