// The coordinate frame of a camera.
#pragma once

#include <glm/glm.hpp>

#include "scene/scene.h"

namespace glint {

// Right-handed and orthonormal: u to the right of the picture, v up, w the image plane's normal on the
// viewer's side. `view` is the unit view direction: -w, but for an oblique camera.
struct CameraFrame {
    glm::dvec3 u, v, w, view;
};

// Frame of a valid camera (P. Shirley, S. Marschner, "Fundamentals of Computer Graphics", 3rd ed., 4.3).
CameraFrame cameraFrame(const Camera& camera);

// "perspective", "orthographic", "oblique perspective" or "oblique parallel".
const char* cameraKind(const Camera& camera);

}  // namespace glint
