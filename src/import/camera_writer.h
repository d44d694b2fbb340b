// Cameras into a scene file that its owner has written by hand.
#pragma once

#include <string>
#include <vector>

#include "scene/scene.h"

namespace glint {

// A camera as the value of "camera" in a scene file, on one line. What is read from it has the same numbers.
std::string cameraText(const Camera& camera);

// The text of a scene file with `cameras` added at the end of its "cameras", which come after "camera" if
// there are none yet. What was there stays as it is, byte for byte: order, comments, indentation, line ends;
// the new lines are indented as their neighbours are. Throws Error(Scene) for text that is no JSON object,
// Error(Argument) for a name that is there already; `file` stands for the file in messages.
std::string withCameras(const std::string& text, const std::string& file,
                        const std::vector<NamedCamera>& cameras);

}  // namespace glint
