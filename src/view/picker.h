// A picked pixel: what was hit, the tree of rays behind its color, and where they are in the image.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "reference/tracer.h"
#include "shared/layout.h"
#include "trace/picture.h"
#include "view/session.h"

namespace glint::view {

// One ray of the tree that makes a pixel's colour, as the reference follows it.
struct PickRay {
    reference::RayClass kind = reference::RayClass::Primary;
    uint32_t depth = 0;         // rays before it
    glm::dvec3 from{0}, to{0};  // world; of a ray that hits nothing, `to` is a little way off
    double share = 0;           // of the pixel's colour that it brings itself, 0..1 (luminance, Rec. 709)
    std::string text;           // "reflected: /objects/3 (sphere) face 0, t = 2.5, chrome"
};

struct Pick {
    int x = 0, y = 0;           // of the picture
    PixelData data;             // from the device
    std::vector<PickRay> rays;  // in the order they are followed: each after the one that it comes from

    bool hit() const { return data.object != PixelData::kNoIndex; }
};

Pick pickPixel(Session& session, int x, int y);

// The two lines that `glint trace --pixel` prints.
std::string pickCsv(const Pick& pick);

struct Segment {
    glm::dvec2 from{0}, to{0};  // pixels, from the picture's top left corner
};

// The part of the line from `from` to `to` (local coordinates, as the camera's) that lies before the eye;
// empty if none does.
std::optional<Segment> projected(const shared::Camera& camera, const glm::dvec3& from, const glm::dvec3& to);

}  // namespace glint::view
