// Boxes in scene files: what is read, and what is refused.
#include "import/load.h"
#include "support.h"

namespace glint::test::box_test {

namespace {

Scene parseObjects(const std::string& objects) {
    return parseScene("{\"objects\": [" + objects + "]}", "s.json", ".");
}

std::string errorIn(const std::string& object) {
    return errorOf([&] { parseObjects(object); });
}

}  // namespace

TEST(ParseBox, CornersAndTransforms) {
    const Scene scene = parseObjects(R"(
        {"type": "box", "min": [1, 2, 3], "max": [4, 5, 6]},
        {"type": "box", "min": [0, 0, 0], "max": [1, 1, 1], "transform": [{"scale": [2, 3, 4]}, {"translate": [1, 0, 0]}]},
        {"type": "box", "min": [0, 0, 0], "max": [1, 1, 1], "transform": [{"rotate": [0, 1, 0, 30]}]})");
    EXPECT_EQ(std::get<BoxShape>(scene.objects[0].shape).min, glm::dvec3(1, 2, 3));
    EXPECT_EQ(std::get<BoxShape>(scene.objects[0].shape).max, glm::dvec3(4, 5, 6));
    EXPECT_EQ(std::get<BoxShape>(scene.objects[1].shape).max, glm::dvec3(3, 3, 4));
    EXPECT_FALSE(scene.objects[1].transform);
    EXPECT_TRUE(scene.objects[2].transform);
}

TEST(ParseBox, RefusesWhatIsNone) {
    EXPECT_EQ(errorIn(R"({"type": "box", "min": [0, 0, 0]})"), "s.json: /objects/0: missing key \"max\"");
    EXPECT_EQ(
        errorIn(R"({"type": "box", "min": [0, 2, 0], "max": [1, 1, 1]})"),
        "s.json: /objects/0/max: must be greater than min along each axis, by 1e-14 at least, which y is "
        "not (got [0, 2, 0] and [1, 1, 1])");
    EXPECT_NE(errorIn(R"({"type": "box", "min": [0, 0, 0], "max": [0, 1, 1]})").find("which x is not"),
              std::string::npos);
    EXPECT_NE(errorIn(R"({"type": "box", "min": [0, 0, -1e19], "max": [1, 1, 1]})").find("/min"),
              std::string::npos);
    EXPECT_NE(errorIn(R"({"type": "box", "min": [0, 0, 0], "max": [1, 1, 1], "size": 2})").find("size"),
              std::string::npos);
    EXPECT_NE(errorIn(R"({"type": "box", "min": [0, 0, 0], "max": [1, 1, 1],
                          "transform": [1, 1, 0, 0, 1, 1.00001, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]})")
                  .find("stretches too unevenly"),
              std::string::npos);
}

}  // namespace glint::test::box_test
