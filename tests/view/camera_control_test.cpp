#include "view/camera_control.h"
#include "scene/validate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <nlohmann/json.hpp>

#include "import/camera_writer.h"
#include "import/load.h"
#include "support/support.h"

namespace glint::view::camera_control_test {
using glint::test::expectNear;

constexpr double kPi = glm::pi<double>();

Camera cameraAt(const glm::dvec3& eye) {
    Camera camera;
    camera.eye = eye;
    camera.fovY = 60;
    return camera;
}

// A scene with the camera as the key C writes it.
Scene reread(const Camera& camera) {
    return parseScene("{\"camera\": " + cameraText(camera) + ", \"objects\": []}", "text", ".");
}

TEST(CameraControl, OrbitsAboutTheTarget) {
    CameraControl control(cameraAt({0, 0, 5}));
    control.orbit(kPi / 2, 0);  // the hand takes the scene a quarter to the right
    expectNear(control.camera().eye, {-5, 0, 0});
    control.orbit(0, kPi / 6);
    expectNear(control.camera().eye, {-5 * std::cos(kPi / 6), 5 * std::sin(kPi / 6), 0});
    expectNear(control.camera().target, {0, 0, 0});
}

TEST(CameraControl, NeverReachesThePole) {
    for (double y : {10.0, -10.0}) {
        CameraControl control(cameraAt({0, 0, 5}));
        control.orbit(0, y);
        const double angle = std::acos(control.camera().eye.y / 5);
        EXPECT_NEAR(angle, y > 0 ? kPi / 360 : kPi - kPi / 360, 1e-9);
        EXPECT_NEAR(control.camera().eye.x, 0, 1e-12);  // not to the other side
    }
}

TEST(CameraControl, LooksFromTheEye) {
    CameraControl control(cameraAt({0, 0, 5}));
    control.look(kPi / 2, 0);  // to the right
    expectNear(control.camera().target, {5, 0, 5});
    control.look(0, kPi / 4);  // down
    expectNear(control.camera().target, {5 * std::cos(kPi / 4), -5 * std::sin(kPi / 4), 5});
    expectNear(control.camera().eye, {0, 0, 5});
}

// At the target's distance the picture is 2 d tan(fov / 2) high.
TEST(CameraControl, PanFollowsTheHand) {
    CameraControl control(cameraAt({0, 0, 5}));
    control.pan(0.5, -0.25);
    const double height = 2 * 5 * std::tan(kPi / 6);
    expectNear(control.camera().target, {-0.5 * height, -0.25 * height, 0});
    expectNear(control.camera().eye, {-0.5 * height, -0.25 * height, 5});
}

TEST(CameraControl, DollyMoveZoomAndReset) {
    CameraControl control(cameraAt({0, 0, 5}));
    control.dolly(0.5);
    expectNear(control.camera().eye, {0, 0, 2.5});
    control.move({1, 2, 3});
    expectNear(control.camera().eye, {1, 2, -0.5});
    control.zoom(0.5);
    EXPECT_DOUBLE_EQ(control.camera().fovY, 30);
    control.zoom(1e9);
    EXPECT_DOUBLE_EQ(control.camera().fovY, 170);
    control.reset();
    expectNear(control.camera().eye, {0, 0, 5});
    EXPECT_DOUBLE_EQ(control.camera().fovY, 60);
}

TEST(CameraControl, AWindowZoomsToo) {
    Camera camera = cameraAt({0, 0, 5});
    camera.window = ViewWindow{-1, 2, -0.5, 1};
    CameraControl control(camera);
    control.zoom(2);
    EXPECT_DOUBLE_EQ(control.camera().window->right, 4);
    EXPECT_DOUBLE_EQ(control.camera().window->bottom, -1);
}

// Half of 60 degrees has the sine 1/2: a ball of radius 2 fills the height from 4 away; with room, from 4.4.
TEST(CameraControl, FramesABall) {
    CameraControl control(cameraAt({0, 0, 5}));
    control.frame({{1, 2, 3}, 2});
    expectNear(control.camera().eye, {1, 2, 3 + 4.4});
    control.view(Side::Right, {{1, 2, 3}, 2});
    expectNear(control.camera().eye, {1 + 4.4, 2, 3});
}

// As `--up z` frames a model: its front is -y, and above is +z.
TEST(CameraControl, SidesFollowTheUpAxisOfTheScene) {
    Camera home = cameraAt({0, -5, 0});
    home.up = {0, 0, 2};
    CameraControl control(home);
    control.view(Side::Front, {{0, 0, 0}, 2});
    expectNear(control.camera().eye, {0, -4.4, 0});
    control.view(Side::Right, {{0, 0, 0}, 2});
    expectNear(control.camera().eye, {4.4, 0, 0});
    control.view(Side::Top, {{0, 0, 0}, 2});
    expectNear(control.camera().eye, {0, -4.4 * std::sin(kPi / 360), 4.4 * std::cos(kPi / 360)});
    expectNear(control.camera().up, {0, 0, 1});
}

// The camera of a file looks down, so its own up direction is no axis of the scene.
TEST(CameraControl, SidesKeepTheYAxisUpUnlessTheCameraNamesAnother) {
    Camera home = cameraAt({0, 5, 5});
    home.up = {0, 1, -1};
    CameraControl control(home);
    control.view(Side::Front, {{0, 0, 0}, 2});
    expectNear(control.camera().eye, {0, 0, 4.4});
    expectNear(control.camera().up, {0, 1, 0});
}

// From above, everything can still be turned: the view direction is not along `up`.
TEST(CameraControl, EverySideIsAValidCamera) {
    for (int side = 0; side < 6; ++side) {
        CameraControl control(cameraAt({0, 0, 5}));
        control.view(static_cast<Side>(side), {{1, 2, 3}, 2});
        Scene scene;
        scene.camera = control.camera();
        EXPECT_NO_THROW(validateScene(scene, "side")) << side;
        control.orbit(0.1, 0.1);
        EXPECT_TRUE(std::isfinite(control.camera().eye.x + control.camera().eye.y)) << side;
    }
}

// At the target's distance, 5, 60 degrees show 2 * 5 * tan(30).
TEST(CameraControl, EveryProjectionIsValidAndKeepsTheSize) {
    CameraControl control(cameraAt({1, 3, 4}));
    const double distance = control.distance();
    const char* const names[] = {"orthographic", "oblique perspective", "oblique orthographic",
                                 "perspective"};
    for (const char* name : names) {
        EXPECT_EQ(control.nextProjection(), name);
        const Camera& camera = control.camera();
        if (camera.projection == Projection::Orthographic) {
            EXPECT_NEAR(camera.height, 2 * distance * std::tan(kPi / 6), 1e-9);
        } else {
            EXPECT_NEAR(camera.fovY, 60, 1e-9);
        }
        const Scene scene = reread(camera);
        EXPECT_EQ(scene.camera.projection, camera.projection);
        EXPECT_EQ(scene.camera.planeNormal, camera.planeNormal);
        if (camera.planeNormal) {  // upright
            EXPECT_NEAR(camera.planeNormal->y, 0, 1e-12);
        }
    }
}

TEST(CameraControl, AnObliqueCameraCanBeTurnedEverywhere) {
    CameraControl control(cameraAt({1, 3, 4}));
    control.nextProjection();
    control.nextProjection();
    for (int i = 0; i < 60; ++i) {
        control.orbit(0.3, i < 30 ? 0.1 : -0.15);
        Scene scene;
        scene.camera = control.camera();
        ASSERT_NO_THROW(validateScene(scene, "turned")) << i;
    }
}

TEST(CameraControl, FramesABallWithParallelRays) {
    CameraControl control(cameraAt({0, 0, 5}));
    control.nextProjection();
    control.frame({{1, 2, 3}, 2});
    EXPECT_NEAR(control.camera().height, 4.4, 1e-12);
    control.dolly(0.5);
    EXPECT_NEAR(control.camera().height, 2.2, 1e-12);
    control.pan(0.5, 0);
    expectNear(control.camera().target, {1 - 1.1, 2, 3});
}

}  // namespace glint::view::camera_control_test
