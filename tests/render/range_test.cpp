// Sizes, distances and lengths of directions from one end of the supported range to the other (import/load.h:
// coordinates below 1e18).
#include <cmath>

#include "support.h"

namespace glint::render::test::range_test {
using glm::dvec3;
using glm::vec3;

constexpr double kUnit = 0x1p-24;

class RangeTest : public RenderTest {
  protected:
    static RayHit hitOf(const Scene& scene, const RayInput& ray) {
        const PackedScene packed = packScene(scene);
        EXPECT_EQ(packed.origin, dvec3(0));
        return RenderTest::hitOf(packed, ray);
    }
    // A triangle and a sphere of this size and a plane that rays down the z axis meet at z = 0.
    static std::vector<Scene> surfaces(double size) {
        std::vector<Scene> scenes(3, emptyScene());
        addTriangle(scenes[0], {-size, -size, 0}, {size, -size, 0}, {0, size, 0});
        addSphere(scenes[1], {0, 0, -size}, size);
        addPlane(scenes[2], {0, 0, 0}, {0, 0, 1});
        for (Scene& scene : scenes) aim(scene.camera, {0, 0, 3 * size}, {0, 0, 0});
        return scenes;
    }
};

TEST_F(RangeTest, DirectionsOfAnyLength) {
    for (const Scene& scene : surfaces(1)) {
        for (const double length : {1e-15, 1e-9, 1e-6, 1e-3, 0.1, 1.0, 1e3, 1e6, 1e9, 1e15}) {
            const double exact = static_cast<float>(length);
            const RayHit hit = hitOf(scene, rayOf({0, 0, 3}, {0, 0, static_cast<float>(-length)}));
            EXPECT_TRUE(hit.hit) << scene.objects[0].name << " " << length;
            if (hit.hit) {
                EXPECT_NEAR(hit.t * exact, 3, 8 * kUnit * 3) << scene.objects[0].name << " " << length;
            }
        }
    }
}

TEST_F(RangeTest, ScenesOfAnySize) {
    for (const double size : {1e-12, 1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e9, 1e12, 1e15, 3e17}) {
        for (const Scene& scene : surfaces(size)) {
            const RayHit hit = hitOf(scene, rayOf(vec3(0, 0, 3 * size), {0, 0, -1}));
            EXPECT_TRUE(hit.hit) << scene.objects[0].name << " " << size;
            if (hit.hit) {
                EXPECT_NEAR(hit.t / size, 3, 8 * kUnit * 3) << scene.objects[0].name << " " << size;
            }
        }
    }
}

// Multiplying scene and origin by a power of two changes no digit of the answer but the exponent of t.
TEST_F(RangeTest, PowersOfTwoChangeNoDigit) {
    const PackedScene unit = packScene(surfaces(1)[0]);
    Random random(21);
    std::vector<RayInput> rays;
    for (int i = 0; i < 2000; ++i)
        rays.push_back(rayTowards(random.box(2) + dvec3(0, 0, 3),
                                  {random.uniform(-1, 1), random.uniform(-1, 1), 0}, true));
    const std::vector<RayHit> expected = hitsOf(unit, rays);
    EXPECT_GT(rays.size() - misses(expected), 500u);
    for (const int exponent : {-30, -20, -10, -1, 1, 10, 20, 30}) {
        const float scale = std::ldexp(1.0f, exponent);
        const PackedScene packed = packScene(surfaces(scale)[0]);
        std::vector<RayInput> scaled = rays;
        for (RayInput& ray : scaled) ray.origin *= scale;
        const std::vector<RayHit> hits = hitsOf(packed, scaled);
        for (size_t i = 0; i < rays.size(); ++i) {
            ASSERT_EQ(hits[i].hit, expected[i].hit) << exponent << ": " << text(scaled[i]);
            if (!hits[i].hit) continue;
            ASSERT_EQ(hits[i].t, expected[i].t * scale) << exponent;
            ASSERT_EQ(hits[i].data.u, expected[i].data.u) << exponent;
            ASSERT_EQ(hits[i].data.v, expected[i].data.v) << exponent;
        }
    }
}

// A bead of a thousandth and a triangle of a million in one scene.
TEST_F(RangeTest, GreatAndSmallTogether) {
    Scene scene = emptyScene();
    addTriangle(scene, {-1e6, -1e6, -1}, {1e6, -1e6, -1}, {0, 1e6, -1});
    addTriangle(scene, {-1e-3, -1e-3, 0}, {1e-3, -1e-3, 0}, {0, 1e-3, 0});
    const RayHit bead = hitOf(scene, rayOf({0, 0, 3}, {0, 0, -1}));
    EXPECT_EQ(bead.data.object, 1u);
    EXPECT_NEAR(bead.t, 3, 8 * kUnit * 3);
    const RayHit ground = hitOf(scene, rayOf({1, 0, 3}, {0, 0, -1}));
    EXPECT_EQ(ground.data.object, 0u);
    EXPECT_NEAR(ground.t, 4, 8 * kUnit * 4);
}

}  // namespace glint::render::test::range_test
