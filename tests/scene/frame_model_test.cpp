// frameModel, checked by projecting the geometry with its camera.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "scene/frame_model.h"
#include "scene/transform.h"
#include "scene/validate.h"
#include "support/support.h"

namespace glint::test::frame_model_test {

using glm::dvec3;

// A point in the picture: x and y are -1..1 from edge to edge, z is the distance along the view.
dvec3 project(const Scene& scene, const dvec3& point) {
    const Camera& c = scene.camera;
    const dvec3 w = glm::normalize(c.target - c.eye);
    const dvec3 u = glm::normalize(glm::cross(w, c.up));
    const dvec3 v = glm::cross(u, w);
    const dvec3 d = point - c.eye;
    const double tangent = std::tan(c.fovY * std::numbers::pi / 360);
    const double z = glm::dot(d, w);
    return {glm::dot(d, u) / (z * tangent * scene.image.width / scene.image.height),
            glm::dot(d, v) / (z * tangent), z};
}

Scene withTriangles(const std::vector<dvec3>& positions) {
    auto mesh = std::make_shared<Mesh>();
    mesh->positions = positions;
    for (uint32_t i = 0; i + 2 < positions.size(); i++) mesh->corners.push_back({i, i + 1, i + 2});
    Scene scene;
    scene.materials.emplace_back();
    scene.objects.push_back({"/objects/0", MeshShape{mesh}, 0});
    return scene;
}

std::vector<dvec3> boxCorners(const dvec3& low, const dvec3& high) {
    std::vector<dvec3> corners;
    for (int i = 0; i < 8; i++)
        corners.push_back({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
    return corners;
}

// All inside, and something near an edge: the model fits the image and fills it.
void expectFits(const Scene& scene, const std::vector<dvec3>& points) {
    double greatest = 0;
    for (const dvec3& point : points) {
        const dvec3 p = project(scene, point);
        EXPECT_GT(p.z, 0);
        greatest = std::max({greatest, std::abs(p.x), std::abs(p.y)});
    }
    EXPECT_LT(greatest, 1.0);
    EXPECT_GT(greatest, 0.85);
}

TEST(FrameModel, BoxesOfAnyShapeSizeAndPlaceFill) {
    for (const dvec3& size : {dvec3(1), dvec3(10, 1, 1), dvec3(1, 10, 1), dvec3(1, 1, 10), dvec3(1, 1, 0)}) {
        for (const double scale : {1e-6, 1.0, 1e6}) {
            for (const dvec3& place : {dvec3(0), dvec3(1000, -2000, 3000)}) {
                const auto corners = boxCorners(scale * (place - 0.5 * size), scale * (place + 0.5 * size));
                for (const glm::ivec2 picture :
                     {glm::ivec2(800, 600), glm::ivec2(300, 900), glm::ivec2(1000, 100)}) {
                    Scene scene = withTriangles(corners);
                    scene.image.width = picture.x;
                    scene.image.height = picture.y;
                    frameModel(scene);
                    expectFits(scene, corners);
                    EXPECT_NO_THROW(validateScene(scene, "s"));
                }
            }
        }
    }
}

TEST(FrameModel, ViewsFromTheFrontAboveAndToTheRight) {
    Scene scene = withTriangles(boxCorners({0, 0, 0}, {1, 1, 1}));
    frameModel(scene);
    const dvec3 towardsEye = scene.camera.eye - scene.camera.target;
    EXPECT_GT(towardsEye.x, 0);
    EXPECT_GT(towardsEye.y, 0);
    EXPECT_GT(towardsEye.z, towardsEye.x);
    EXPECT_GT(towardsEye.z, towardsEye.y);
    EXPECT_EQ(scene.camera.fovY, 40);
    EXPECT_EQ(scene.camera.target, dvec3(0.5));
    EXPECT_EQ(scene.maxDepth, 5);
}

TEST(FrameModel, TheThreeVisibleSidesOfABoxDiffer) {
    Scene scene = withTriangles(boxCorners({0, 0, 0}, {1, 1, 1}));
    frameModel(scene);
    ASSERT_EQ(scene.lights.size(), 1u);
    const auto& light = std::get<DirectionalLight>(scene.lights[0]);
    const auto brightness = [&](const dvec3& normal) {
        const Material grey;
        const double lit = std::max(0.0, -glm::dot(normal, glm::normalize(light.direction)));
        return grey.ambient.x * scene.ambient.x + grey.diffuse.x * light.intensity.x * lit;
    };
    const double top = brightness({0, 1, 0}), front = brightness({0, 0, 1}), right = brightness({1, 0, 0});
    EXPECT_GT(top - front, 0.05);
    EXPECT_GT(front - right, 0.05);
    EXPECT_GT(right, 0.1);  // an unlit side is not black
    EXPECT_LT(top, 1);      // and a lit one not burnt out
    // Nor is any side the colour of the background.
    for (const double side : {top, front, right})
        EXPECT_GT(glm::length(Color(side) - scene.background), 0.05);
}

// Points about the y axis, from y = 0 to 2, `radius(y)` wide, moved by `place`.
std::vector<dvec3> surfaceOf(const auto& radius, const Affine& place) {
    std::vector<dvec3> points;
    for (int i = 0; i < 64; i++)
        for (int j = 0; j <= 32; j++) {
            const double a = i * std::numbers::pi / 32, y = j / 16.0;
            points.push_back(apply(place, {radius(y) * std::cos(a), y, radius(y) * std::sin(a)}));
        }
    return points;
}

// The radius of the sphere around (0, 1, 0) that touches y = 0.
double circle(double y) {
    return std::sqrt(std::max(0.0, 1 - (y - 1) * (y - 1)));
}

TEST(FrameModel, SpheresAndTrianglesCountPlanesDoNot) {
    Scene scene;
    scene.materials.emplace_back();
    scene.objects = {{"a", SphereShape{{5, 0, 0}, 2}, 0},
                     {"b", PlaneShape{{0, -1e6, 0}, {0, 1, 0}}, 0},
                     {"c", TriangleShape{{{-4, 0, 0}, {-3, 0, 0}, {-4, 1, 0}}}, 0}};
    frameModel(scene);
    std::vector<dvec3> points = surfaceOf(circle, {glm::dmat3(2), {5, -2, 0}});
    points.insert(points.end(), {{-4, 0, 0}, {-3, 0, 0}, {-4, 1, 0}});
    expectFits(scene, points);
}

// Every shape under a transform that turns, stretches and moves it: points of its surface fit.
TEST(FrameModel, AllShapesUnderATransformCount) {
    const Affine transform{{{2, 0.3, 0}, {-0.5, 1, 0.2}, {0, 0.1, 0.5}}, {100, -20, 7}};
    const auto revolved = [&](const auto& radius) { return surfaceOf(radius, transform); };
    const auto expectShapeFits = [&](const Shape& shape, const std::vector<dvec3>& points) {
        Scene scene;
        scene.materials.emplace_back();
        scene.objects.push_back({"a", shape, 0, transform});
        frameModel(scene);
        expectFits(scene, points);
    };
    expectShapeFits(SphereShape{{0, 1, 0}, 1}, revolved(circle));
    expectShapeFits(EllipsoidShape{{0, 1, 0}, {3, 1, 3}}, revolved([](double y) { return 3 * circle(y); }));
    expectShapeFits(CylinderShape{{0, 0, 0}, {0, 2, 0}, 1.5, true}, revolved([](double) { return 1.5; }));
    expectShapeFits(ConeShape{{0, 0, 0}, {0, 2, 0}, 2, 0.5, true},
                    revolved([](double y) { return 2 - 0.75 * y; }));
    expectShapeFits(HyperboloidShape{{0, 0, 0}, {0, 2, 0}, 2, 1, false},
                    revolved([](double y) { return std::sqrt(1 + 3 * (y - 1) * (y - 1)); }));
    std::vector<dvec3> rim;
    for (int i = 0; i < 64; i++) {
        const double a = i * std::numbers::pi / 32;
        rim.push_back(apply(transform, {2 * std::cos(a), 0, 2 * std::sin(a)}));
    }
    expectShapeFits(DiscShape{{0, 0, 0}, {0, 1, 0}, 2}, rim);
}

TEST(FrameModel, MeshesInSeveralPlacesCount) {
    const auto corners = boxCorners({0, 0, 0}, {1, 1, 1});
    Scene scene = withTriangles(corners);
    scene.objects.push_back(scene.objects[0]);
    scene.objects[1].transform = Affine{{{1, 0, 0}, {0, 2, 0}, {0, 0, 1}}, {10, 0, 0}};
    frameModel(scene);
    std::vector<dvec3> points = corners;
    for (const dvec3& p : corners) points.push_back({p.x + 10, 2 * p.y, p.z});
    expectFits(scene, points);
}

TEST(FrameModel, UnusedAndNonFiniteVerticesAreLeftOut) {
    const double nan = std::numeric_limits<double>::quiet_NaN(),
                 inf = std::numeric_limits<double>::infinity();
    Scene scene = withTriangles(boxCorners({0, 0, 0}, {1, 1, 1}));
    Mesh mesh = *std::get<MeshShape>(scene.objects[0].shape).mesh;
    const auto first = static_cast<uint32_t>(mesh.positions.size());
    for (const dvec3& p : {dvec3(nan, 0, 0), dvec3(0, inf, 0), dvec3(1e6, 0, 0)}) mesh.positions.push_back(p);
    mesh.corners.push_back({0, 1, first});
    mesh.corners.push_back({0, first + 1, 1});
    scene.objects[0].shape = MeshShape{std::make_shared<const Mesh>(mesh)};
    frameModel(scene);
    expectFits(scene, boxCorners({0, 0, 0}, {1, 1, 1}));
}

TEST(FrameModel, NoSizeOrNothingAtAll) {
    Scene empty;
    frameModel(empty);
    EXPECT_EQ(empty.camera.eye, Camera{}.eye);
    EXPECT_EQ(empty.lights.size(), 1u);
    for (const dvec3& place : {dvec3(0), dvec3(1e6, 1e6, 1e6)}) {
        Scene point = withTriangles({place, place, place});
        frameModel(point);
        EXPECT_NO_THROW(validateScene(point, "s"));
    }
}

TEST(FrameModel, LightsThatAreThereStay) {
    Scene scene = withTriangles(boxCorners({0, 0, 0}, {1, 1, 1}));
    scene.lights.push_back(PointLight{{1, 2, 3}, Color(4), Falloff::InverseSquare});
    frameModel(scene);
    ASSERT_EQ(scene.lights.size(), 1u);
    EXPECT_TRUE(std::holds_alternative<PointLight>(scene.lights[0]));
}

}  // namespace glint::test::frame_model_test
