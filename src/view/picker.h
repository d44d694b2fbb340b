// What lies under the mouse.
#pragma once

#include <string>
#include <vector>

#include "trace/picture.h"
#include "view/session.h"

namespace glint::view {

struct Pick {
    int x = 0, y = 0;           // of the picture
    int width = 0, height = 0;  // its size
    PixelData data;             // from the device
    std::string object;         // its name and kind: "/objects/3 (sphere)"
    std::string material;
    std::vector<std::string> path;  // one line for each ray, from the reference

    bool hit() const { return data.object != PixelData::kNoIndex; }
};

Pick pickPixel(Session& session, int x, int y);

// The two lines that `glint trace --pixel` prints.
std::string pickCsv(const Pick& pick);

}  // namespace glint::view
