#include <algorithm>
#include <numeric>

#include "farm/cut.h"
#include "support.h"

namespace glint::farm::test::cut_test {
// How often each pixel of the region is in a part.
std::vector<int> coverage(const std::vector<std::vector<Region>>& cut, const Region& whole) {
    std::vector<int> times(static_cast<size_t>(whole.width()) * whole.height());
    for (const auto& regions : cut)
        for (const Region& r : regions)
            for (int y = r.y0; y < r.y1; ++y)
                for (int x = r.x0; x < r.x1; ++x)
                    ++times.at(static_cast<size_t>(y - whole.y0) * whole.width() + (x - whole.x0));
    return times;
}

TEST(Cut, EveryPixelIsInOnePartOfAnyNumber) {
    for (const Region whole : {Region{0, 0, 61, 47}, Region{13, 5, 14, 6}, Region{3, 7, 203, 15}}) {
        CostMap map(whole);
        for (size_t i = 0; i < map.costs.size(); ++i) map.costs[i] = 1 + (i * 37) % 101;
        for (const int parts : {1, 2, 3, 7, 48, 1000}) {
            const auto cut = cutPicture(map, parts);
            ASSERT_EQ(cut.size(), static_cast<size_t>(parts));
            const std::vector<int> times = coverage(cut, whole);
            EXPECT_EQ(std::count(times.begin(), times.end(), 1), static_cast<std::ptrdiff_t>(times.size()))
                << whole.x0 << ' ' << parts;
            for (const auto& regions : cut) EXPECT_LE(regions.size(), 3u);
        }
    }
}

// No part is further from its share than the dearest tile.
TEST(Cut, PartsHaveEqualShares) {
    CostMap map({0, 0, 320, 240});
    for (size_t i = 0; i < map.costs.size(); ++i) map.costs[i] = 1 + i * i % 1009;
    const uint64_t total = std::accumulate(map.costs.begin(), map.costs.end(), uint64_t{0});
    for (const auto& regions : cutPicture(map, 8)) {
        uint64_t cost = 0;
        for (const Region& r : regions)
            for (int y = r.y0; y < r.y1; y += map.tile)
                for (int x = r.x0; x < r.x1; x += map.tile)
                    cost += map.costs[static_cast<size_t>(y / map.tile) * map.columns + x / map.tile];
        EXPECT_NEAR(static_cast<double>(cost), static_cast<double>(total) / 8, 1009);
    }
}

TEST(Cut, FewPartsAreWholeRows) {
    for (const auto& regions : cutPicture(CostMap({5, 3, 105, 403}), 8)) {
        ASSERT_EQ(regions.size(), 1u);
        EXPECT_EQ(regions[0].width(), 100);
    }
}

uint64_t testsIn(const Picture& picture, const std::vector<Region>& regions) {
    uint64_t tests = 0;
    for (const Region& r : regions)
        for (int y = r.y0; y < r.y1; ++y)
            for (int x = r.x0; x < r.x1; ++x) tests += 8 + picture.at(x, y).cost;
    return tests;
}

// The dearest part decides when the picture is done. The estimate from some 1,800 rays is compared with the
// cost of all.
TEST(Cut, TheEstimateBalancesAnUnevenPicture) {
    Request request = requestFor(400, 300);
    request.cost = true;
    const Picture picture = draw(request);
    const double share = static_cast<double>(testsIn(picture, {picture.region})) / 8;
    const auto dearest = [&](const CostMap& map) {
        uint64_t most = 0;
        for (const auto& regions : cutPicture(map, 8)) most = std::max(most, testsIn(picture, regions));
        return static_cast<double>(most) / share;
    };
    const double even = dearest(CostMap(picture.region));
    const double estimated = dearest(estimateCosts(uneven().packed, request, 8));
    EXPECT_GT(even, 1.5);
    EXPECT_LT(estimated, 1.15);
}

// Each part of a picture makes the estimate by itself.
TEST(Cut, TheEstimateIsTheSameEveryTime) {
    const Request request = requestFor(200, 100);
    const CostMap a = estimateCosts(uneven().packed, request, 5);
    EXPECT_EQ(a.costs, estimateCosts(uneven().packed, request, 5).costs);
}

TEST(Cut, GreatPicturesHaveGreaterTiles) {
    const CostMap map({0, 0, 65536, 65536});
    EXPECT_EQ(map.tile, 64);
    EXPECT_EQ(map.costs.size(), size_t{1} << 20);
}

}  // namespace glint::farm::test::cut_test
