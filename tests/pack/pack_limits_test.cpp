// What a packed scene can hold, and the features that are derived from it.
#include <gtest/gtest.h>

#include <array>

#include "pack/packed_scene.h"
#include "pack/request_environment.h"
#include "support/scene_maker.h"
#include "support/support.h"

namespace glint::pack_limits_test {
using namespace test;

void expectSceneError(const Scene& scene, const std::string& array, uint64_t count, uint64_t limit) {
    const std::string error = errorOf(ErrorKind::Scene, [&] { packScene(scene); });
    for (const std::string& part : {array, std::to_string(count), std::to_string(limit)})
        EXPECT_HAS(error, part);
}

TEST(PackLimits, Planes) {
    Scene scene;
    for (uint32_t i = 0; i < shared::kMaxPlanes; ++i)
        addObject(scene, PlaneShape{{0, static_cast<double>(i), 0}, {0, 1, 0}});
    EXPECT_EQ(packScene(scene).planes.size(), shared::kMaxPlanes);
    addObject(scene, PlaneShape{});
    expectSceneError(scene, "planes", 1025, 1024);
}

// A mesh of 2^25 triangles is just at the limit; one more triangle passes it.
TEST(PackLimits, Triangles) {
    auto mesh = std::make_shared<Mesh>();
    mesh->positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh->corners.assign(1u << 25, {0, 1, 2});
    Scene scene;
    addObject(scene, MeshShape{mesh});
    addObject(scene, TriangleShape{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}});
    expectSceneError(scene, "triangles", 33554433, 33554432);
}

// Each instance takes one id for each face of its mesh.
TEST(PackLimits, Primitives) {
    auto mesh = std::make_shared<Mesh>();
    mesh->positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    mesh->corners.assign(1u << 20, {0, 1, 2});
    Scene scene;
    for (int i = 0; i < 2048; ++i) scene.objects[addObject(scene, MeshShape{mesh})].transform = Affine();
    expectSceneError(scene, "primitives", 2147483648, 2147483647);
}

// ---- the greatest radiance of a ray ----

// A mirror and a light that falls off on the surface of a sphere; the greatest radiances at depths 0, 1, 2.
std::array<float, 3> radianceBounds(const Color& mirror, const Color& nearLight) {
    Scene scene = emptyScene();
    scene.background = Color(0.25);
    scene.materials[0].diffuse = Color(0.5);
    scene.materials[0].mirror = mirror;
    addSphere(scene, {0, 0, 0}, 1);
    PointLight touching;
    touching.position = {0, 1, 0};
    touching.intensity = nearLight;
    touching.falloff = Falloff::InverseSquare;
    DirectionalLight sun;
    sun.intensity = Color(1);
    scene.lights = {touching, sun};
    const PackedScene packed = packScene(scene);
    std::array<float, 3> bounds{};
    for (uint32_t depth = 0; depth < bounds.size(); ++depth) {
        Tracing tracing;
        tracing.limits.depth = depth;
        bounds[depth] = radianceBound(packed, environmentOf(packed, tracing), packed.lights);
    }
    return bounds;
}

TEST(RadianceBound, LightThatTouchesASurfaceHasNone) {
    constexpr float kNone = shared::kInfinity;
    for (const Color& mirror : {Color(0), Color(0.5)})
        EXPECT_EQ(radianceBounds(mirror, Color(1)), (std::array{kNone, kNone, kNone}));
}

TEST(RadianceBound, LightOfNoIntensityAddsNothing) {
    EXPECT_EQ(radianceBounds(Color(0.5), Color(0)), (std::array{0.5f, 0.75f, 0.875f}));
}

SceneFeatures featuresOf(const Scene& scene) {
    return packScene(scene).features;
}

TEST(PackFeatures, Primitives) {
    const auto smooth = gridMesh(1);
    smooth->normals = {{0, 0, 1}};
    smooth->normalCorners.assign(2, {0, 0, 0});
    const std::pair<Shape, bool SceneFeatures::*> steps[] = {
        {MeshShape{gridMesh(1)}, &SceneFeatures::triangles},
        {MeshShape{smooth}, &SceneFeatures::vertexNormals},
        {SphereShape{{0, 0, 0}, 1}, &SceneFeatures::spheres},
        {PlaneShape{}, &SceneFeatures::planes},
        {PolygonShape{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}}, &SceneFeatures::polygons},
        {DiscShape{}, &SceneFeatures::discs},
        {EllipsoidShape{}, &SceneFeatures::quadrics},
        // The eye at (0, 0, 5) is 0.0125 above it.
        {SphereShape{{0, -1000, 0}, 1000}, &SceneFeatures::anchoredSpheres}};
    Scene scene;
    SceneFeatures expected;
    for (const auto& [shape, feature] : steps) {
        addObject(scene, shape);
        expected.*feature = true;
        EXPECT_EQ(featuresOf(scene), expected) << scene.objects.size();
    }
}

