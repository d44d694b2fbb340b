// Quadrics in scene files: what is read, and what is refused.
#include "import/load.h"
#include "support.h"

namespace glint::test::quadric_test {

namespace {

using glm::dvec3;

Scene parseObjects(const std::string& objects) {
    return parseScene("{\"objects\": [" + objects + "]}", "s.json", ".");
}

std::string errorIn(const std::string& object) {
    return errorOf([&] { parseObjects(object); });
}

}  // namespace

TEST(ParseQuadric, EveryForm) {
    const Scene scene = parseObjects(R"(
        {"type": "quadric", "coefficients": [1, 2, 3, 4, 5, 6, 7, 8, 9, 10], "bounds": [[-1, -2, -3], [1, 2, 3]]},
        {"type": "ellipsoid", "center": [1, 2, 3], "radii": [4, 5, 6]},
        {"type": "cylinder", "base": [0, 0, 1], "top": [0, 0, 2], "radius": 3},
        {"type": "cone", "base": [0, 0, 1], "apex": [0, 0, 2], "radius": 3, "topRadius": 1, "capped": true},
        {"type": "hyperboloid", "base": [0, 0, 1], "top": [0, 0, 2], "radius": 3, "waist": 2, "capped": false},
        {"type": "paraboloid", "vertex": [0, 0, 1], "top": [0, 0, 2], "radius": 3, "capped": true})");
    const auto& quadric = std::get<QuadricShape>(scene.objects[0].shape);
    EXPECT_EQ(quadric.coefficients[0], 1);
    EXPECT_EQ(quadric.coefficients[9], 10);
    EXPECT_EQ(quadric.lo, dvec3(-1, -2, -3));
    EXPECT_EQ(quadric.hi, dvec3(1, 2, 3));
    EXPECT_EQ(std::get<EllipsoidShape>(scene.objects[1].shape).radii, dvec3(4, 5, 6));
    const auto& cylinder = std::get<CylinderShape>(scene.objects[2].shape);
    EXPECT_EQ(cylinder.top, dvec3(0, 0, 2));
    EXPECT_FALSE(cylinder.capped);
    const auto& cone = std::get<ConeShape>(scene.objects[3].shape);
    EXPECT_EQ(cone.topRadius, 1);
    EXPECT_TRUE(cone.capped);
    EXPECT_EQ(std::get<HyperboloidShape>(scene.objects[4].shape).waist, 2);
    EXPECT_TRUE(std::get<ParaboloidShape>(scene.objects[5].shape).capped);
}

TEST(ParseQuadric, Transforms) {
    const Scene scene = parseObjects(R"(
        {"type": "sphere", "center": [1, 0, 0], "radius": 2, "transform": [{"scale": [1, 2, 1]}]},
        {"type": "sphere", "center": [1, 0, 0], "radius": 2, "transform": [{"scale": 3}]},
        {"type": "cylinder", "base": [0, 0, 1], "top": [0, 0, 2], "radius": 3, "transform": [{"translate": [5, 0, 0]}]})");
    EXPECT_EQ(std::get<EllipsoidShape>(scene.objects[0].shape).radii, dvec3(2));
    ASSERT_TRUE(scene.objects[0].transform);
    EXPECT_EQ(scene.objects[0].transform->linear[1], dvec3(0, 2, 0));
    EXPECT_EQ(std::get<SphereShape>(scene.objects[1].shape).radius, 6);
    EXPECT_FALSE(scene.objects[1].transform);
    ASSERT_TRUE(scene.objects[2].transform);
    EXPECT_EQ(scene.objects[2].transform->offset, dvec3(5, 0, 0));
}

TEST(ParseQuadric, RefusesWhatIsNone) {
    const std::string at = "s.json: /objects/0";
    EXPECT_EQ(errorIn(R"({"type": "quadric", "coefficients": [1, 2], "bounds": [[0,0,0],[1,1,1]]})"),
              at + "/coefficients: must be ten numbers [A, B, C, D, E, F, G, H, I, J] (got [1, 2])");
    EXPECT_EQ(
        errorIn(R"({"type": "quadric", "coefficients": [0,0,0,0,0,0,0,0,0,0], "bounds": [[0,0,0],[1,1,1]]})"),
        at + "/coefficients: one of A to I must not be 0: J = 0 alone is no surface, but nothing or "
             "everything");
    EXPECT_EQ(
        errorIn(R"({"type": "quadric", "coefficients": [1,0,0,0,0,0,0,0,0,0], "bounds": [[0,2,0],[1,1,1]]})"),
        at + "/bounds: the first corner must be less than the second in x, y and z (got [0, 2, 0] and [1, 1, "
             "1])");
    EXPECT_EQ(errorIn(R"({"type": "ellipsoid", "center": [0,0,0], "radii": [1,0,1]})"),
              at + "/radii/1: must be > 0 (got 0)");
    EXPECT_EQ(errorIn(R"({"type": "cylinder", "base": [0,0,0], "top": [0,0,0], "radius": 1})"),
              at + "/top: must differ from base (got [0, 0, 0])");
    EXPECT_EQ(errorIn(R"({"type": "cylinder", "base": [0,0,0], "top": [0,1e9,0], "radius": 1})"),
              at + ": height and radius must not differ by more than a factor of 1e+08 (got 1e+09 and 1)");
    EXPECT_EQ(errorIn(R"({"type": "cylinder", "base": [0,0,0], "top": [0,1,0], "radius": 1, "capped": 1})"),
              at + "/capped: must be true or false (got 1)");
    EXPECT_EQ(errorIn(R"({"type": "cone", "base": [0,0,0], "apex": [0,1,0], "radius": 1, "topRadius": 1})"),
              at + "/topRadius: must not be the radius, or the cone is a cylinder (got 1)");
    EXPECT_EQ(errorIn(R"({"type": "hyperboloid", "base": [0,0,0], "top": [0,1,0], "radius": 1, "waist": 1})"),
              at + "/waist: must be less than the radius, 1 (got 1)");
    EXPECT_EQ(errorIn(R"({"type": "paraboloid", "vertex": [0,0,0], "top": [0,1,0], "radius": -1})"),
              at + "/radius: must be > 0 (got -1)");
}

}  // namespace glint::test::quadric_test
