// No ray leaves a closed mesh: a million rays from inside at vertices and edges, on the device (T12 to T18,
// T82). And rays that start on a surface neither hit it again (T81) nor jump over its neighbour (T82).
#include <gtest/gtest.h>

#include "../render/support.h"
#include "checks.h"
#include "closed_meshes.h"
#include "reference/render.h"

namespace glint::stability::leaks_test {
class LeakTest : public render::test::RenderTest {
  protected:
    Subject subject() const { return {&device(), {}}; }
};

TEST_F(LeakTest, AMillionAimedRays) {
    expectNoLeaks(subject(), 1000000);
}

// T81. A convex object has no shadow on itself: where the light faces it, it is lit.
TEST_F(LeakTest, ConvexObjectsDoNotShadeThemselves) {
    for (const Kind kind : {Kind::Plane, Kind::Sphere, Kind::Mesh}) {
        for (const double offset : {0.0, 1e3, 1e6}) {
            for (const double size : {1e-3, 1.0, 1e3}) {
                for (const bool moved : {true, false}) {
                    // Unmoved, fp32 must still be able to tell the object's points apart.
                    if (!moved && (offset == 0 || size < 4e-6 * offset)) continue;
                    const PixelCount count = countSelfShadowed(subject(), kind, offset, size, moved);
                    const std::string where = "kind " + std::to_string(static_cast<int>(kind)) + " offset " +
                                              std::to_string(offset) + " size " + std::to_string(size) +
                                              (moved ? " moved" : "");
                    EXPECT_GT(count.seen, 320u) << where;
                    EXPECT_EQ(count.wrong, 0u) << where;
                }
            }
        }
    }
}

// T66, T81 for the other kinds: no point that the light sees is in the dark.
TEST_F(LeakTest, BodiesOfEveryKindAreLitWhereTheLightSeesThem) {
    const struct {
        double offset, size;
        bool moved;
    } rows[] = {{0, 1e-3, true}, {0, 1e3, true}, {1e6, 1, true}, {1e3, 1, false}, {1e6, 1e3, false}};
    for (const auto& row : rows) {
        const auto counts = countDarkAlongTheLight(subject(), row.offset, row.size, row.moved);
        for (size_t i = 0; i < counts.size(); ++i) {
            const std::string where = "body " + std::to_string(i) + " offset " + std::to_string(row.offset) +
                                      " size " + std::to_string(row.size);
            EXPECT_GT(counts[i].seen, 50u) << where;
            EXPECT_EQ(counts[i].wrong, 0u) << where;
        }
    }
}

// An arch of slivers, one ten-thousandth of a turn from the next, under a lamp that shines along them: of the
// pixel at (26, 143) the shadow ray was found to meet the sliver beside the one that it leaves.
TEST_F(LeakTest, SliversDoNotShadeTheirNeighbours) {
    const render::test::Case c = render::test::fileCase("arcade", 800, 450);
    ASSERT_TRUE(c.packed.features.slivers);
    Request request = render::test::wholeWithData(c);
    request.region = {24, 140, 32, 148};
    const Picture truth = reference::render(c.packed, c.camera, request);
    for (const render::Traversal traversal : {render::Traversal::Lane, render::Traversal::Packet}) {
        render::Options options;
        options.traversal = traversal;
        render::Renderer renderer(device(), c.packed, options);
        const Picture picture = renderer.render(c.camera, request);
        ASSERT_EQ(picture.data.size(), truth.data.size());
        for (size_t i = 0; i < truth.data.size(); ++i)
            EXPECT_EQ(picture.data[i].shadowBits, truth.data[i].shadowBits) << i;
    }
}

// T82. Down to 8 ulp of the coordinates; the offset itself, gamma_7 of them, is up to 7.
TEST_F(LeakTest, ThinGapsStayDark) {
    const struct {
        double height, gap;
    } lids[] = {{1, 1e-2}, {1, 1e-3}, {1, 1e-4}, {1, 1e-5}, {1, 1e-6}, {1e3, 1e-2}, {1e3, 1e-3}};
    for (const auto& lid : lids) {
        const PixelCount count = countLitUnderLid(subject(), lid.height, lid.gap);
        EXPECT_GT(count.seen, 200u) << lid.height << " " << lid.gap;
        EXPECT_EQ(count.wrong, 0u) << lid.height << " " << lid.gap << ", of " << count.seen;
    }
}

}  // namespace glint::stability::leaks_test
