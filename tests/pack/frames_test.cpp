// Scenes packed one after the other: the arrays are those of a scene that is packed by itself.
#include <cmath>
#include <cstring>

#include "pack/build_tree.h"
#include "pack/packed_scene.h"
#include "pack/scene_arrays.h"
#include "scene/placement.h"
#include "support/scene_maker.h"
#include "support/support.h"

namespace glint::test::frames_test {
bool sameArrays(const PackedScene& a, const PackedScene& b) {
    bool same = a.origin == b.origin && sameBytes(a.nodes, b.nodes) && sameBytes(a.lights, b.lights) &&
                sameBytes(a.triangleSurfaces, b.triangleSurfaces) && a.features == b.features &&
                std::memcmp(&a.environment, &b.environment, sizeof(a.environment)) == 0;
#define GLINT_COMPARE(number, Kind, KINDS, kinds, one, many) same = same && sameBytes(a.kinds, b.kinds);
    GLINT_PRIMITIVES(GLINT_COMPARE, GLINT_COMPARE)
#undef GLINT_COMPARE
    return same;
}

// A wavy sheet of 2 x n x n triangles.
std::shared_ptr<const Mesh> sheet(uint32_t n) {
    auto mesh = gridMesh(n);
    for (glm::dvec3& p : mesh->positions) p = {p.x, std::fmod(7 * p.x + 3 * p.y, 5), p.y};
    return mesh;
}

Scene sceneWith(bool huge) {
    Scene scene;
    scene.materials.resize(1);
    scene.camera.eye = {10, 12, 40};
    scene.lights.emplace_back(PointLight{{1, 50, 1}});
    scene.objects.push_back({"/objects/0", MeshShape{sheet(40)}, 0});
    scene.objects.push_back({"/objects/1", SphereShape{{3, 9, 3}, 2}, 0});
    scene.objects.push_back({"/objects/2", PlaneShape{{0, -4, 0}, {0, 1, 0}}, 0});
    if (huge) scene.objects.push_back({"/objects/3", SphereShape{{0, -6000, 0}, 6000}, 0});
    return scene;
}

TEST(Frames, ThreadsDoNotChangeThePacking) {
    Scene scene = sceneWith(true);
    addObject(scene, MeshShape{gridMesh(200)});
    for (int i = 0; i < 1000; ++i) addObject(scene, SphereShape{{i % 10, i / 10 % 10, i / 100}, 0.3});
    EXPECT_TRUE(sameArrays(packScene(scene, {}, {.threads = 1}), packScene(scene, {}, {.threads = 4})));
}

TEST(Frames, ATreeIsBuiltAgainOnlyIfItsGeometryChanges) {
    Scene scene = sceneWith(false);
    TreeMemory memory;
    const auto packed = [&] { return packScene(scene, {.memory = &memory}); };
    packed();
    const uint64_t first = memory.built();
    EXPECT_GT(first, 0u);
    std::get<PointLight>(scene.lights[0]).position.x = 7;
    scene.materials[0].diffuse = Color(0.1);
    scene.camera.eye.x = 11;
    EXPECT_TRUE(sameArrays(packed(), packScene(scene)));
    EXPECT_EQ(memory.built(), first);
    std::get<SphereShape>(scene.objects[1].shape).radius = 2.5;
    EXPECT_TRUE(sameArrays(packed(), packScene(scene)));
    EXPECT_EQ(memory.built(), first + 1);
    // Back again: the memory is that of the scene before, and no more.
    std::get<SphereShape>(scene.objects[1].shape).radius = 2;
    EXPECT_TRUE(sameArrays(packed(), packScene(scene)));
    EXPECT_EQ(memory.built(), first + 2);
}

// Instances: their prototypes stay, the tree over them is built again.
TEST(Frames, TreesOfInstancesStay) {
    Scene scene = sceneWith(false);
    const auto mesh = std::get<MeshShape>(scene.objects[0].shape).mesh;
    for (int i = 0; i < 4; ++i) {
        Affine place;
        place.offset = {50.0 * i, 0, 0};
        scene.objects.push_back({"/more", MeshShape{mesh}, 0, place});
    }
    placeObjects(scene);
    TreeMemory memory;
    packScene(scene, {.memory = &memory});
    const uint64_t first = memory.built();
    ASSERT_EQ(first, 2u);
    scene.objects.back().transform->offset.y = 3;
    EXPECT_TRUE(sameArrays(packScene(scene, {.memory = &memory}), packScene(scene)));
    EXPECT_EQ(memory.built(), first + 1);
}

// If the function reports that the arrays are kept, they are.
TEST(Frames, CamerasThatKeepTheArrays) {
    int kept = 0, others = 0;
    for (const bool huge : {false, true}) {
        const Scene scene = sceneWith(huge);
        const PackedScene packed = packScene(scene);
        for (const glm::dvec3 eye : {glm::dvec3(10, 12, 41), glm::dvec3(-30, 3, 5), glm::dvec3(10, 1e6, 40),
                                     glm::dvec3(1e9, 1e9, 1e9), glm::dvec3(10, 0.5, 40)}) {
            Scene other = scene;
            other.camera.eye = eye;
            const bool keeps = keepsArrays(packed, scene, other.camera);
            const bool same = sameArrays(packed, packScene(other));
            EXPECT_TRUE(same || !keeps) << eye.x << ' ' << eye.y;
            (keeps ? kept : others)++;
        }
        Scene parallel = scene;
        parallel.camera.projection = Projection::Orthographic;
        EXPECT_FALSE(keepsArrays(packed, scene, parallel.camera));
        Scene lens = scene;
        lens.camera.lensRadius = 0.1;
        EXPECT_FALSE(keepsArrays(packed, scene, lens.camera));
    }
    EXPECT_GE(kept, 3);
    EXPECT_GE(others, 3);
}

// Far from 0 coordinates are counted from the geometry, if the eye is near it.
TEST(Frames, TheOriginGoesWithTheEye) {
    Scene scene = sceneWith(false);
    for (Object& object : scene.objects) {
        Affine far;
        far.offset = {400, 0, 0};
        object.transform = far;
    }
    placeObjects(scene);
    scene.camera.eye = {410, 12, 40};
    const PackedScene packed = packScene(scene);
    EXPECT_NE(packed.origin.x, 0);
    Scene other = scene;
    other.camera.eye = {420, 12, 40};
    EXPECT_TRUE(keepsArrays(packed, scene, other.camera));
    EXPECT_EQ(packScene(other).origin, packed.origin);
    other.camera.eye = {290, 12, 40};
    EXPECT_FALSE(keepsArrays(packed, scene, other.camera));
    EXPECT_EQ(packScene(other).origin, glm::dvec3(0));
}

}  // namespace glint::test::frames_test
