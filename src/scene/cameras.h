// Cameras: their coordinate frames, and those of a scene that have names.
#pragma once

#include <glm/glm.hpp>
#include <string>

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

// The width of an image of the height of `image` for a camera with an aspect; without one, the image's width.
int pictureWidth(const ImageSettings& image, double aspect);

// Makes the camera of that name the scene's own, and sets the image's width by its aspect. Throws
// Error(Argument) with the names of all cameras; `file` stands for the scene in the message.
void chooseCamera(Scene& scene, const std::string& name, const std::string& file);

// The names in quotes, with commas; at most `most`, then "...".
std::string cameraNames(const Scene& scene, size_t most);

}  // namespace glint
