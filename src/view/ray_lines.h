// Where points of the scene are in the picture, for what is drawn over it.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "shared/layout.h"

namespace glint::view {

struct Segment {
    glm::dvec2 from{0}, to{0};  // pixels, from the picture's top left corner
};

// The part of the line from `from` to `to` (local coordinates, as the camera's) that lies before the eye;
// empty if none does.
std::optional<Segment> projected(const shared::Camera& camera, const glm::dvec3& from, const glm::dvec3& to);

}  // namespace glint::view