// What the kernels leave out where they are false, and would draw other pictures if they were so by mistake.
TEST(PackFeatures, PlanesAndGlassThatAskForMore) {
    Scene scene;
    Material glass;
    glass.transmission = Color(0.9);
    scene.materials = {Material{}, glass};
    addObject(scene, SphereShape{{0, 0, 0}, 1}, 1);
    addObject(scene, PlaneShape{});
    EXPECT_TRUE(featuresOf(scene).transmission);
    EXPECT_FALSE(featuresOf(scene).openPlanes || featuresOf(scene).texturedGlass);

    scene.objects[1].material = 1;
    EXPECT_TRUE(featuresOf(scene).openPlanes);

    scene.objects[1].material = 0;
    scene.textures.push_back({CheckerTexture{}});
    scene.materials[0].transmissionTexture = 0;  // of no dielectric
    EXPECT_FALSE(featuresOf(scene).texturedGlass);
    scene.materials[1].transmissionTexture = 0;
    EXPECT_TRUE(featuresOf(scene).texturedGlass);
    EXPECT_FALSE(featuresOf(scene).openPlanes);
}

// A triangle that is dropped is not there, and neither is its material.
TEST(PackFeatures, DroppedTrianglesDoNotCount) {
    Scene scene;
    scene.materials.resize(1);
    scene.materials[0].mirror = {1, 1, 1};
    addObject(scene, TriangleShape{{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}});
    EXPECT_EQ(featuresOf(scene), SceneFeatures{});
}

TEST(PackFeatures, Lights) {
    const std::pair<Light, SceneFeatures> lights[] = {
        {PointLight{{0, 1, 0}, {1, 1, 1}, Falloff::InverseSquare}, {.pointLights = true}},
        {DirectionalLight{}, {.directionalLights = true}},
        {SpotLight{}, {.spotLights = true}},
        {SpotLight{.falloff = Falloff::InverseSquare}, {.spotLights = true}}};
    for (const auto& [light, expected] : lights) {
        Scene scene;
        scene.lights = {light};
        EXPECT_EQ(featuresOf(scene), expected) << light.index();
    }
}

TEST(PackFeatures, Cameras) {
    Scene parallel, lens;
    parallel.camera.planeNormal = {0, 1, 1};
    EXPECT_EQ(featuresOf(parallel), SceneFeatures{});  // oblique perspective: rays from the eye
    parallel.camera.projection = Projection::Orthographic;
    EXPECT_EQ(featuresOf(parallel), SceneFeatures{.parallelCamera = true});
    lens.camera.lensRadius = 0.1;
    EXPECT_EQ(featuresOf(lens), SceneFeatures{.thinLens = true});
}

// Only materials that something wears count, however it wears them, and mirrors only if paths may reflect.
TEST(PackFeatures, MaterialsInUse) {
    Scene plain;
    plain.materials.resize(3);
    plain.materials[1].specular = {0, 0, 0.5};
    plain.materials[2].mirror = {0, 0.25, 0};
    EXPECT_FALSE(featuresOf(plain).specular);
    EXPECT_FALSE(featuresOf(plain).mirrors);
    auto mesh = gridMesh(1);
    mesh->materials = {1, 2};
    const std::vector<std::vector<std::pair<Shape, uint32_t>>> wearers{
        {{SphereShape{}, 1}, {SphereShape{}, 2}},
        {{PlaneShape{}, 1}, {PlaneShape{}, 2}},
        {{DiscShape{}, 1}, {DiscShape{}, 2}},
        {{PolygonShape{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, 1}, {DiscShape{}, 2}},
        {{TriangleShape{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}}, 1}, {SphereShape{}, 2}},
        {{MeshShape{mesh}, 0}}};
    for (const auto& objects : wearers) {
        Scene scene = plain;
        for (const auto& [shape, material] : objects) addObject(scene, shape, material);
        EXPECT_TRUE(featuresOf(scene).specular);
        EXPECT_TRUE(featuresOf(scene).mirrors);
        scene.maxDepth = 0;
        EXPECT_TRUE(featuresOf(scene).specular);
        EXPECT_FALSE(featuresOf(scene).mirrors);
    }
}

}  // namespace glint::pack_limits_test
