#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pack/packed_scene.h"
#include "support/scene_maker.h"
#include "support/support.h"

namespace glint::camera_test {
using test::aim;
using test::expectNear;

// As shared/layout.h defines the camera ray of a film point.
glm::dvec3 direction(const shared::Camera& c, double x, double y) {
    return glm::normalize(glm::dvec3(c.center) + (x - c.halfWidth) * glm::dvec3(c.stepX) +
                          (y - c.halfHeight) * glm::dvec3(c.stepY));
}

glm::dvec3 rayOrigin(const shared::Camera& c, double x, double y) {
    return glm::dvec3(c.eye) + (x - c.halfWidth) * glm::dvec3(c.originStepX) +
           (y - c.halfHeight) * glm::dvec3(c.originStepY);
}

// fp32 rounds center and both steps; through half the picture's width the rounding of a step stays relative:
// 3 * 2^-24 of a direction.
constexpr double kRounding = 4e-7;

Camera lookingDownZ(double fovY) {
    Camera camera;
    aim(camera, {0, 0, 0}, {0, 0, -1});
    camera.fovY = fovY;
    return camera;
}

// T09 (J. Buck, "The Ray Tracer Challenge", ch. 7): 201 x 101, pi/2 across the width, pixel (0, 0) looks
// along (0.66519, 0.33259, -0.66851). Its fov is horizontal, ours vertical: tan(fovY / 2) = 101 / 201; its
// picture has +x on the left, ours on the right.
TEST(PackCamera, CornerAndCentreOfTrtcPicture) {
    const Camera camera = lookingDownZ(360 / std::numbers::pi * std::atan(101.0 / 201.0));
    const shared::Camera packed = packCamera(camera, 201, 101, glm::dvec3(0));
    expectNear(direction(packed, 100.5, 50.5), {0, 0, -1}, kRounding);
    expectNear(direction(packed, 0.5, 0.5), {-0.66519, 0.33259, -0.66851}, 5e-6);
    // The book's five digits are normalize(-100/100.5, 50/100.5, -1).
    expectNear(direction(packed, 0.5, 0.5), glm::normalize(glm::dvec3(-100, 50, -100.5)), kRounding);
    EXPECT_EQ(packed.halfWidth, 100.5f);
    EXPECT_EQ(packed.halfHeight, 50.5f);
}

// The book's pixel size 0.01 at unit distance, for 200 x 125 with 90 degrees across, and turned.
TEST(PackCamera, PixelSteps) {
    const double wide = 360 / std::numbers::pi * std::atan(125.0 / 200.0);
    for (const auto& [fovY, width, height] : {std::tuple{wide, 200, 125}, std::tuple{90.0, 125, 200}}) {
        const shared::Camera packed = packCamera(lookingDownZ(fovY), width, height, glm::dvec3(0));
        expectNear(packed.stepX, {0.01, 0, 0}, 1e-9);
        expectNear(packed.stepY, {0, -0.01, 0}, 1e-9);  // rows go down
        expectNear(packed.center, {0, 0, -1}, kRounding);
    }
}

// Left and right edges of the film at l and r, top and bottom at t and b, for images of any proportions.
TEST(PackCamera, WindowSpansTheFilm) {
    Camera camera = lookingDownZ(40);
    camera.window = ViewWindow{-0.5, 1.5, -0.25, 0.125};
    const shared::Camera packed = packCamera(camera, 640, 480, glm::dvec3(0));
    expectNear(direction(packed, 0, 0), glm::normalize(glm::dvec3(-0.5, 0.125, -1)), kRounding);
    expectNear(direction(packed, 640, 480), glm::normalize(glm::dvec3(1.5, -0.25, -1)), kRounding);
    // Shirley & Marschner, eq. 4.1: u = l + (r - l)(i + 0.5) / nx; column 100, row 30 from the top.
    const double u = -0.5 + 2.0 * 100.5 / 640, v = 0.125 - 0.375 * 30.5 / 480;
    expectNear(direction(packed, 100.5, 30.5), glm::normalize(glm::dvec3(u, v, -1)), kRounding);
}

// Eye on +x looking at the origin with z up: right is u = up x w = z x x = y, and up stays z.
TEST(PackCamera, FrameOfAnotherView) {
    Camera camera;
    aim(camera, {5, 0, 0}, {0, 0, 0});
    camera.up = {1, 0, 2};  // leans towards the viewer; only its part across the view counts
    camera.fovY = 90;
    const shared::Camera packed = packCamera(camera, 2, 2, glm::dvec3(0));
    expectNear(packed.center, {-1, 0, 0}, kRounding);
    expectNear(packed.stepX, {0, 1, 0}, kRounding);
    expectNear(packed.stepY, {0, 0, -1}, kRounding);
}

// The eye is subtracted in double: 2^-20 next to 1e7 is lost in fp32 but not relative to the origin.
TEST(PackCamera, EyeIsRelativeToOrigin) {
    const double small = std::ldexp(1.0, -20);
    Camera camera;
    aim(camera, {1e7 + small, -1e7, 3}, {1e7 + small, -1e7, 2});
    const shared::Camera packed = packCamera(camera, 4, 4, glm::dvec3(1e7, -1e7, 0));
    EXPECT_EQ(packed.eye, glm::vec3(small, 0, 3));
    expectNear(packed.center, {0, 0, -1}, kRounding);
}

TEST(PackCamera, Bounds) {
    Camera camera;
    camera.nearT = 0.5;
    shared::Camera packed = packCamera(camera, 4, 4, glm::dvec3(0));
    EXPECT_EQ(packed.nearT, 0.5f);
    EXPECT_EQ(packed.farT, shared::kInfinity);
    camera.farT = 100;
    packed = packCamera(camera, 4, 4, glm::dvec3(0));
    EXPECT_EQ(packed.farT, 100.0f);
    camera.farT = 1e300;
    EXPECT_EQ(packCamera(camera, 4, 4, glm::dvec3(0)).farT, shared::kInfinity);
}

// T97: with 1e-4 degrees over 100 pixels a step is 1.7e-8, below fp32's spacing near 1 but exact by itself.
TEST(PackCamera, TelephotoKeepsItsSteps) {
    const shared::Camera packed = packCamera(lookingDownZ(1e-4), 100, 100, glm::dvec3(0));
    const double step = 2 * std::tan(0.5e-4 * std::numbers::pi / 180) / 100;
    EXPECT_NEAR(packed.stepX.x, step, step * 1e-7);
    EXPECT_NEAR(packed.stepY.y, -step, step * 1e-7);
}

// Perspective rays all start at the eye, parallel ones all have one direction.
TEST(PackCamera, EachKindHasStepsOfItsOwn) {
    for (const bool oblique : {false, true}) {
        Camera camera = lookingDownZ(40);
        if (oblique) camera.planeNormal = {0, 0.5, 1};
        const shared::Camera perspective = packCamera(camera, 8, 6, glm::dvec3(0));
        EXPECT_EQ(perspective.originStepX, glm::vec3(0));
        EXPECT_EQ(perspective.originStepY, glm::vec3(0));
        camera.projection = Projection::Orthographic;
        const shared::Camera parallel = packCamera(camera, 8, 6, glm::dvec3(0));
        EXPECT_EQ(parallel.stepX, glm::vec3(0));
        EXPECT_EQ(parallel.stepY, glm::vec3(0));
        EXPECT_EQ(parallel.center, glm::vec3(0, 0, -1));
    }
}

// Shirley & Marschner, eq. 4.1 and sec. 4.3.1: the ray of pixel (i, j) starts at e + u U + v V. A picture of
// 200 x 100 pixels, 5 high and so 10 wide, has pixels of 1/20.
TEST(PackCamera, OrthographicPixelSteps) {
    Camera camera;
    camera.projection = Projection::Orthographic;
    aim(camera, {7, 2, 3}, {7, 2, -9});
    camera.height = 5;
    const shared::Camera packed = packCamera(camera, 200, 100, glm::dvec3(0));
    expectNear(packed.originStepX, {0.05, 0, 0}, 1e-8);
    expectNear(packed.originStepY, {0, -0.05, 0}, 1e-8);  // rows go down
    expectNear(rayOrigin(packed, 100, 50), {7, 2, 3}, 0);
    expectNear(rayOrigin(packed, 0.5, 0.5), {7 - 99.5 / 20, 2 + 49.5 / 20, 3}, 1e-6);
    expectNear(direction(packed, 0.5, 0.5), {0, 0, -1}, 0);

    camera.window = ViewWindow{-1, 4, -2, 0.5};  // overrides height
    const shared::Camera window = packCamera(camera, 200, 100, glm::dvec3(0));
    expectNear(rayOrigin(window, 0, 0), {6, 2.5, 3}, 1e-6);
    expectNear(rayOrigin(window, 200, 100), {11, 0, 3}, 1e-6);
}

// The origin's offset from `origin` is formed in double: next to 1e7 fp32 could not separate the pixels.
TEST(PackCamera, OrthographicRaysAreRelativeToOrigin) {
    Camera camera;
    camera.projection = Projection::Orthographic;
    aim(camera, {1e7, 0.25, 3}, {1e7, 0.25, 0});
    camera.window = ViewWindow{0, 0.5, 0, 0.5};
    const shared::Camera packed = packCamera(camera, 2, 2, glm::dvec3(1e7, 0, 0));
    expectNear(rayOrigin(packed, 0.5, 1.5), {0.125, 0.375, 3}, 1e-6);
}

// Sec. 4.3.1: the plane's normal turns the frame, the view direction stays. In a cabinet projection a point
// one unit behind the image plane appears in place of the one half a unit aside at 45 degrees.
TEST(PackCamera, ObliqueParallel) {
    Camera camera;
    camera.projection = Projection::Orthographic;
    const double half = std::sqrt(0.125);
    aim(camera, {-half, half, 1}, {0, 0, 0});
    camera.height = 4;
    for (const double side : {1.0, -3.0}) {  // either side of the plane will do
        camera.planeNormal = {0, 0, side};
        const shared::Camera packed = packCamera(camera, 40, 40, glm::dvec3(0));
        expectNear(packed.originStepX, {0.1, 0, 0}, kRounding);
        expectNear(packed.originStepY, {0, -0.1, 0}, kRounding);
        const glm::dvec3 d = direction(packed, 3, 5);
        expectNear(d / -d.z, {half, -half, -1}, kRounding);
    }
}

// Sec. 4.3.2: direction = D + u U + v V with D the view direction, U and V in the image plane. Looking up at
// 45 degrees with an upright image plane, the horizon (v with direction.y = 0) is at v = -sin 45, and the
// window's edges at D + l U + t V.
TEST(PackCamera, ObliquePerspective) {
    Camera camera;
    aim(camera, {0, 0, 0}, {0, 3, -3});
    camera.planeNormal = {0, 0, 1};
    camera.window = ViewWindow{-1, 1, -1, 1};
    const shared::Camera packed = packCamera(camera, 10, 10, glm::dvec3(0));
    const double s = std::sqrt(0.5);
    expectNear(packed.stepX, {0.2, 0, 0}, kRounding);
    expectNear(packed.stepY, {0, -0.2, 0}, kRounding);
    expectNear(packed.center, {0, s, -s}, kRounding);
    expectNear(direction(packed, 5, 5 + s / 0.2), {0, 0, -1}, kRounding);
    expectNear(direction(packed, 0, 0), glm::normalize(glm::dvec3(-1, s + 1, -s)), kRounding);
    // Along a column only the height changes: at unit depth the picture is that of the upright plane.
    for (const double y : {0.0, 2.5, 10.0}) {
        const glm::dvec3 d = direction(packed, 8, y);
        EXPECT_NEAR(d.x / -d.z, 0.6 / s, kRounding);
    }
    camera.window.reset();
    camera.fovY = 90;  // tan 45 = 1: the same window
    expectNear(packCamera(camera, 10, 10, glm::dvec3(0)).stepY, packed.stepY, kRounding);
}

}  // namespace glint::camera_test
