// Groups: transforms composed, materials handed down, numbering; and what becomes an instance.
#include <cmath>

#include "import/load.h"
#include "scene/placement.h"
#include "scene/transform.h"
#include "support.h"

namespace glint::test::group_test {
using glm::dmat3;
using glm::dvec3;

TEST(Group, ComposesTransformsFromTheInsideOut) {
    // (1,0,0): own translation (2,0,0); a quarter turn about z (0,2,0); scaled by 3 (0,6,0); moved (5,6,0).
    const Scene scene = parse(R"({"objects": [
        {"type": "group", "transform": [{"scale": 3}, {"translate": [5, 0, 0]}], "objects": [
            {"type": "group", "transform": [{"rotate": [0, 0, 1, 90]}], "objects": [
                {"type": "sphere", "center": [1, 0, 0], "radius": 1, "transform": [{"translate": [1, 0, 0]}]}]},
            {"type": "plane", "point": [0, 1, 0], "normal": [0, 1, 0]}]},
        {"type": "sphere", "center": [9, 0, 0], "radius": 1}]})");
    EXPECT_EQ(shapesOf(scene),
              (std::vector<Shape>{SphereShape{{5, 6, 0}, 3}, PlaneShape{{5, 3, 0}, {0, 1, 0}},
                                  SphereShape{{9, 0, 0}, 1}}));
    EXPECT_EQ(scene.objects[0].name, "/objects/0/objects/0/objects/0");
    EXPECT_EQ(scene.objects[1].name, "/objects/0/objects/1");
    for (const Object& object : scene.objects) EXPECT_FALSE(object.transform);
}

TEST(Group, MaterialsAreHandedDown) {
    const Scene scene = parse(R"({"materials": {"red": {}, "blue": {}, "green": {}}, "objects": [
        {"type": "group", "material": "red", "objects": [
            {"type": "sphere", "center": [0, 0, 0], "radius": 1},
            {"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "green"},
            {"type": "group", "material": "blue", "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1}]},
            {"type": "group", "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1}]}]},
        {"type": "sphere", "center": [0, 0, 0], "radius": 1}]})");
    const char* const expected[] = {"red", "green", "blue", "red", "default"};
    ASSERT_EQ(scene.objects.size(), 5u);
    for (size_t i = 0; i < 5; ++i)
        EXPECT_EQ(scene.materials[scene.objects[i].material].name, expected[i]) << i;
}

std::string nested(size_t depth) {
    std::string text = R"({"type": "sphere", "center": [0, 0, 0], "radius": 1})";
    for (size_t i = 0; i < depth; ++i)
        text = R"({"type": "group", "transform": [{"translate": [1, 0, 0]}], "objects": [)" + text + "]}";
    return R"({"objects": [)" + text + "]}";
}

TEST(Group, MayBeNested24Deep) {
    const Scene scene = parse(nested(24));
    EXPECT_EQ(std::get<SphereShape>(scene.objects[0].shape).center, dvec3(24, 0, 0));
    const std::string error = parseErrorOf(nested(25).c_str());
    EXPECT_HAS(error, "groups must not be nested deeper than 24");
}

TEST(Placement, WhatDoesNotStayRound) {
    const Scene scene = parse(R"({"objects": [
        {"type": "sphere", "center": [1, 2, 3], "radius": 2, "transform": [{"scale": [1, 2, 1]}]},
        {"type": "disc", "center": [1, 0, 0], "normal": [0, 3, 0], "radius": 2, "transform": [{"scale": [1, 5, 3]}]},
        {"type": "disc", "center": [1, 0, 0], "normal": [0, 3, 0], "radius": 2, "transform": [{"scale": [3, 5, 3]}]}]})");
    // A sphere becomes an ellipsoid, which keeps its transform.
    EXPECT_EQ(scene.objects[0].shape, Shape(EllipsoidShape{{1, 2, 3}, {2, 2, 2}}));
    EXPECT_EQ(scene.objects[0].transform->linear, dmat3(1, 0, 0, 0, 2, 0, 0, 0, 1));
    const auto& disc = std::get<DiscShape>(scene.objects[1].shape);
    EXPECT_EQ(disc.normal, dvec3(0, 0, 1));
    // The unit disc's axes go to vectors of lengths 2 and 6 in the plane y = 0, its normal along y.
    const dmat3& m = scene.objects[1].transform->linear;
    EXPECT_EQ(scene.objects[1].transform->offset, dvec3(1, 0, 0));
    EXPECT_EQ(m[0].y, 0);
    EXPECT_EQ(m[1].y, 0);
    EXPECT_DOUBLE_EQ(std::abs(m[0].x * m[1].z - m[0].z * m[1].x), 12);
    EXPECT_DOUBLE_EQ(m[2].y, 10);
    EXPECT_FALSE(scene.objects[2].transform);
    EXPECT_STARTS(
        parseErrorOf(
            R"({"objects": [{"type": "disc", "center": [0, 0, 0], "normal": [1, 0, 0], "radius": 1, "transform":
        [{"rotate": [1, 0, 0, 45]}, {"scale": [1, 1, 1e6]}, {"rotate": [1, 0, 0, 45]}]}]})"),
        "s.json: /objects/0/transform: too uneven for single precision");
}

