// The cameras of a scene that have names.
#pragma once

#include <string>

#include "scene/scene.h"

namespace glint {

// The width of a picture as high as `image` for a camera that asks for an aspect; without one, the image's.
int pictureWidth(const ImageSettings& image, double aspect);

// Makes the camera of that name the scene's own, and the picture as wide as it asks. Throws Error(Argument)
// with the names that there are; `file` stands for the scene in the message.
void chooseCamera(Scene& scene, const std::string& name, const std::string& file);

// The names in quotes, with commas; at most `most`, then "...".
std::string cameraNames(const Scene& scene, size_t most);

}  // namespace glint
