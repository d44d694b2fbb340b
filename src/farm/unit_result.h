// Units of work, and what comes of them. A picture's pixels do not depend on each other, so a unit is a part
// of it: some of its pixels, with all their samples. Samples are not divided: a pixel's sum has one
// order, and another one would have other bits.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/image.h"
#include "trace/picture.h"
#include "trace/request.h"

namespace glint::farm {

// Device and driver that rendered a unit.
struct Producer {
    std::string device, driver;
    // Its bits are those of all devices that keep Vulkan's promises (docs/design/reproducibility.md).
    bool sharesBits = false;
    bool operator==(const Producer&) const = default;
};

// Names and channel counts of an image's layers, except "color" and "alpha".
using LayerShapes = std::vector<std::pair<std::string, int>>;

struct Block {
    Region region;
    Image color;                // linear radiance and alpha, as in Picture, finite
    std::vector<Layer> layers;  // as LayerShapes says
};

struct UnitResult {
    int part = 1;  // from 1
    Producer producer;
    std::vector<Block> blocks;
    uint64_t notFinite = 0;  // as in Picture
    glm::ivec2 firstNotFinite{-1};
    TreeLosses losses;
};

// Draws what the request asks for: a tracer.
using Draw = std::function<Picture(const Request&)>;

// Layers that a picture of these AOVs has besides colour and alpha.
LayerShapes layerShapes(const std::vector<Aov>& aovs);

// Draws the regions of a unit of the whole picture that is asked for. Nothing if it was cancelled.
std::optional<UnitResult> drawUnit(const Draw& draw, const Request& whole, const std::vector<Region>& regions,
                                   const std::vector<Aov>& aovs);

}  // namespace glint::farm
