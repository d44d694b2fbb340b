#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>

#include "bvh/bvh.h"
#include "pack/moving_scene.h"
#include "pack/packed_scene.h"
#include "support/scene_maker.h"
#include "support/support.h"

namespace glint::pack_scene_test {
using namespace test;
using shared::kNone;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

const shared::Triangle* triangleWithId(const PackedScene& packed, uint32_t id, size_t* slot = nullptr) {
    for (size_t i = 0; i < packed.triangles.size(); ++i) {
        if (packed.triangles[i].id != id) continue;
        if (slot != nullptr) *slot = i;
        return &packed.triangles[i];
    }
    return nullptr;
}

// Sphere, grid of 8, plane, empty mesh, triangle, grid of 2: ids 0, 1..8, 9, -, 10, 11..12.
Scene mixedScene() {
    Scene scene;
    scene.materials.resize(4);
    addObject(scene, SphereShape{{0, 0, 3}, 1}, 1);
    addObject(scene, MeshShape{gridMesh(2)}, 2);
    addObject(scene, PlaneShape{{0, -1, 0}, {0, 2, 0}}, 3);
    addObject(scene, MeshShape{std::make_shared<Mesh>()}, 0);
    addObject(scene, TriangleShape{{{5, 0, 0}, {6, 0, 0}, {5, 1, 0}}}, 0);
    auto faces = gridMesh(1, {0, 0, -4});
    faces->faces = {7, 7};      // one polygon of the file
    faces->materials = {3, 1};  // over the object's own
    addObject(scene, MeshShape{faces}, 0);
    return scene;
}

TEST(PackScene, IdsFollowObjectsAndFaces) {
    const PackedScene packed = packScene(mixedScene());
    ASSERT_EQ(packed.spheres.size(), 1u);
    EXPECT_EQ(packed.spheres[0].id, 0u);
    EXPECT_EQ(packed.spheres[0].object, 0u);
    EXPECT_EQ(packed.spheres[0].material, 1u);
    ASSERT_EQ(packed.planes.size(), 1u);
    EXPECT_EQ(packed.planes[0].id, 9u);
    EXPECT_EQ(packed.planes[0].object, 2u);
    EXPECT_EQ(packed.planes[0].material, 3u);
    ASSERT_EQ(packed.triangles.size(), 11u);
    ASSERT_EQ(packed.triangleSurfaces.size(), 11u);

    std::map<uint32_t, shared::TriangleSurface> surfaces;
    for (size_t i = 0; i < packed.triangles.size(); ++i)
        surfaces[packed.triangles[i].id] = packed.triangleSurfaces[i];
    for (uint32_t face = 0; face < 8; ++face) {
        ASSERT_TRUE(surfaces.contains(1 + face));
        EXPECT_EQ(surfaces[1 + face].object, 1u);
        EXPECT_EQ(surfaces[1 + face].primitive, face);
        EXPECT_EQ(surfaces[1 + face].material, 2u);
    }
    ASSERT_TRUE(surfaces.contains(10));
    EXPECT_EQ(surfaces[10].object, 4u);
    EXPECT_EQ(surfaces[10].primitive, 0u);
    ASSERT_TRUE(surfaces.contains(11) && surfaces.contains(12));
    for (const uint32_t id : {11u, 12u}) {
        EXPECT_EQ(surfaces[id].object, 5u);
        EXPECT_EQ(surfaces[id].primitive, 7u);
        EXPECT_EQ(surfaces[id].material, id == 11 ? 3u : 1u);
        EXPECT_EQ(surfaces[id].normal, glm::vec3(0, 0, 1));
        EXPECT_EQ(surfaces[id].vertexNormals, kNone);
    }
}

TEST(PackScene, TrianglesKeepTheirVerticesInOrder) {
    const Scene scene = mixedScene();
    const PackedScene packed = packScene(scene);
    const shared::Triangle* t = triangleWithId(packed, 10);
    ASSERT_NE(t, nullptr);
    EXPECT_EQ(t->v0, glm::vec3(5, 0, 0));
    EXPECT_EQ(t->v1, glm::vec3(6, 0, 0));
    EXPECT_EQ(t->v2, glm::vec3(5, 1, 0));
    t = triangleWithId(packed, 2);  // a, d, c of the first square
    ASSERT_NE(t, nullptr);
    EXPECT_EQ(t->v0, glm::vec3(0, 0, 0));
    EXPECT_EQ(t->v1, glm::vec3(1, 1, 0));
    EXPECT_EQ(t->v2, glm::vec3(0, 1, 0));
}

// Every leaf's primitives lie inside the leaf's box, and the leaves together name each primitive once.
TEST(PackScene, LeavesNameTheirPrimitives) {
    Scene scene = mixedScene();
    for (int i = 0; i < 300; ++i) addObject(scene, SphereShape{{i % 7, i % 11, i % 13}, 0.1 + 0.001 * i}, 1);
    addObject(scene, MeshShape{gridMesh(20)}, 2);
    const PackedScene packed = packScene(scene);
    std::vector<int> triangles(packed.triangles.size()), spheres(packed.spheres.size());
    uint32_t leaves = 0;
    const auto visit = [&](uint32_t child, const glm::vec3& lo, const glm::vec3& hi) {
        if (child == kNone || (child & shared::kLeafFlag) == 0) return;
        ++leaves;
        const uint32_t kind = child >> shared::kLeafKindShift & shared::kLeafKindMask;
        const uint32_t count = (child >> shared::kLeafCountShift & shared::kLeafCountMask) + 1;
        const uint32_t first = child & shared::kLeafFirstMask;
        for (uint32_t i = first; i < first + count; ++i) {
            if (kind == shared::kKindSphere) {
                ++spheres.at(i);
                EXPECT_TRUE(
                    glm::all(glm::lessThanEqual(lo, packed.spheres[i].point - packed.spheres[i].radius)));
                EXPECT_TRUE(
                    glm::all(glm::lessThanEqual(packed.spheres[i].point + packed.spheres[i].radius, hi)));
                continue;
            }
            ++triangles.at(i);
            for (const glm::vec3& v :
                 {packed.triangles[i].v0, packed.triangles[i].v1, packed.triangles[i].v2})
                EXPECT_TRUE(glm::all(glm::lessThanEqual(lo, v)) && glm::all(glm::lessThanEqual(v, hi)));
            if (i > first) {
                EXPECT_LT(packed.triangles[i - 1].id, packed.triangles[i].id);
            }
        }
    };
    for (const shared::Node& node : packed.nodes) {
        visit(node.child0, node.lo0, node.hi0);
        visit(node.child1, node.lo1, node.hi1);
    }
    EXPECT_TRUE(std::all_of(triangles.begin(), triangles.end(), [](int n) { return n == 1; }));
    EXPECT_TRUE(std::all_of(spheres.begin(), spheres.end(), [](int n) { return n == 1; }));
    EXPECT_EQ(packed.statistics.leaves, leaves);
    EXPECT_LE(packed.statistics.depth, shared::kMaxBvhDepth);
}

// The traversal that counts crossings relies on this order.
TEST(PackScene, LeavesOfANodeFollowEachOther) {
    std::mt19937 random(9);
    std::uniform_real_distribution<double> uniform(0, 1);
    const auto point = [&] { return glm::dvec3(uniform(random), uniform(random), uniform(random)); };
    Scene scene;
    for (int i = 0; i < 5000; ++i) {
        const glm::dvec3 at = 40.0 * point();
        addObject(scene, TriangleShape{{at + point(), at + point(), at + point()}});
    }
    for (const BuildQuality quality : {BuildQuality::Fast, BuildQuality::Default}) {
        const PackedScene packed = packScene(scene, {quality, false});
        size_t pairs = 0;
        for (const shared::Node& node : packed.nodes) {
            if ((node.child0 & node.child1 & shared::kLeafFlag) == 0) continue;
            ++pairs;
            const uint32_t size = (node.child0 >> shared::kLeafCountShift & shared::kLeafCountMask) + 1;
            EXPECT_EQ((node.child0 & shared::kLeafFirstMask) + size, node.child1 & shared::kLeafFirstMask);
        }
        EXPECT_GT(pairs, 500u);
    }
}

// T26 to T29: no area, or not finite. The rest keep their numbers.
TEST(PackScene, DropsWhatCannotBeHit) {
    auto mesh = std::make_shared<Mesh>();
    mesh->positions = {{0, 0, 0},    {1, 0, 0},        {2, 0, 0},   {0, 1, 0},
                       {kNaN, 0, 0}, {0, 0, HUGE_VAL}, {1e39, 0, 0}};
    mesh->corners = {{0, 1, 2},   // collinear
                     {0, 1, 3},   // good: id 1
                     {3, 3, 3},   // a point
                     {0, 1, 4},   // NaN
                     {0, 3, 5},   // infinite
                     {0, 3, 6},   // beyond fp32
                     {1, 2, 3}};  // good: id 6
    Scene scene;
    addObject(scene, MeshShape{mesh});
    addObject(scene, TriangleShape{{{0, 0, 0}, {0, 0, 1}, {0, 0, 2}}});
    scene.objects[1].name.clear();  // still named by its place
    addObject(scene, SphereShape{{0, 0, 0}, 1});
    const PackedScene packed = packScene(scene);
    ASSERT_EQ(packed.triangles.size(), 2u);
    EXPECT_NE(triangleWithId(packed, 1), nullptr);
    EXPECT_NE(triangleWithId(packed, 6), nullptr);
    ASSERT_EQ(packed.spheres.size(), 1u);
    EXPECT_EQ(packed.spheres[0].id, 8u);
    EXPECT_EQ(packed.statistics.droppedZeroArea, 3u);
    EXPECT_EQ(packed.statistics.droppedNotFinite, 3u);
    ASSERT_EQ(packed.warnings.size(), 3u);
    EXPECT_EQ(packed.warnings[0].find("/objects/0: 2 of 7 triangles dropped: no area"), 0u)
        << packed.warnings[0];
    EXPECT_EQ(packed.warnings[1].find("/objects/0: 3 of 7 triangles dropped: a vertex is not finite"), 0u);
    EXPECT_EQ(packed.warnings[2].find("/objects/1: 1 of 1 triangles dropped: no area"), 0u);
    EXPECT_TRUE(glm::all(glm::lessThan(glm::abs(packed.boundsLo), glm::vec3(3))));
    EXPECT_TRUE(glm::all(glm::lessThan(glm::abs(packed.boundsHi), glm::vec3(3))));
}

// T26, T74: the spacing of fp32 is 2 at 2^24, so a height of 0.5 rounds away. The ball before the eye keeps
// the origin at 0.
TEST(PackScene, AreaIsJudgedAfterRounding) {
    const double far = 16777216;
    const auto shapesOf = [&](double height) {
        const glm::dvec3 a(far, far, 0), b(far + 8, far, 0), c(far + 8, far + height, 0),
            d(far, far + height, 0);
        return std::array<Shape, 3>{TriangleShape{{a, b, c}}, PolygonShape{{a, b, c, d}},
                                    BoxShape{a, c + glm::dvec3(0, 0, 1)}};
    };
    const char* const kinds[] = {"triangles", "polygons", "boxes"};
    for (size_t kind = 0; kind < 3; ++kind) {
        Scene scene;
        scene.camera.eye = {0, 0, 0};
        addObject(scene, shapesOf(0.5)[kind]);
        addObject(scene, shapesOf(4)[kind]);
        addObject(scene, SphereShape{{0, 0, -3}, 1});
        const PackedScene packed = packScene(scene);
        EXPECT_EQ(packed.origin, glm::dvec3(0));
        EXPECT_EQ(packed.statistics.droppedZeroArea, 1u) << kinds[kind];
        ASSERT_EQ(packed.triangles.size() + packed.polygons.size() + packed.cuboids.size(), 1u)
            << kinds[kind];
        ASSERT_EQ(packed.warnings.size(), 1u);
        EXPECT_EQ(packed.warnings[0].find(std::string("/objects/0: 1 of 1 ") + kinds[kind] + " dropped"), 0u)
            << packed.warnings[0];
    }
}

// T30: thin, but with area.
TEST(PackScene, KeepsNeedles) {
    for (const double h : {1e-4, 1e-6, 1e-8}) {
        Scene scene;
        addObject(scene, TriangleShape{{{0, 0, 0}, {1, 0, 0}, {0.5, h, 0}}});
        const PackedScene packed = packScene(scene);
        ASSERT_EQ(packed.triangles.size(), 1u);
        EXPECT_EQ(packed.triangleSurfaces[0].normal, glm::vec3(0, 0, 1));
    }
}

// T32. In one triangle's plane, so that two extents alone count.
TEST(PackScene, RefusesScenesThatFp32Misses) {
    const auto packTriangle = [](double size) {
        Scene scene;
        addObject(scene, TriangleShape{{{0, 0, 0}, {size, 0, 0}, {0, size, 0}}});
        return packScene(scene).triangles.size();
    };
    EXPECT_EQ(packTriangle(1.0001e-14), 1u);
    for (const double size : {0.9e-14, 1e-20}) {
        const std::string error = errorOf(ErrorKind::Scene, [&] { packTriangle(size); });
        EXPECT_HAS(error, "scale it up") << size;
    }
}

// A scene that shrinks too far is rebuilt, and packing refuses it.
TEST(PackScene, TinyScenesAreNotRefitted) {
    const auto triangle = [](double size) {
        auto mesh = std::make_shared<Mesh>();
        mesh->positions = {{0, 0, 0}, {size, 0, 0}, {0, size, 0}};
        mesh->corners = {{0, 1, 2}};
        Scene scene;
        addObject(scene, MeshShape{mesh});
        return scene;
    };
    MovingScene moving(triangle(1));
    EXPECT_TRUE(moving.update(triangle(1.5), {true}));
    EXPECT_FALSE(moving.update(triangle(1e-20), {true}));
}

TEST(PackScene, VertexNormals) {
    auto mesh = gridMesh(2);
    mesh->normals = {{0, 0, 5}, {3, 0, 4}, {0, 0, 0}, {0, kNaN, 0}, {0, 1e300, 0}, {1e-300, 0, 0}};
    const uint32_t none = Mesh::kNoIndex;
    mesh->normalCorners.assign(8, {0, 1, 0});
    mesh->normalCorners[1] = {none, none, none};
    mesh->normalCorners[2] = {0, 2, 0};
    mesh->normalCorners[3] = {0, 0, 3};
    mesh->normalCorners[4] = {4, 5, 0};
    mesh->normalCorners[5] = {0, none, 0};
    Scene scene;
    addObject(scene, MeshShape{mesh});
    addObject(scene, MeshShape{gridMesh(1, {0, 0, 1})});  // no normals at all
    const PackedScene packed = packScene(scene);
    ASSERT_EQ(packed.triangles.size(), 10u);
    EXPECT_EQ(packed.vertexNormals.size(), 4u);  // ids 0, 4, 6, 7
    std::vector<int> used(packed.vertexNormals.size());
    for (uint32_t id = 0; id < 10; ++id) {
        size_t slot = 0;
        ASSERT_NE(triangleWithId(packed, id, &slot), nullptr);
        const uint32_t index = packed.triangleSurfaces[slot].vertexNormals;
        const bool smooth = id == 0 || id == 4 || id == 6 || id == 7;
        ASSERT_EQ(index != kNone, smooth) << id;
        if (!smooth) continue;
        ++used.at(index);
        const shared::VertexNormals& n = packed.vertexNormals[index];
        EXPECT_EQ(n.n0, id == 4 ? glm::vec3(0, 1, 0) : glm::vec3(0, 0, 1));
        EXPECT_EQ(n.n1, id == 4 ? glm::vec3(1, 0, 0) : glm::vec3(0.6, 0, 0.8));
        EXPECT_EQ(n.n2, glm::vec3(0, 0, 1));
    }
    EXPECT_TRUE(std::all_of(used.begin(), used.end(), [](int n) { return n == 1; }));
}

TEST(PackScene, LightsAndEnvironment) {
    Scene scene = mixedScene();
    scene.background = {0.25, 0.5, 1};
    scene.ambient = {0.125, 0, 2};
    scene.maxDepth = 7;
    scene.lights.push_back(PointLight{{1, 2, 3}, {4, 5, 6}});
    scene.lights.push_back(PointLight{{-1, 2, 3}, {1, 1, 1}, Falloff::InverseSquare});
    scene.lights.push_back(DirectionalLight{{0, -3, -4}, {7, 8, 9}});
    const PackedScene packed = packScene(scene);
    ASSERT_EQ(packed.lights.size(), 3u);
    EXPECT_EQ(packed.lights[0].kind, shared::kLightPoint);
    EXPECT_EQ(packed.lights[0].position, glm::vec3(1, 2, 3));
    EXPECT_EQ(packed.lights[0].intensity, glm::vec3(4, 5, 6));
    EXPECT_EQ(packed.lights[1].kind, shared::kLightPoint | shared::kLightFades);
    EXPECT_EQ(packed.lights[2].kind, shared::kLightDirectional);
    EXPECT_EQ(packed.lights[2].position, glm::vec3(0, 0.6, 0.8));  // towards the light
    EXPECT_EQ(packed.lights[2].intensity, glm::vec3(7, 8, 9));
    EXPECT_EQ(packed.environment.background, glm::vec3(0.25, 0.5, 1));
    EXPECT_EQ(packed.environment.ambient, glm::vec3(0.125, 0, 2));
    EXPECT_EQ(packed.environment.root, 0u);
    EXPECT_EQ(packed.environment.planeCount, 1u);
    EXPECT_EQ(packed.environment.lightCount, 3u);
    EXPECT_EQ(packed.environment.maxDepth, 7u);
    EXPECT_EQ(packed.planes[0].normal, glm::vec3(0, 1, 0));
}

// Degrees become shares of a turn; whole turns do not count.
TEST(PackScene, EnvironmentMapsTurn) {
    const auto map = std::make_shared<Image>(2, 1, 3, 1.0f);
    for (const double degrees : {90.0, 450.0, -270.0}) {
        Scene scene;
        scene.environment = EnvironmentMap{"map", map, degrees, Color(1)};
        const PackedScene packed = packScene(scene);
        ASSERT_EQ(packed.environment.map, 1u);
        EXPECT_EQ(packed.textures[0].place.x, 0.25f) << degrees;
    }
}

// 1 - cos 60 = 1/2 and 1 - cos 90 = 1; for a narrow cone it is a^2 / 2 to a relative a^2 / 12, with the
// digits that 1 - cos in fp32 would lose: of 0.01 degrees it has one.
TEST(PackScene, SpotLights) {
    Scene scene;
    scene.lights.push_back(SpotLight{{1, 2, 3}, {0, -3, -4}, 60, 30, {4, 5, 6}});
    scene.lights.push_back(SpotLight{{1, 2, 3}, {0, -3, -4}, 180, 0, {4, 5, 6}, Falloff::InverseSquare});
    scene.lights.push_back(SpotLight{{1, 2, 3}, {0, -3, -4}, 0, 0.01, {4, 5, 6}, Falloff::InverseSquare});
    const PackedScene packed = packScene(scene);
    ASSERT_EQ(packed.lights.size(), 3u);
    const shared::Light& wide = packed.lights[0];
    EXPECT_EQ(wide.kind, shared::kLightSpot);
    EXPECT_EQ(wide.position, glm::vec3(1, 2, 3));
    EXPECT_EQ(wide.intensity, glm::vec3(4, 5, 6));
    EXPECT_EQ(wide.axis, glm::vec3(0, -0.6, -0.8));  // the way the light travels
    EXPECT_FLOAT_EQ(wide.inner, 0.5f);
    EXPECT_FLOAT_EQ(wide.outer, 1.0f);
    EXPECT_EQ(packed.lights[1].kind, shared::kLightSpot | shared::kLightFades);
    EXPECT_EQ(packed.lights[1].inner, 2.0f);
    EXPECT_EQ(packed.lights[1].outer, 2.0f);
    EXPECT_EQ(packed.lights[2].inner, 0.0f);
    const double angle = 0.01 * std::numbers::pi / 180;
    EXPECT_NEAR(packed.lights[2].outer, angle * angle / 2, angle * angle * 1e-7);
}

TEST(PackScene, MaterialsAsGiven) {
    Scene scene;
    scene.materials.push_back({"m", {0.5, 0.25, 0}, {1, 0, 0.5}, {0, 0.125, 1}, 60, {0.75, 0, 1}});
    const PackedScene packed = packScene(scene);
    ASSERT_EQ(packed.materials.size(), 1u);
    EXPECT_EQ(packed.materials[0].ambient, glm::vec3(0.5, 0.25, 0));
    EXPECT_EQ(packed.materials[0].diffuse, glm::vec3(1, 0, 0.5));
    EXPECT_EQ(packed.materials[0].specular, glm::vec3(0, 0.125, 1));
    EXPECT_EQ(packed.materials[0].shininess, 60.0f);
    EXPECT_EQ(packed.materials[0].mirror, glm::vec3(0.75, 0, 1));
}

TEST(PackScene, NothingInTheBvh) {
    Scene scene;
    addObject(scene, PlaneShape{});
    for (const PackedScene& packed : {packScene(Scene{}), packScene(scene)}) {
        EXPECT_TRUE(packed.nodes.empty());
        EXPECT_EQ(packed.environment.root, kNone);
        EXPECT_EQ(packed.boundsLo, packed.boundsHi);
        EXPECT_EQ(packed.origin, glm::dvec3(0));
    }
}

// Two unit cubes' worth of boxes 9 apart, two triangles in each: root 10 x 1 x 1 has half area 21, children 3
// each: one node + 2 * 2 * 3 / 21, but for the boxes' margin of 2^-20 (edgeMargin): the share of an area of 3
// grows by 4 * 2^-20.
TEST(PackScene, SahCost) {
    Scene scene;
    for (const double x : {0.0, 9.0}) {
        addObject(scene, TriangleShape{{{x, 0, 0}, {x + 1, 1, 0}, {x + 1, 1, 1}}});
        addObject(scene, TriangleShape{{{x, 1, 0}, {x + 1, 0, 0}, {x + 1, 1, 1}}});
    }
    const PackedScene packed = packScene(scene);
    EXPECT_EQ(packed.statistics.leaves, 2u);
    EXPECT_EQ(packed.statistics.depth, 1u);
    EXPECT_NEAR(packed.statistics.sahCost, BvhOptions().traversalCost + 4 * 3.0 / 21, 8 * 0x1p-20);
}

}  // namespace glint::pack_scene_test
