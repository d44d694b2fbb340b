// Cases of the catalogue (tests/stability/cases.md) that have no better place.
#include <gtest/gtest.h>

#include <cmath>

#include "../render/support.h"
#include "checks.h"
#include "reference/tracer.h"

namespace glint::stability::catalogue_test {
using glm::dvec3;
using glm::vec3;
using namespace render::test;

class CatalogueTest : public RenderTest {
  protected:
    Subject subject() const { return {&device(), {}}; }
};

// T08: Buck, features/spheres.feature, "computing the normal on a transformed sphere": the sphere turned by
// pi / 5 about z, then halved along y. The book's point (0, 1, -1) / sqrt 2 lies outside it, on the ray from
// the middle whose surface point has the same normal.
TEST_F(CatalogueTest, NormalOfATransformedSphere) {
    const Case c = textCase(
        R"({"objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1,
                         "transform": [{"rotate": [0, 0, 1, 36]}, {"scale": [1, 0.5, 1]}]}]})",
        1, 1);
    const dvec3 expected(0, 0.97014, -0.24254);
    const render::RayInput ray = rayOf({0, 3, -3}, {0, -1, 1});
    RayTracer kernels(device(), c.packed);
    const RayHit hit = kernels.trace({ray}, false)[0];
    ASSERT_TRUE(hit.hit);
    const reference::Tracer tracer(c.packed);
    const reference::Ray exact{dvec3(ray.origin), dvec3(ray.direction)};
    const auto found = tracer.closest(exact);
    ASSERT_TRUE(found);
    const dvec3 truth = tracer.surfaceAt(exact, *found).geometricNormal;
    // The book's digits.
    for (int axis = 0; axis < 3; ++axis) {
        EXPECT_NEAR(truth[axis], expected[axis], 5e-6);
        EXPECT_NEAR(hit.data.geometricNormal[axis], expected[axis], 6e-6);
    }
}

// T22: a mirrored triangle, its corners in another order, and axes exchanged: the same hits; mirrored, the
// same t in every bit. The rays aim at edges and corners too.
TEST_F(CatalogueTest, SymmetriesOfTheTriangleTest) {
    Random random(22);
    constexpr size_t kCount = 5000;
    std::vector<FloatRay> rays(kCount), mirrored(kCount), turned(kCount);
    std::vector<shared::Triangle> triangles(kCount), mirroredTriangles(kCount), turnedTriangles(kCount),
        cycled(kCount);
    const auto mirror = [](const vec3& v) { return vec3(-v.x, v.y, v.z); };
    const auto turn = [](const vec3& v) { return vec3(v.y, v.z, v.x); };
    for (size_t i = 0; i < kCount; ++i) {
        const vec3 v[3] = {vec3(random.box(1)), vec3(random.box(1)), vec3(random.box(1))};
        double u = random.uniform(-.2, 1), w = random.uniform(-.2, 1);
        if (i % 3 == 1) w = 0;
        if (i % 3 == 2) u = w = 0;
        const dvec3 at = (1 - u - w) * dvec3(v[0]) + u * dvec3(v[1]) + w * dvec3(v[2]);
        rays[i].origin = vec3(random.box(5));
        rays[i].direction = vec3(at - dvec3(rays[i].origin));
        mirrored[i] = {mirror(rays[i].origin), mirror(rays[i].direction)};
        turned[i] = {turn(rays[i].origin), turn(rays[i].direction)};
        for (auto [set, a, b, c] :
             {std::tuple(&triangles, v[0], v[1], v[2]), std::tuple(&cycled, v[1], v[2], v[0]),
              std::tuple(&mirroredTriangles, mirror(v[0]), mirror(v[1]), mirror(v[2])),
              std::tuple(&turnedTriangles, turn(v[0]), turn(v[1]), turn(v[2]))})
            (*set)[i] = triangleOf(a, b, c);
    }
    const std::vector<Answer> expected = probe(subject(), rays, triangles);
    const std::vector<Answer> byMirror = probe(subject(), mirrored, mirroredTriangles);
    const std::vector<Answer> byTurn = probe(subject(), turned, turnedTriangles);
    const std::vector<Answer> byCycle = probe(subject(), rays, cycled);
    size_t hits = 0;
    for (size_t i = 0; i < kCount; ++i) {
        hits += expected[i].hit;
        ASSERT_EQ(byMirror[i].hit, expected[i].hit) << i;
        ASSERT_EQ(byTurn[i].hit, expected[i].hit) << i;
        ASSERT_EQ(byCycle[i].hit, expected[i].hit) << i;
        if (!expected[i].hit) continue;
        ASSERT_EQ(byMirror[i].t, expected[i].t) << i;
        ASSERT_EQ(byTurn[i].t, expected[i].t) << i;
    }
    EXPECT_GT(hits, kCount / 4);
}

