#include "farm/cut.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "reference/render.h"

namespace glint::farm {

namespace {

// Cost of a pixel whose rays hit nothing, in tests: generating, shading, storing.
constexpr uint64_t kPixelCost = 8;

constexpr double kLeastProbes = 512, kMostProbes = 8192;
// Share of a part's work that every part spends on the estimate in addition.
constexpr double kShare = 0.03;

// Parts of so many rows of tiles end with a row: at most a twelfth of a part's height off.
constexpr int kRowsForWhole = 6;

constexpr int64_t kMostTiles = 1 << 20;

int tilesAlong(int pixels, int tile) {
    return (pixels + tile - 1) / tile;
}

int tileOf(const Region& region) {
    int tile = shared::kTileSize;
    while (int64_t{tilesAlong(region.width(), tile)} * tilesAlong(region.height(), tile) > kMostTiles)
        tile *= 2;
    return tile;
}

Region regionOfTiles(const CostMap& map, int column0, int row0, int column1, int row1) {
    const Region& r = map.region;
    return {r.x0 + column0 * map.tile, r.y0 + row0 * map.tile, std::min(r.x0 + column1 * map.tile, r.x1),
            std::min(r.y0 + row1 * map.tile, r.y1)};
}

// How many pixels of the picture the coarse one has for one, each way.
double coarseness(const Region& region, uint32_t samples, int parts) {
    const auto pixels = static_cast<double>(region.pixels());
    const double probes = std::clamp(kShare * pixels * samples / parts, kLeastProbes, kMostProbes);
    return std::max(1.0, std::sqrt(pixels / probes));
}

// A run of tiles as rectangles: the end of its first row, whole rows, the start of its last row.
std::vector<Region> regionsOf(const CostMap& map, int first, int end) {
    std::vector<Region> regions;
    const auto add = [&](int row0, int row1, int column0, int column1) {
        regions.push_back(regionOfTiles(map, column0, row0, column1, row1));
    };
    while (first < end) {
        const int row = first / map.columns, column = first % map.columns;
        const int wholeRows = column == 0 ? (end - first) / map.columns : 0;
        if (wholeRows > 0) {
            add(row, row + wholeRows, 0, map.columns);
            first += wholeRows * map.columns;
        } else {
            const int last = std::min(map.columns, column + end - first);
            add(row, row + 1, column, last);
            first += last - column;
        }
    }
    return regions;
}

}  // namespace

CostMap::CostMap(const Region& whole)
    : region(whole),
      tile(tileOf(whole)),
      columns(tilesAlong(whole.width(), tile)),
      rows(tilesAlong(whole.height(), tile)) {
    costs.assign(static_cast<size_t>(columns) * rows, 1);
}

CostMap estimateCosts(const PackedScene& scene, const Request& request, int parts) {
    CostMap map(regionOf(request));
    if (parts <= 1 || map.costs.empty()) return map;
    const Region& whole = map.region;
    const double step = coarseness(whole, request.samples.count(), parts);
    const auto scaled = [&](int pixels) { return static_cast<int>(std::floor(pixels / step)); };
    Request coarse;
    static_cast<Tracing&>(coarse) = request;
    coarse.camera = request.camera;
    coarse.width = std::max(1, scaled(request.width));
    coarse.height = std::max(1, scaled(request.height));
    coarse.region = {
        std::min(scaled(whole.x0), coarse.width - 1), std::min(scaled(whole.y0), coarse.height - 1),
        std::min(scaled(whole.x1) + 1, coarse.width), std::min(scaled(whole.y1) + 1, coarse.height)};
    coarse.cost = true;
    const Picture picture = reference::render(scene, coarse);
    const Region& seen = picture.region;
    for (int row = 0; row < map.rows; ++row) {
        for (int column = 0; column < map.columns; ++column) {
            const Region tile = regionOfTiles(map, column, row, column + 1, row + 1);
            const int x = std::clamp(scaled((tile.x0 + tile.x1) / 2), seen.x0, seen.x1 - 1);
            const int y = std::clamp(scaled((tile.y0 + tile.y1) / 2), seen.y0, seen.y1 - 1);
            map.costs[static_cast<size_t>(row) * map.columns + column] =
                tile.pixels() * (kPixelCost + picture.at(x, y).cost);
        }
    }
    return map;
}

std::vector<std::vector<Region>> cutPicture(const CostMap& map, int parts) {
    const double total =
        static_cast<double>(std::accumulate(map.costs.begin(), map.costs.end(), uint64_t{0}));
    const auto tiles = static_cast<int>(map.costs.size());
    // Whole rows where they are fine enough: one region has a third of the dispatches of three.
    const int step = map.rows >= kRowsForWhole * parts ? map.columns : 1;
    std::vector<std::vector<Region>> result;
    double sum = 0;
    int next = 0;
    for (int part = 1; part <= parts; ++part) {
        const int first = next;
        while (next < tiles) {
            const auto from = map.costs.begin() + next;
            const auto cost = static_cast<double>(std::accumulate(from, from + step, uint64_t{0}));
            // It goes to the part that its middle falls into.
            if (part < parts && sum + 0.5 * cost >= total * part / parts) break;
            sum += cost;
            next += step;
        }
        result.push_back(regionsOf(map, first, next));
    }
    return result;
}

std::vector<std::vector<Region>> cutIntoUnits(const CostMap& map, uint32_t samples, int leastParts,
                                              uint64_t bytesPerPixel) {
    constexpr double kTests = 1e8, kLeast = 16, kMany = 1024, kMost = 16384;
    constexpr uint64_t kUnitBytes = uint64_t{1} << 28;
    const auto tests =
        static_cast<double>(std::accumulate(map.costs.begin(), map.costs.end(), uint64_t{0})) * samples;
    // Beyond a thousand units, their number and their cost both grow: each unit costs rank 0 two messages.
    double parts = tests / kTests;
    if (parts > kMany) parts = std::sqrt(kMany * parts);
    int count = std::max(static_cast<int>(std::clamp(parts, kLeast, kMost)), leastParts);
    auto cut = cutPicture(map, count);
    // The cheapest units, of sky, have most pixels.
    while (mostPixelsOf(cut) * bytesPerPixel > kUnitBytes && count < kMostParts) {
        count = std::min(2 * count, kMostParts);
        cut = cutPicture(map, count);
    }
    return cut;
}

uint64_t pixelsOf(const std::vector<Region>& regions) {
    uint64_t pixels = 0;
    for (const Region& r : regions) pixels += r.pixels();
    return pixels;
}

uint64_t mostPixelsOf(const std::vector<std::vector<Region>>& cut) {
    uint64_t most = 0;
    for (const std::vector<Region>& regions : cut) most = std::max(most, pixelsOf(regions));
    return most;
}

}  // namespace glint::farm
