// Boxes: rounding, frames, boxes of the tree, fate, media.
#include <gtest/gtest.h>

#include <random>

#include "pack/packed_scene.h"
#include "scene/transform.h"
#include "support/scene_maker.h"

namespace glint::cuboid_test {
using namespace test;
using glm::dmat3;
using glm::dvec3;

dmat3 rowsOf(const shared::Cuboid& c) {
    return glm::transpose(dmat3(dvec3(c.toLocal0), dvec3(c.toLocal1), dvec3(c.toLocal2)));
}

TEST(PackCuboid, WithoutATransformTheCornersAreExact) {
    Scene scene;
    scene.materials.resize(2);
    addObject(scene, SphereShape{{9, 0, 0}, 1});
    addObject(scene, BoxShape{{-1, 0.5, 2}, {3, 0.75, 2.125}}, 1);
    const PackedScene packed = packScene(scene);
    ASSERT_EQ(packed.cuboids.size(), 1u);
    const shared::Cuboid& c = packed.cuboids[0];
    EXPECT_EQ(c.lo, glm::vec3(-1, 0.5, 2));
    EXPECT_EQ(c.hi, glm::vec3(3, 0.75, 2.125));
    EXPECT_EQ(c.point, glm::vec3(0));
    EXPECT_EQ(rowsOf(c), dmat3(1));
    EXPECT_EQ(c.id, 1u);
    EXPECT_EQ(c.object, 1u);
    EXPECT_EQ(c.material, 1u);
    EXPECT_TRUE(packed.features.cuboids);
    EXPECT_FALSE(packed.features.instances);
}

TEST(PackCuboid, AxesThatKeepTheirSenseStayAxes) {
    Scene scene;
    addObject(scene, BoxShape{{-1, -1, -1}, {1, 1, 1}});
    addObject(scene, BoxShape{{-1, -1, -1}, {1, 1, 1}});
    scene.objects[0].transform = then(scaling({2, 3, 4}), translation({1, 2, 3}));
    scene.objects[1].transform = scaling({-1, 1, 1});  // turns the images on its faces
    const PackedScene packed = packScene(scene);
    const size_t baked = packed.cuboids[0].object == 0 ? 0 : 1;
    EXPECT_EQ(packed.cuboids[baked].lo, glm::vec3(-1, -1, -1));
    EXPECT_EQ(packed.cuboids[baked].hi, glm::vec3(3, 5, 7));
    EXPECT_EQ(packed.cuboids[1 - baked].toLocal0, glm::vec3(-1, 0, 0));
}

// Rows of length 1 that are 0 along the faces; corners at lo and hi; all within the box of the tree.
TEST(PackCuboid, UnderAnyTransform) {
    std::mt19937 engine(4);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int i = 0; i < 200; ++i) {
        dmat3 linear;
        for (int column = 0; column < 3; ++column)
            linear[column] = dvec3(uniform(engine), uniform(engine), uniform(engine));
        if (std::abs(glm::determinant(linear)) < 0.05) continue;
        const dvec3 low(uniform(engine), uniform(engine), uniform(engine));
        const BoxShape box{low, low + dvec3(0.1 + i % 3, 0.2, 1.5)};
        Scene scene;
        addObject(scene, box);
        scene.objects[0].transform = Affine{linear, {uniform(engine), 5, uniform(engine)}};
        const PackedScene packed = packScene(scene);
        ASSERT_EQ(packed.cuboids.size(), 1u);
        const shared::Cuboid& c = packed.cuboids[0];
        for (const glm::vec3& row : {c.toLocal0, c.toLocal1, c.toLocal2})
            EXPECT_NEAR(glm::length(dvec3(row)), 1, 1e-6);
        for (int corner = 0; corner < 8; ++corner) {
            const dvec3 own(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                            corner & 4 ? box.max.z : box.min.z);
            const dvec3 world = linear * own + scene.objects[0].transform->offset;
            const dvec3 y = rowsOf(c) * (world - dvec3(c.point));
            for (int axis = 0; axis < 3; ++axis) {
                const bool upper = (corner >> axis & 1) != 0;
                EXPECT_NEAR(y[axis], static_cast<double>(upper ? c.hi[axis] : c.lo[axis]), 4e-6);
                EXPECT_GE(world[axis], static_cast<double>(packed.boundsLo[axis]) - 1e-6);
                EXPECT_LE(world[axis], static_cast<double>(packed.boundsHi[axis]) + 1e-6);
            }
        }
    }
}

TEST(PackCuboid, WithoutVolumeAfterRoundingItIsDroppedWithAWarning) {
    Scene scene;
    addObject(scene, SphereShape{{0, 0, 0}, 1});
    addObject(scene, BoxShape{{1e8, 0, 0}, {1e8 + 1, 1, 1}});
    const PackedScene packed = packScene(scene);
    EXPECT_TRUE(packed.cuboids.empty());
    ASSERT_EQ(packed.warnings.size(), 1u);
    EXPECT_NE(packed.warnings[0].find("/objects/1: 1 of 1 boxes dropped"), std::string::npos)
        << packed.warnings[0];
}

TEST(PackCuboid, TheEyeInsideIsInItsMedium) {
    for (const bool turned : {false, true}) {
        Scene scene;
        addObject(scene, BoxShape{{-1, -1, -1}, {1, 1, 1}});
        scene.materials[0].transmission = Color(1);
        if (turned) scene.objects[0].transform = rotation({1, 2, 3}, 40);
        scene.camera.eye = {0.9, 0, 0};
        EXPECT_EQ(packScene(scene).environment.eyeMedium0, 1u);
        scene.camera.eye = {1.9, 0, 0};
        EXPECT_EQ(packScene(scene).environment.eyeMedium0, 0u);
    }
}

}  // namespace glint::cuboid_test
