// Adds cameras to a scene file that a person has written.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"

namespace glint {

// A camera as the value of "camera" in a scene file, on one line. Reading it gives the same numbers.
std::string cameraText(const Camera& camera);

// The text of a scene file with `cameras` added, a line each, before its other "cameras". If the file has no
// "cameras", they become its first member. All other text stays, byte for byte. Throws Error(Scene) for text
// that is no JSON object, Error(Argument) for a name that the file has already; `file` stands for the file in
// messages.
std::string withCameras(const std::string& text, const std::string& file,
                        const std::vector<NamedCamera>& cameras);

}  // namespace glint
