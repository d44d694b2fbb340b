// Spot lights: the cone by geometry, on the device and in the reference.
#include <cmath>
#include <numbers>

#include "reference/render.h"
#include "support.h"
#include "verify/verify.h"

namespace glint::render::test::spots_test {
using glm::dvec3;

constexpr double kDegree = std::numbers::pi / 180;
constexpr int kSize = 96;

class SpotTest : public RenderTest {};

// A white floor below the camera, `height` across.
Scene floorFromAbove(double height) {
    Scene scene = emptyScene();
    scene.camera.projection = Projection::Orthographic;
    aim(scene.camera, {0, 1, 0}, {0, 0, 0}, {0, 0, -1});
    scene.camera.height = height;
    scene.materials[0].diffuse = Color(1);
    addPlane(scene, {0, 0, 0}, {0, 1, 0});
    return scene;
}

SpotLight lampAt(double height, double angle, double penumbra) {
    SpotLight lamp;
    lamp.position = {0, height, 0};
    lamp.angle = angle;
    lamp.penumbra = penumbra;
    return lamp;
}

// A lamp at height h lights a disc of radius h tan(angle), and nothing from h tan(angle + penumbra) on;
// between them the smoothstep of the cosine, docs/reference/shading.md. Radii are known to 1e-6 of h; the
// factor's slope there is below 1.5 / (cos 30 - cos 40) = 15 for the widest penumbra and below 10^4 for the
// narrow cone's.
TEST_F(SpotTest, LightsADiscOfTheConesRadius) {
    struct Lamp {
        double height, angle, penumbra, tolerance;
        Falloff falloff = Falloff::None;
    };
    for (const Lamp& lamp :
         {Lamp{4, 30, 10, 2e-5}, Lamp{4, 30, 0, 2e-5}, Lamp{0.25, 0, 60, 2e-5}, Lamp{1e4, 0.01, 0, 2e-5},
          Lamp{1e4, 0.005, 0.005, 2e-3}, Lamp{2, 30, 10, 2e-5, Falloff::InverseSquare}}) {
        const double full = lamp.height * std::tan(lamp.angle * kDegree);
        const double none = lamp.height * std::tan((lamp.angle + lamp.penumbra) * kDegree);
        Scene scene = floorFromAbove(2.5 * none);
        SpotLight spot = lampAt(lamp.height, lamp.angle, lamp.penumbra);
        spot.falloff = lamp.falloff;
        scene.lights.push_back(spot);
        const Case c = makeCase(scene, kSize, kSize);
        const Picture pictures[] = {draw(device(), c), reference::render(c.packed, wholeWithData(c))};
        int lit = 0, dark = 0, between = 0;
        for (int i = 0; i < 2 * kSize * kSize; ++i) {
            const Picture& picture = pictures[i % 2];
            const int x = i / 2 % kSize, y = i / 2 / kSize;
            const dvec3 point = picture.at(x, y).position;
            const double radius = std::hypot(point.x, point.z);
            if (std::min(std::abs(radius - full), std::abs(radius - none)) < 1e-3 * none) continue;
            const double theta = std::atan(radius / lamp.height);
            double expected = std::cos(theta);
            if (lamp.falloff == Falloff::InverseSquare)
                expected *= std::pow(std::cos(theta) / lamp.height, 2);
            ++(radius < full ? lit : radius > none ? dark : between);
            if (radius > full) {
                const auto oneMinusCosine = [](double a) { return 2 * std::pow(std::sin(a / 2), 2); };
                const double outer = oneMinusCosine((lamp.angle + lamp.penumbra) * kDegree);
                const double s =
                    (outer - oneMinusCosine(theta)) / (outer - oneMinusCosine(lamp.angle * kDegree));
                expected *= s * s * (3 - 2 * s);
            }
            if (radius > none) {
                EXPECT_EQ(picture.color.at(x, y, 0), 0) << radius;
            } else {
                EXPECT_NEAR(picture.color.at(x, y, 0), expected, lamp.tolerance)
                    << radius << " of " << full << " " << none;
            }
        }
        EXPECT_GT(dark, 2 * kSize * kSize / 3);
        EXPECT_EQ(lit > 0, lamp.angle > 0);
        EXPECT_EQ(between > 0, lamp.penumbra > 0);
    }
}

// A cone of 180 degrees is a point light, also straight behind, at a cosine of -1.
TEST_F(SpotTest, FullSphereIsAPointLight) {
    for (const Falloff falloff : {Falloff::None, Falloff::InverseSquare}) {
        Scene scene = floorFromAbove(3);
        scene.camera.eye.y = 0.5;
        SpotLight lamp = lampAt(1, 180, 0);
        lamp.direction = {0, 1, 0};
        lamp.falloff = falloff;
        scene.lights.push_back(lamp);
        const Case c = makeCase(scene, kSize, kSize);
        const Picture spot = draw(device(), c);
        EXPECT_EQ(verified(c).unexplained, 0u);
        scene.lights[0] = PointLight{lamp.position, lamp.intensity, falloff};
        EXPECT_TRUE(sameBits(spot, draw(device(), makeCase(scene, kSize, kSize))));
    }
}

// Sharp cones on a slanted floor, one from far away: verify explains pixels at their rims by rounding.
TEST_F(SpotTest, SharpRimsAreExplained) {
    Scene scene = emptyScene();
    scene.ambient = Color(0.1);
    scene.camera.eye = {0, 2, 6};
    addPlane(scene, {0, 0, 0}, {0, 1, 0.1});
    addSphere(scene, {0.5, 0.5, 0}, 0.7);
    const double far = 3e4;
    for (const auto& [position, angle] :
         {std::pair(dvec3(1, 3, 1), 25.0), std::pair(dvec3(-0.4, 0.05, 2), 100.0),
          std::pair(far * dvec3(0.6, 0.8, 0), 0.0015)}) {
        SpotLight lamp;
        lamp.position = position;
        lamp.direction = -position;
        lamp.angle = angle;
        lamp.intensity = Color(0.3);
        scene.lights.push_back(lamp);
    }
    const Case c = makeCase(scene, 256, 192);
    const verify::Report report = verified(c);
    EXPECT_EQ(report.unexplained, 0u);
    EXPECT_TRUE(report.passed()) << report.explained() << " explained pixels";
}

}  // namespace glint::render::test::spots_test
