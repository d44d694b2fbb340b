// Units of work, and their results. The pixels of an image do not depend on each other, so a unit is a part
// of it: some of its pixels, with all their samples. Samples are not divided: a pixel's sum has one order,
// and another one would have other bits.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/image.h"
#include "trace/picture.h"
#include "trace/request.h"

namespace glint::farm {

// Identity of an image: the facts that it is made from, in a fixed order, such as {"size", "640x480"} or
// {"file bunny.obj", "1f2e..."}. Results are merged only if they agree on all of them.
struct Identity {
    std::vector<std::pair<std::string, std::string>> facts;
    bool operator==(const Identity&) const = default;
};

// The first fact that differs, for people: "size is 640x480 there and 800x600 here"; empty if none does.
// Facts about files are hashes, so the message is "file bunny.obj has other contents".
std::string difference(const Identity& there, const Identity& here);

// The image that units belong to.
struct UnitHeader {
    Identity identity;
    Region region;          // all units together
    std::vector<Aov> aovs;  // the image's layers in the order of the request
    int parts = 1;          // number of units
};

// Device and driver that rendered a unit.
struct Producer {
    std::string device, driver;
    // Its bits are those of all devices that keep Vulkan's promises (docs/design/reproducibility.md).
    bool sharesBits = false;
    bool operator==(const Producer&) const = default;
};

// Names and channel counts of an image's layers, except "color" and "alpha".
using LayerShapes = std::vector<std::pair<std::string, int>>;
LayerShapes layerShapes(const std::vector<Aov>& aovs);

struct Block {
    Region region;
    Image color;                // linear radiance and alpha, as in Picture, finite
    std::vector<Layer> layers;  // as LayerShapes says
};

struct UnitResult : PictureFlaws {
    int part = 1;  // from 1
    Producer producer;
    std::vector<Block> blocks;
};

// A tracer: renders a request.
using Draw = std::function<Picture(const Request&)>;

// Renders the regions of a unit of the whole requested image. Nothing if it was cancelled.
std::optional<UnitResult> drawUnit(const Draw& draw, const Request& whole, const std::vector<Region>& regions,
                                   const std::vector<Aov>& aovs);

}  // namespace glint::farm
