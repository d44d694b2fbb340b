// Intersection tests are open at tMin and closed at tMax, so a ray that continues from a hit misses it.
// Beyond tMax they report hits within the bound of t's error; the traversal holds the end of a caller's ray
// (AnalyticTest.IntervalIsOpenBelowAndClosedAbove).
#include <gtest/gtest.h>

#include "../render/support.h"
#include "probe.h"
#include "support/packed_scene_maker.h"

namespace glint::stability::intervals_test {
using glint::test::Random;
using glm::dvec3;
using glm::vec3;

constexpr size_t kCount = 2000;

class IntervalTest : public render::test::RenderTest {
  protected:
    Subject subject() const { return {&device(), {}}; }
    template <typename... Arrays>
    void expectEnds(const Arrays&... arrays) const {
        const std::vector<Answer> whole = probe(subject(), rays_, arrays...);
        std::vector<FloatRay> to = rays_, on = rays_;
        size_t hits = 0;
        for (size_t i = 0; i < kCount; ++i) {
            if (!whole[i].hit) continue;
            ++hits;
            const auto t = static_cast<float>(whole[i].t);
            to[i].tMax = on[i].tMin = t;
        }
        EXPECT_GT(hits, kCount / 10);
        const std::vector<Answer> closed = probe(subject(), to, arrays...),
                                  open = probe(subject(), on, arrays...);
        for (size_t i = 0; i < kCount; ++i) {
            if (!whole[i].hit) continue;
            EXPECT_TRUE(closed[i].hit) << i;
            EXPECT_EQ(closed[i].t, whole[i].t) << i;
            EXPECT_TRUE(!open[i].hit || open[i].t > whole[i].t) << i;
        }
    }

    // Towards what is about the origin, a unit large.
    void SetUp() override {
        RenderTest::SetUp();
        for (FloatRay& ray : rays_) {
            const dvec3 origin = random_.uniform(2, 5) * random_.direction();
            ray.origin = vec3(origin);
            ray.direction = vec3(random_.uniform(0.3, 3) * (random_.box(0.4) - origin));
        }
    }

    Random random_{731};
    std::vector<FloatRay> rays_ = std::vector<FloatRay>(kCount);
};

TEST_F(IntervalTest, OfTriangles) {
    std::vector<shared::Triangle> triangles(kCount);
    for (shared::Triangle& triangle : triangles)
        triangle = {.v0 = vec3(random_.box(1)), .v1 = vec3(random_.box(1)), .v2 = vec3(random_.box(1))};
    expectEnds(triangles);
}

TEST_F(IntervalTest, OfSpheres) {
    std::vector<shared::Sphere> spheres(kCount);
    for (shared::Sphere& sphere : spheres)
        sphere = {.point = vec3(random_.box(0.3)), .radius = static_cast<float>(random_.uniform(0.3, 1))};
    expectEnds(spheres);
}

TEST_F(IntervalTest, OfPlanes) {
    std::vector<shared::Plane> planes(kCount);
    for (shared::Plane& plane : planes)
        plane = {.point = vec3(random_.box(1)), .normal = vec3(random_.direction())};
    expectEnds(planes);
}

TEST_F(IntervalTest, OfDiscs) {
    std::vector<shared::Disc> discs(kCount);
    for (shared::Disc& disc : discs)
        disc = {.center = vec3(random_.box(0.3)), .normal = vec3(random_.direction()), .radius = 1};
    expectEnds(discs);
}

TEST_F(IntervalTest, OfPolygons) {
    std::vector<shared::Polygon> polygons(kCount);
    std::vector<shared::PolygonVertex> vertices;
    for (shared::Polygon& polygon : polygons) {
        const dvec3 corners[3] = {random_.box(1), random_.box(1), random_.box(1)};
        polygon.point = vec3(corners[0]);
        polygon.normal = vec3(glm::normalize(glm::cross(corners[1] - corners[0], corners[2] - corners[0])));
        polygon.firstVertex = static_cast<uint32_t>(vertices.size());
        polygon.trips = 1;
        // The first one again closes the outline, and fills it up.
        for (size_t k = 0; k <= shared::kPolygonEdgesPerTrip; ++k)
            vertices.push_back({vec3(corners[k < 3 ? k : 0])});
    }
    expectEnds(polygons, vertices);
}

// Ellipsoids, pipes and hyperboloids of one and of two sheets, cut by boxes, some with caps.
TEST_F(IntervalTest, OfQuadrics) {
    std::vector<shared::Quadric> quadrics(kCount);
    for (size_t i = 0; i < kCount; ++i) {
        shared::Quadric& quadric = quadrics[i];
        quadric.point = vec3(random_.box(0.2));
        quadric.toLocal0.x = quadric.toLocal1.y = quadric.toLocal2.z = 1;
        quadric.squares = {1, 1, random_.uniform(-1, 1)};
        quadric.constant = static_cast<float>(random_.uniform(-0.5, 0.1));
        quadric.lo = vec3(-1);
        quadric.hi = vec3(1);
        quadric.caps = i % 2 == 0 ? shared::kCapLower | shared::kCapUpper : 0;
    }
    expectEnds(quadrics);
}

}  // namespace glint::stability::intervals_test
