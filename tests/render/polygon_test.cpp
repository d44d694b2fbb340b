// Polygons on the device and in the reference: the even-odd rule and shared edges.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "support.h"

namespace glint::render::test::polygon_test {
using glm::dvec3;
using glm::vec3;

class PolygonTest : public RenderTest {};

struct Point {
    float x, y;
    bool inside;
};

std::vector<dvec3> pentagram() {
    std::vector<dvec3> star;
    for (int i = 0; i < 5; ++i) {
        const double angle = std::numbers::pi / 2 + 4 * std::numbers::pi * i / 5;
        star.emplace_back(std::cos(angle), std::sin(angle), 0);
    }
    return star;
}

// tests/stability/cases.md T70, T71, and T74: the L with doubled and collinear vertices. A pentagram winds
// twice around its middle; a bridge leads into and out of a window. From both sides, from each start of the
// outline, both ways round.
TEST_F(PolygonTest, EvenOddRule) {
    const std::vector<Point> inL = {{1.5f, 0.5f, true}, {1.5f, 1.5f, false}, {0.5f, 1, true}, {1, 0.5f, true},
                                    {3, 1, false},      {-1, 1, false},      {-1, 2, false},  {1, 3, false}};
    const std::pair<std::vector<dvec3>, std::vector<Point>> cases[] = {
        {{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {1, 1, 0}, {1, 2, 0}, {0, 2, 0}}, inL},
        {{{0, 0, 0},
          {2, 0, 0},
          {2, 0, 0},
          {2, 1, 0},
          {1.5, 1, 0},
          {1, 1, 0},
          {1, 2, 0},
          {0, 2, 0},
          {0, 1, 0},
          {0, 0.5, 0}},
         inL},
        {{{0, 1, 0}, {1, 0, 0}, {2, 1, 0}, {1, 2, 0}},
         {{1, 1, true}, {-1, 1, false}, {3, 1, false}, {1, -1, false}, {1, 3, false}}},
        {pentagram(), {{0, 0, false}, {0, 0.8f, true}, {0.9f, 0.9f, false}}},
        {{{-2, -2, 0},
          {2, -2, 0},
          {2, 2, 0},
          {-2, 2, 0},
          {-2, -2, 0},
          {-1, -1, 0},
          {-1, 1, 0},
          {1, 1, 0},
          {1, -1, 0},
          {-1, -1, 0}},
         {{0, 0, false},
          {0.5f, -0.25f, false},
          {1.5f, 0, true},
          {-1.75f, -1.5f, true},
          {-1.5f, -1.75f, true},
          {3, 0, false}}}};
    for (auto [vertices, points] : cases) {
        std::vector<RayInput> rays;
        for (const Point& p : points) {
            rays.push_back(rayOf({p.x, p.y, 5}, {0, 0, -1}));
            rays.push_back(rayOf({p.x, p.y, -5}, {0, 0, 1}));
        }
        for (size_t turn = 0; turn < 2 * vertices.size(); ++turn) {
            std::rotate(vertices.begin(), vertices.begin() + 1, vertices.end());
            if (turn == vertices.size()) std::reverse(vertices.begin(), vertices.end());
            const std::vector<RayHit> hits = hitsOfBoth(packScene(sceneOf(PolygonShape{vertices})), rays);
            for (size_t i = 0; i < rays.size(); ++i) {
                ASSERT_EQ(hits[i].hit, points[i / 2].inside) << turn << ": " << text(rays[i]);
                if (!hits[i].hit) continue;
                EXPECT_EQ(hits[i].t, 5);
                EXPECT_EQ(glm::abs(hits[i].data.geometricNormal), vec3(0, 0, 1));
            }
        }
    }
}

// T12, T75: a sweep over the diagonal of a square (github.com/Oblikovati issue 2146). Every ray hits exactly
// one of two polygons that share it; in one plane and folded. Edges of triangles belong to each of them.
TEST_F(PolygonTest, SharedEdges) {
    for (const double fold : {0.0, 3.0, -2.0}) {
        for (const int triangles : {0, 1, 2}) {
            Scene scene = emptyScene();
            const dvec3 a(-5, -5, 0), b(5, 5, 0), left(-5, 5, fold), right(5, -5, 0.5 * fold);
            const auto add = [&](bool triangle, const dvec3& c, const dvec3& d) {
                triangle ? addTriangle(scene, a, c, d) : addPolygon(scene, {a, c, d});
            };
            add(triangles > 1, b, left);
            add(triangles > 0, right, b);
            std::vector<RayInput> rays = {rayOf({0, 0, 10}, {0.30458447f, 0.30458447f, -0.9024725f})};
            for (int k = 1; k <= 3999; ++k)
                rays.push_back(rayTowards({0, 0, 10}, {k / 1000.0, k / 1000.0, 0}, true));
            Random random(75);
            for (int k = 0; k < 4000; ++k)
                rays.push_back(
                    rayTowards(dvec3(0, 0, 12) + random.box(3), glm::mix(a, b, random.uniform(0.01, 0.99))));
            const PackedScene packed = packScene(scene);
            EXPECT_EQ(missesOf(packed, rays), 0u) << fold << triangles;
            if (triangles > 0) continue;
            const PackedScene one = packScene(sceneOf(PolygonShape{{a, b, left}})),
                              other = packScene(sceneOf(PolygonShape{{a, right, b}}));
            const auto first = hitsOf(one, rays), second = hitsOf(other, rays);
            const reference::Tracer firstTracer(one), secondTracer(other);
            for (size_t i = 0; i < rays.size(); ++i) {
                ASSERT_NE(first[i].hit, second[i].hit) << text(rays[i]);
                const reference::Ray ray = exactRay(rays[i]);
                ASSERT_NE(firstTracer.occluded(ray), secondTracer.occluded(ray)) << text(rays[i]);
            }
        }
    }
}

// A closed prism of 14 polygons seen from inside: no ray gets out, at edges and at vertices either.
TEST_F(PolygonTest, ClosedPrism) {
    constexpr int kSides = 12;
    std::vector<dvec3> bottom, top;
    const dvec3 axis(0.3, -0.2, 1.7);
    for (int i = 0; i < kSides; ++i) {
        const double angle = 2 * std::numbers::pi * i / kSides;
        const dvec3 p(vec3(std::cos(angle), 0.3 * std::cos(angle) + std::sin(angle), 0.1 * std::sin(angle)));
        bottom.push_back(p - axis);
        top.push_back(p + axis);
    }
    Scene scene = emptyScene();
    addPolygon(scene, top);
    addPolygon(scene, {bottom.rbegin(), bottom.rend()});
    for (size_t i = 0; i < kSides; ++i) {
        const size_t j = (i + 1) % kSides;
        addPolygon(scene, {bottom[i], bottom[j], top[j], top[i]});
    }
    Random random(14);
    std::vector<RayInput> rays;
    for (int i = 0; i < 30000; ++i) {
        const dvec3 from = random.box(0.25);
        const uint32_t k = random.below(kSides), next = (k + 1) % kSides;
        const dvec3 ends[][2] = {
            {bottom[k], bottom[next]}, {top[k], top[next]}, {bottom[k], top[k]}, {top[k], top[k]}};
        const auto& edge = ends[random.below(4)];
        rays.push_back(rayTowards(from, glm::mix(edge[0], edge[1], random.uniform(0, 1)), i % 2));
    }
    EXPECT_EQ(missesOf(packScene(scene), rays), 0u);
}

}  // namespace glint::render::test::polygon_test
