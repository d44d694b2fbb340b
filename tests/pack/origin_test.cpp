// Where local coordinates start, and what far scenes keep of their precision.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "pack/packed_scene.h"
#include "support/scene_maker.h"
#include "support/support.h"

namespace glint::origin_test {
using namespace test;

// Of extent 4 around `offset`, with one of everything. All coordinates are multiples of 1/4.
Scene sceneAt(const glm::dvec3& offset) {
    Scene scene;
    aim(scene.camera, offset + glm::dvec3(0.5, 1.25, 4), offset);
    scene.lights.push_back(PointLight{offset + glm::dvec3(2, 5, 3.75), {1, 1, 1}});
    scene.lights.push_back(DirectionalLight{{1, -2, 3}, {1, 1, 1}});
    addObject(scene, MeshShape{gridMesh(4, offset + glm::dvec3(-2, -2, 0.25))});
    addObject(scene, SphereShape{offset + glm::dvec3(0, 0, -1), 3});
    addObject(scene, PlaneShape{offset + glm::dvec3(0, -2, 0), {0, 1, 0}});
    addObject(scene, TriangleShape{{offset, offset + glm::dvec3(1, 0, 0), offset + glm::dvec3(0, 0.25, 0)}});
    return scene;
}

TEST(PackOrigin, ZeroForOrdinaryScenes) {
    EXPECT_EQ(packScene(Scene{}).origin, glm::dvec3(0));
    EXPECT_EQ(packScene(sceneAt({0, 0, 0})).origin, glm::dvec3(0));
    EXPECT_EQ(packScene(sceneAt({10, 0, 0})).origin, glm::dvec3(0));
}

// A triangle of edges 2 around (x, 0, 0), which reaches 1 from there, with the eye `away`.
Scene triangleAt(double x, double away) {
    Scene scene;
    scene.camera.eye = {x, 0, away};
    addObject(scene, TriangleShape{{{x - 1, 0, -1}, {x + 1, 0, -1}, {x, 0, 1}}});
    return scene;
}

TEST(PackOrigin, TurnsAtFourReaches) {
    EXPECT_EQ(packScene(triangleAt(4, 1)).origin, glm::dvec3(0));
    EXPECT_EQ(packScene(triangleAt(-4, 1)).origin, glm::dvec3(0));
    // The reach is 1 = 0.5 * 2^1: multiples of 2.
    EXPECT_EQ(packScene(triangleAt(6, 1)).origin, glm::dvec3(6, 0, 0));
    EXPECT_EQ(packScene(triangleAt(-6, 1)).origin, glm::dvec3(-6, 0, 0));
    EXPECT_EQ(packScene(triangleAt(100.75, 1)).origin, glm::dvec3(100, 0, 0));
}

TEST(PackOrigin, TurnsAtFourTimesTheWayFromTheEye) {
    EXPECT_EQ(packScene(triangleAt(40, 10)).origin, glm::dvec3(0));
    EXPECT_EQ(packScene(triangleAt(42, 10)).origin, glm::dvec3(42, 0, 0));
}

// Small balls, and fewer that are a thousand times as large, whose box has its middle elsewhere.
Scene ballsAt(const glm::dvec3& middle) {
    Scene scene;
    scene.camera.eye = middle + glm::dvec3(1, 2, 5);
    for (const glm::dvec3& from :
         {glm::dvec3(1, 0, 0), glm::dvec3(-1, 1, 0), glm::dvec3(0, -2, 1), glm::dvec3(0, 1, -1)})
        addObject(scene, SphereShape{middle + from, 0.5});
    addObject(scene, SphereShape{middle + glm::dvec3(0, -702, 0), 700});
    addObject(scene, SphereShape{middle + glm::dvec3(-900, 0, 3), 890});
    addObject(scene, SphereShape{middle + glm::dvec3(0, 0, -1205), 1200});
    return scene;
}

TEST(PackOrigin, IsWhereMostObjectsAre) {
    for (const double far : {100.0, 5e3, 1e7}) {
        const glm::dvec3 middle(-far, 0.7 * far, 0.1 * far);
        const glm::dvec3 away = glm::abs(packScene(ballsAt(middle)).origin - middle);
        EXPECT_LE(std::max({away.x, away.y, away.z}), 3) << far;
    }
    EXPECT_EQ(packScene(ballsAt({8, 0, 0})).origin, glm::dvec3(0));
}

// As many large ones as small: the median of the centres alone lies between them.
TEST(PackOrigin, OnePlanetAndOneBall) {
    Scene scene;
    const glm::dvec3 at(3e7, 1e7, 0);
    scene.camera.eye = at + glm::dvec3(0, 1, 4);
    addObject(scene, SphereShape{at - glm::dvec3(0, 1e6, 0), 1e6});
    addObject(scene, SphereShape{at + glm::dvec3(0, 1, 0), 1});
    const glm::dvec3 away = glm::abs(packScene(scene).origin - at);
    EXPECT_LE(std::max({away.x, away.y, away.z}), 2);
}

// Most objects are far from the eye: their details are too small to justify a loss of digits near it.
TEST(PackOrigin, StaysWhereTheEyeIs) {
    Scene scene;
    scene.camera.eye = {0, 1, 4};
    addObject(scene, SphereShape{{0, 0, 0}, 1});
    for (int i = 0; i < 8; ++i) addObject(scene, SphereShape{{100 + i % 3, 0, i / 3}, 1});
    EXPECT_EQ(packScene(scene).origin, glm::dvec3(0));
    scene.camera.eye = {90, 1, 4};
    EXPECT_EQ(packScene(scene).origin, glm::dvec3(100, 0, 0));
}

// Rays that others cast may come from anywhere.
TEST(PackOrigin, AnEyeThatSeesNothingDoesNotCount) {
    Scene scene;
    addObject(scene, SphereShape{{1e6, 0, 0}, 1});
    scene.camera.eye = {0, 0, 5};
    EXPECT_EQ(packScene(scene).origin, glm::dvec3(1e6, 0, 0));
    addObject(scene, SphereShape{{0, 0, 0}, 1});
    addObject(scene, SphereShape{{1e6, 2, 0}, 1});
    EXPECT_EQ(packScene(scene).origin, glm::dvec3(0));
}

// Half of the objects reach 2 to 4 from their middle, so origins are multiples of 4; that middle is less than
// 2 from the offset in every axis, and 1e7 = 4 * 2500000: the origin is the offset, every local coordinate is
// the same.
TEST(PackOrigin, FarScenePacksLikeTheSameAtZero) {
    for (const glm::dvec3& offset :
         {glm::dvec3(1e7, 0, 0), glm::dvec3(1e7, -3e9, 4096), glm::dvec3(0, 0, -1e12)}) {
        const PackedScene near = packScene(sceneAt({0, 0, 0})), far = packScene(sceneAt(offset));
        EXPECT_EQ(near.origin, glm::dvec3(0));
        EXPECT_EQ(far.origin, offset);
        EXPECT_FALSE(near.triangles.empty() || near.spheres.empty() || near.planes.empty());
        EXPECT_EQ(near.lights.size(), 2u);
        EXPECT_TRUE(sameBytes(near.nodes, far.nodes));
        EXPECT_TRUE(sameBytes(near.triangles, far.triangles));
        EXPECT_TRUE(sameBytes(near.triangleSurfaces, far.triangleSurfaces));
        EXPECT_TRUE(sameBytes(near.spheres, far.spheres));
        EXPECT_TRUE(sameBytes(near.planes, far.planes));
        EXPECT_TRUE(sameBytes(near.lights, far.lights));
        const Camera c0 = sceneAt({0, 0, 0}).camera, c1 = sceneAt(offset).camera;
        const shared::Camera packed0 = packCamera(c0, 64, 48, near.origin);
        const shared::Camera packed1 = packCamera(c1, 64, 48, far.origin);
        EXPECT_EQ(std::memcmp(&packed0, &packed1, sizeof(packed0)), 0);
    }
}

TEST(PackOrigin, IsNearTheGeometry) {
    for (const double size : {1e-3, 0.7, 5.0, 333.0}) {
        for (const double far : {1e5, 1e7, 123456789.0}) {
            const glm::dvec3 at(far, -0.3 * far, 0.01 * far);
            Scene scene;
            scene.camera.eye = at + glm::dvec3(0, 0, size);
            addObject(scene, SphereShape{at, size});
            const glm::dvec3 origin = packScene(scene).origin;
            const glm::dvec3 away = glm::abs(origin - at);
            EXPECT_LE(std::max({away.x, away.y, away.z}), size * 1.000001);
        }
    }
}

// Without bounded geometry the eye, the target and the planes below it decide.
TEST(PackOrigin, PlanesAlone) {
    Scene scene;
    aim(scene.camera, {1e7, 1, 0}, {1e7, 1, -4});
    addObject(scene, PlaneShape{{0, 0, 0}, {0, 1, 0}});
    const PackedScene packed = packScene(scene);
    // Half extent 2 = 0.5 * 2^2: a multiple of 4.
    EXPECT_EQ(packed.origin.x, 1e7);
    EXPECT_EQ(packCamera(scene.camera, 2, 2, packed.origin).eye.y + packed.origin.y, 1.0);
    EXPECT_EQ(packed.planes[0].point.y + packed.origin.y, 0.0);
    EXPECT_LT(std::abs(packed.planes[0].point.x), 16.0f);
}

TEST(PackOrigin, IgnoresWhatIsNotFinite) {
    const glm::dvec3 offset(1e7, 0, 0);
    Scene scene = sceneAt(offset);
    auto mesh = gridMesh(1, offset);
    mesh->positions[0] = {NAN, 0, 0};
    mesh->positions[3] = {0, 1e300, 0};
    addObject(scene, MeshShape{mesh});
    const glm::dvec3 away = glm::abs(packScene(scene).origin - offset);
    EXPECT_LE(std::max({away.x, away.y, away.z}), 2);
    EXPECT_EQ(packScene(scene).statistics.droppedNotFinite, 2u);
}

// T67's ground given by a far point: the stored point is near the geometry, on the same plane.
TEST(PlaneAnchor, FarPointIsReplaced) {
    Scene scene = sceneAt({0, 0, 0});
    addObject(scene, PlaneShape{{1e7, -3, 2e8}, {0, 5, 0}});
    addObject(scene, PlaneShape{{8, -3, -7}, {0, 1, 0}});  // near enough: as given
    const PackedScene packed = packScene(scene);
    ASSERT_EQ(packed.planes.size(), 3u);
    EXPECT_LT(glm::length(packed.planes[1].point), 8.0f);
    EXPECT_EQ(packed.planes[1].point.y, -3.0f);
    EXPECT_EQ(packed.planes[2].point, glm::vec3(8, -3, -7));
}

// A slanted one: rounding the given point would move the plane by up to 2^-24 * 1e8 = 6.
TEST(PlaneAnchor, SlantedPlaneStaysInPlace) {
    const glm::dvec3 normal = glm::normalize(glm::dvec3(1, 2, 3));
    const glm::dvec3 along = glm::normalize(glm::cross(normal, glm::dvec3(0, 1, 0)));
    Scene scene = sceneAt({0, 0, 0});
    addObject(scene, PlaneShape{2.0 * normal + 1e8 * along, normal});
    const PackedScene packed = packScene(scene);
    // The given point itself is off by a few 2^-53 * 1e8 = 1e-8.
    EXPECT_NEAR(glm::dot(glm::dvec3(packed.planes[1].point), normal), 2.0, 1e-6);
}

// T69: a plane far from everything stays there; there is no nearer point on it.
TEST(PlaneAnchor, FarPlaneStaysFar) {
    Scene scene = sceneAt({0, 0, 0});
    addObject(scene, PlaneShape{{0, 1e7, 0}, {0, -1, 0}});
    EXPECT_EQ(packScene(scene).planes[1].point, glm::vec3(0, 1e7, 0));
}

}  // namespace glint::origin_test
