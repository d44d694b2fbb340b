// Parallel and oblique cameras: geometry gives the hit of each pixel.
#include <algorithm>
#include <functional>

#include "reference/tracer.h"
#include "support.h"
#include "verify/verify.h"

namespace glint::render::test::cameras_test {
using glm::dvec3;

constexpr double kUnit = 0x1p-24;
constexpr int kWidth = 64, kHeight = 48;

class CameraTest : public RenderTest {};

Scene orthographicScene() {
    Scene scene = emptyScene();
    scene.camera.projection = Projection::Orthographic;
    aim(scene.camera, {2, 1, 7}, {2, 1, 0});
    scene.camera.height = 3;  // 48 rows of 1/16
    return scene;
}

// Triangles with their corners, and so their edges, as near to camera rays as the device's rays are to the
// true ones, `distance` from where the rays start, and only there where the sums that a ray is made of cancel
// to a fiftieth.
void addKnifeEdges(Scene& scene, int width, int height, double distance) {
    const PackedScene empty = packScene(scene);
    const reference::Tracer tracer(empty);
    const shared::Camera camera = packCamera(scene.camera, width, height, dvec3(0));
    Random random(20);
    const auto rayAt = [&](int x, int y) { return tracer.cameraRay(camera, x + 0.5, y + 0.5); };
    const auto near = [&](int x, int y) {
        const reference::Ray ray = rayAt(x, y);
        const double error = kUnit * (ray.originScale + distance * ray.directionScale);
        return ray.origin + distance * ray.direction + random.box(error);
    };
    for (int y = 0; y + 3 < height; y += 4) {
        for (int x = 0; x + 3 < width; x += 4) {
            const reference::Ray ray = rayAt(x, y);
            const bool cancels = ray.originScale > 50 * glm::length(ray.origin) || ray.directionScale > 50;
            if (!cancels) continue;
            const dvec3 a = near(x, y), b = near(x, y + 3), c = near(x + 3, y);
            // Too sharp a corner would not be found by random rays.
            const double longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
            if (glm::length(glm::cross(b - a, c - a)) > 0.2 * longest * longest) addTriangle(scene, a, b, c);
        }
    }
}

// The device's rays have large errors if its sums cancel: far from the normal of an oblique camera's plane,
// and near 0 if the film's middle is far away. verify must allow for this.
TEST_F(CameraTest, CancellationIsExplained) {
    Scene oblique = emptyScene(), parallel = emptyScene();
    oblique.camera.eye = {0, 0, 0};  // view + u U is 0.004 long at u = -1, that far from the middle
    oblique.camera.target = {0, 0, -1};
    oblique.camera.planeNormal = dvec3(1, 0, 0.004);
    oblique.camera.window = ViewWindow{-1.11, 1.23, -0.53, 0.71};
    parallel.camera.projection = Projection::Orthographic;
    aim(parallel.camera, {0, 0, 1e-3}, {0, 0, 0});
    parallel.camera.window = ViewWindow{-0.05, 4.11, -3.19, 0.05};  // 0 is near its upper left corner
    for (Scene& scene : {std::ref(oblique), std::ref(parallel)}) {
        const bool isParallel = scene.camera.projection == Projection::Orthographic;
        scene.ambient = Color(1);
        addKnifeEdges(scene, 1024, 768, isParallel ? 0.01 : 1);
        const Case c = makeCase(scene, 1024, 768);
        ASSERT_EQ(c.packed.origin, dvec3(0));
        const verify::Report report = verified(c);
        EXPECT_EQ(report.unexplained, 0u);
        EXPECT_GT(report.explained(), 4u) << "else nothing hung on rounding";
    }
}

// Camera rays start in the media around the middle of the window; the eye is in air.
TEST_F(CameraTest, MediaAreThoseAroundTheMiddleOfTheWindow) {
    Scene scene = orthographicScene();
    scene.background = Color(0.5);
    scene.camera.window = ViewWindow{4, 6, -1, 1};
    const uint32_t glass = addMaterial(scene, Color(0.2));
    scene.materials[glass].transmission = Color(0.8);
    addSphere(scene, {7, 1, 7}, 2, glass);
    addSphere(scene, {7, 1, 0}, 1, glass);
    const Case c = makeCase(scene, kWidth, kHeight);
    EXPECT_NE(c.packed.environment.eyeMedium0, 0u);
    const verify::Report report = verifiedAsRead(c);
    EXPECT_TRUE(report.passed()) << report.unexplained << " unexplained";
}

}  // namespace glint::render::test::cameras_test
