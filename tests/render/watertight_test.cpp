// Closed surfaces have no holes. Random rays find nothing here, so the rays aim at edges and vertices.
#include <functional>
#include <numbers>

#include "support.h"

namespace glint::render::test::watertight_test {
using glm::dvec3;

class WatertightTest : public RenderTest {};

// github.com/Oblikovati issue 2146: leaks along the diagonal of a quad.
TEST_F(WatertightTest, DiagonalSweep) {
    Scene scene = emptyScene();
    addTriangle(scene, {-5, -5, 0}, {5, -5, 0}, {5, 5, 0});
    addTriangle(scene, {-5, -5, 0}, {5, 5, 0}, {-5, 5, 0});
    std::vector<RayInput> rays = {rayOf({0, 0, 10}, {0.30458447f, 0.30458447f, -0.9024725f})};
    for (int k = 1; k <= 3999; ++k) rays.push_back(rayTowards({0, 0, 10}, {k / 1000.0, k / 1000.0, 0}, true));
    EXPECT_EQ(missesOf(packScene(scene), rays), 0u);
}

// Vulkan CTS, ray tracing watertightness, closed fans of n triangles around the axis.
TEST_F(WatertightTest, ClosedFans) {
    for (const uint32_t n : {4u, 16u, 64u, 256u, 1024u}) {
        std::vector<dvec3> positions = {{0, 0, 1}};
        std::vector<glm::uvec3> corners;
        for (uint32_t i = 0; i < n; ++i) {
            const double angle = 2 * std::numbers::pi * i / n;
            positions.emplace_back(std::cos(angle), std::sin(angle), 0.25);
            corners.emplace_back(0, 1 + i, 1 + (i + 1) % n);
        }
        std::vector<RayInput> rays = {rayTowards({0, 0, -1}, {0, 0, 1})};
        for (uint32_t i = 1; i <= n; ++i) {
            for (const double w : {0.5, 1.0 / 3, 0.9})
                rays.push_back(rayTowards({0, 0, -1}, glm::mix(positions[0], positions[i], w), i % 2));
        }
        Scene scene = emptyScene();
        addMesh(scene, positions, corners);
        EXPECT_EQ(missesOf(packScene(scene), rays), 0u) << n;
    }
}

// Unit squares far from the origin; a second grid opposite keeps the packing from moving it there.
TEST_F(WatertightTest, DistantGrids) {
    constexpr uint32_t kSquares = 16;
    Random random(18);
    for (const double offset : {0.0, 1e3, 1e6}) {
        Scene scene = emptyScene();
        scene.camera.eye = {0, 0, 10};
        addGrid(scene, kSquares, {offset, offset, 0}, kSquares);
        addTriangle(scene, {-offset - 1, -offset, -5}, {-offset - 2, -offset, -5},
                    {-offset - 1, -offset - 1, -5});
        const PackedScene packed = packScene(scene);
        ASSERT_EQ(packed.origin, dvec3(0));
        std::vector<RayInput> rays;
        for (uint32_t y = 1; y < kSquares; ++y) {
            for (uint32_t x = 1; x < kSquares; ++x) {
                const dvec3 vertex(offset + x, offset + y, 0);
                const dvec3 sides[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}};
                for (const dvec3& side : sides) {
                    for (int i = 0; i < 8; ++i) {
                        const dvec3 from = vertex + dvec3(random.uniform(-4, 4), random.uniform(-4, 4), 10);
                        const double along = i == 0 ? 0.5 : random.uniform(0, 0.9375);
                        rays.push_back(rayTowards(from, vertex + along * side, i % 2));
                    }
                }
            }
        }
        EXPECT_EQ(missesOf(packed, rays), 0u) << offset;
    }
}

}  // namespace glint::render::test::watertight_test
