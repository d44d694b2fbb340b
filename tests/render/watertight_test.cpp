// Closed surfaces have no holes. Random rays find nothing here, so the rays aim at edges and vertices.
#include <numbers>

#include "support.h"

namespace glint::render::test::watertight_test {
using glm::dvec3;

class WatertightTest : public RenderTest {};

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

}  // namespace glint::render::test::watertight_test