// Two objects share a mesh of 100 x 100 x 2 triangles, which saves 2 MB. One object does not, and neither do
// two objects of two triangles.
TEST(Placement, MeshesAreSharedWhereThatSavesMemory) {
    const auto grid = [](uint32_t n) {
        auto mesh = std::make_shared<Mesh>();
        mesh->positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
        mesh->corners.assign(size_t{n} * n * 2, {0, 1, 2});
        return mesh;
    };
    Scene scene;
    const auto large = grid(100), alone = grid(100), small = grid(1), slanted = grid(100);
    const Affine moved = translation({1, 0, 0});
    const Affine uneven = then(then(rotation({0, 0, 1}, 45), scaling({1, 1e4, 1})), rotation({0, 0, 1}, 45));
    for (const auto& [mesh, transform] :
         std::vector<std::pair<std::shared_ptr<Mesh>, std::optional<Affine>>>{{large, moved},
                                                                              {large, {}},
                                                                              {alone, moved},
                                                                              {small, moved},
                                                                              {small, {}},
                                                                              {slanted, moved},
                                                                              {slanted, uneven}})
        scene.objects.push_back({"", MeshShape{mesh}, 0, transform});
    placeObjects(scene);
    const bool instance[] = {true, true, false, false, false, false, false};
    for (size_t i = 0; i < 7; ++i) EXPECT_EQ(scene.objects[i].transform.has_value(), instance[i]) << i;
    EXPECT_EQ(*scene.objects[1].transform, Affine{});
    EXPECT_EQ(meshOf(scene, 2).positions[0], dvec3(1, 0, 0));
    EXPECT_EQ(std::get<MeshShape>(scene.objects[0].shape).mesh, large);
    Scene again = scene;
    placeObjects(again);
    for (size_t i = 0; i < 7; ++i) EXPECT_EQ(again.objects[i].transform, scene.objects[i].transform) << i;
}

TEST(Placement, InverseAndLoss) {
    const Affine a =
        then(then(rotation({1, 2, 3}, 40), scaling({1e-9, 2e-9, -1e-9})), translation({3, 4, 5}));
    const Affine both = then(a, inverse(a));
    for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR(both.offset[i], 0, 1e-6);  // 5 / 1e-9 times 2^-52
        for (int j = 0; j < 3; ++j) EXPECT_NEAR(both.linear[i][j], i == j, 1e-14);
    }
    EXPECT_DOUBLE_EQ(transformLoss(scaling({1e-4, 1, 1e4}).linear, dvec3(1)), 1);
    // A turn by 45 degrees: |A| |A^-1| has the rows (1, 1, 0), (1, 1, 0), (0, 0, 1) times sizes (sqrt 2, sqrt
    // 2, 1).
    EXPECT_NEAR(transformLoss(rotation({0, 0, 1}, 45).linear, dvec3(1)), 2, 1e-12);
}

}  // namespace glint::test::group_test
