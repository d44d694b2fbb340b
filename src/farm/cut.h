// A picture cut into parts that cost about the same.
#pragma once

#include <cstdint>
#include <vector>

#include "core/device_layout.h"
#include "pack/packed_scene.h"
#include "trace/picture.h"
#include "trace/request.h"

namespace glint::farm {

// Cost of each tile of a region, in tests of boxes and primitives; rows of tiles from the top.
struct CostMap {
    Region region;
    // Pixels along an edge of a tile: that of the device's tiles, or a multiple where there would be more
    // than a million. Parts begin and end between tiles of the device, counted from the corner of the region,
    // so that packets of rays, and with them the layer "cost", are those of the whole picture.
    int tile = shared::kTileSize;
    int columns = 0, rows = 0;
    std::vector<uint64_t> costs;

    // All tiles alike.
    explicit CostMap(const Region& whole);
};

// Renders a coarse image by the reference and counts its tests: a few thousand rays with all that follow from
// them, at most a thirtieth of the rays of a part if parts are many. A constant for the work of every pixel
// is added. The result depends on scene, camera and request alone, not on the device or the number of
// threads.
CostMap estimateCosts(const PackedScene& scene, const Request& request, int parts);

// The regions of each part, at most three: a run of tiles in reading order, whose cost is as near to an equal
// share as whole tiles allow, or whole rows of them where each part has several. A part may be empty where
// there are fewer tiles than parts.
std::vector<std::vector<Region>> cutPicture(const CostMap& map, int parts);

// Cut into units of about a second on a processor, at least `leastParts`, whose pixels hold at most 256 MiB
// at `bytesPerPixel`: renderer and collector hold whole units. `samples`: per pixel.
std::vector<std::vector<Region>> cutIntoUnits(const CostMap& map, uint32_t samples, int leastParts,
                                              uint64_t bytesPerPixel);

uint64_t pixelsOf(const std::vector<Region>& regions);
uint64_t mostPixelsOf(const std::vector<std::vector<Region>>& cut);  // of a part

}  // namespace glint::farm
