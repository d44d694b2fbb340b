// Spheres on the device: published hits, tangents, rays from inside and from the surface.
#include <cmath>

#include "support.h"

namespace glint::render::test::spheres_test {
using glm::dvec3;
using glm::vec3;

constexpr double kUnit = 0x1p-24;

class SphereTest : public RenderTest {
  protected:
    // The first hit after tMin, or nothing.
    static std::optional<float> hitOf(const dvec3& center, double radius, const RayInput& ray) {
        Scene scene = emptyScene();
        scene.camera.eye = dvec3(ray.origin);
        scene.camera.target = scene.camera.eye + dvec3(0, 0, -1);
        addSphere(scene, center, radius);
        const PackedScene packed = packScene(scene);
        EXPECT_EQ(packed.origin, dvec3(0));
        Renderer renderer(device(), packed);
        const RayHit hit = renderer.trace({ray}, false)[0];
        return hit.hit ? std::optional<float>(hit.t) : std::nullopt;
    }
    static RayInput after(RayInput ray, float tMin) {
        ray.tMin = tMin;
        return ray;
    }
};

// Shirley and Marschner, Fundamentals of Computer Graphics: (1, 1, 1) - t (1, 1, 1) and the unit sphere, t =
// 1 -+ 1 / sqrt(3).
TEST_F(SphereTest, DiagonalThroughTheUnitSphere) {
    const RayInput ray = rayOf({1, 1, 1}, {-1, -1, -1});
    EXPECT_NEAR(hitOf({0, 0, 0}, 1, ray).value(), 1 - 1 / std::sqrt(3.0), 4 * kUnit);
    EXPECT_NEAR(hitOf({0, 0, 0}, 1, after(ray, 1)).value(), 1 + 1 / std::sqrt(3.0), 4 * kUnit * 1.6);
}

// Buck, The Ray Tracer Challenge, features/spheres.feature.
TEST_F(SphereTest, RayTracerChallenge) {
    const auto ray = [](float x, float y, float z) { return rayOf({x, y, z}, {0, 0, 1}); };
    EXPECT_EQ(hitOf({0, 0, 0}, 1, ray(0, 0, -5)), 4);
    EXPECT_EQ(hitOf({0, 0, 0}, 1, after(ray(0, 0, -5), 5)), 6);
    EXPECT_EQ(hitOf({0, 0, 0}, 1, ray(0, 1, -5)), 5);
    EXPECT_EQ(hitOf({0, 0, 0}, 1, after(ray(0, 1, -5), 5)), std::nullopt);
    EXPECT_EQ(hitOf({0, 0, 0}, 1, ray(0, 2, -5)), std::nullopt);
    EXPECT_EQ(hitOf({0, 0, 0}, 1, ray(0, 0, 0)), 1);
    EXPECT_EQ(hitOf({0, 0, 0}, 1, ray(0, 0, 5)), std::nullopt);
    EXPECT_EQ(hitOf({0, 0, 0}, 2, ray(0, 0, -5)), 3);
    EXPECT_EQ(hitOf({0, 0, 0}, 2, after(ray(0, 0, -5), 5)), 7);
    EXPECT_EQ(hitOf({5, 0, 0}, 1, ray(0, 0, -5)), std::nullopt);
}

// b is the ray's distance from the centre: t = 10 - sqrt(1 - b^2).
TEST_F(SphereTest, Tangents) {
    const auto hit = [](float b) { return hitOf({0, 0, 0}, 1, rayOf({b, 0, -10}, {0, 0, 1})); };
    EXPECT_NEAR(hit(0.99999994f).value(), 10 - std::sqrt(1 - 0.99999994 * 0.99999994), 4 * kUnit * 10);
    EXPECT_EQ(hit(1), 10);
    EXPECT_EQ(hit(1.0000001f), std::nullopt);
}

// A ray that starts on a sphere of radius 1 sees its far side only: r = |2 b / a| with the start taken as
// exactly on it.
TEST_F(SphereTest, InsideAndOutside) {
    EXPECT_EQ(hitOf({0, 0, 0}, 1, rayOf({0, 0, 0.5f}, {0, 0, 1})), 0.5f);
    EXPECT_EQ(hitOf({0, 0, 0}, 1, rayOf({0, 0, 0.5f}, {0, 0, -1})), 1.5f);
    EXPECT_EQ(hitOf({0, 0, 0}, 1, rayOf({0, 0, 1}, {0, 0, 1})), std::nullopt);  // t = 0 is excluded
    EXPECT_EQ(hitOf({0, 0, 0}, 1, rayOf({0, 0, 1}, {0, 0, -1})), 2);
}

}  // namespace glint::render::test::spheres_test