// T37 to T43: rays in the sides of a box, beside it, without a direction, from inside; flat boxes and empty
// ones. The boxes are widened by an ulp like those of src/bvh, which T37 needs: a ray in a side is in the box
// for a length of 0.
TEST_F(CatalogueTest, Boxes) {
    const float ulp = std::nextafter(1.0f, 2.0f) - 1.0f, least = 1e-37f;
    const Box cube = {vec3(-least), vec3(1 + ulp)},
              flat = {{-least, -least, -least}, {1 + ulp, 1 + ulp, least}};
    const Box empty = {vec3(std::numeric_limits<float>::infinity()),
                       vec3(-std::numeric_limits<float>::infinity())};
    const struct {
        Box box;
        FloatRay ray;
        bool hit;
        const char* name;
    } cases[] = {{cube, {{0, .5f, -1}, {0, 0, 1}}, true, "T37"},
                 {cube, {{0, .5f, -1}, {-0.0f, 0, 1}}, true, "T38"},
                 {cube, {{1, .5f, -1}, {-0.0f, -0.0f, 1}}, true, "T38, the other side"},
                 {cube, {{1.000001f, .5f, -1}, {0, 0, 1}}, false, "T40"},
                 {cube, {{.5f, .5f, .5f}, {0, 0, 1e-40f}}, true, "T41"},
                 {flat, {{.5f, .5f, -1}, {0, 0, 1}}, true, "T42"},
                 {flat, {{-1, .5f, 0}, {1, 0, 0}}, true, "T42, along it"},
                 {empty, {{.5f, .5f, -1}, {0, 0, 1}}, false, "T43"},
                 {empty, {{0, 0, 0}, {1, 1, 1}}, false, "T43, aslant"}};
    std::vector<FloatRay> rays;
    std::vector<Box> boxes;
    for (const auto& c : cases) {
        rays.push_back(c.ray);
        boxes.push_back(c.box);
    }
    const std::vector<Answer> answers = probe(subject(), rays, boxes);
    for (size_t i = 0; i < rays.size(); ++i) EXPECT_EQ(answers[i].hit, cases[i].hit) << cases[i].name;
}

// T98: the smallest picture and a very wide one; what no picture can be made of is refused
// (tests/scene/validate_test.cpp).
TEST_F(CatalogueTest, SmallestAndWidestPictures) {
    for (const glm::ivec2& size : {glm::ivec2(1, 1), glm::ivec2(16384, 2), glm::ivec2(1, 3000)}) {
        const Case c = fileCase("spheres", size.x, size.y);
        const Picture picture = draw(device(), c);
        EXPECT_EQ(picture.data.size(), static_cast<size_t>(size.x) * size.y);
        EXPECT_EQ(picture.notFinite, 0u);
        EXPECT_EQ(std::count(picture.done.begin(), picture.done.end(), 1), size.x * size.y);
        EXPECT_NE(picture.at(size.x / 2, size.y / 2).object, PixelData::kNoIndex);
    }
}

}  // namespace glint::stability::catalogue_test
