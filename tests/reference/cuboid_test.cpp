// Boxes in the reference: exact truth by whole numbers.
#include <gtest/gtest.h>

#include "pack/packed_scene.h"
#include "support/packed_scene_maker.h"

namespace glint::reference::test::cuboid_test {
using namespace glint::test;

using glm::dvec3;

PackedScene packBox(const dvec3& low, const dvec3& high) {
    Scene scene;
    scene.materials.resize(1);
    scene.objects.push_back({"/objects/0", BoxShape{low, high}, 0});
    return packScene(scene);
}

// Of whole numbers the slabs' bounds are fractions whose cross products are exact in 64 bits.
struct Fraction {
    int64_t over, under;  // under > 0
    bool operator<(const Fraction& o) const { return over * o.under < o.over * under; }
};

std::optional<double> exactHit(const int (&o)[3], const int (&d)[3], const int (&low)[3],
                               const int (&high)[3]) {
    std::optional<Fraction> enter, leave;
    for (int i = 0; i < 3; ++i) {
        if (d[i] == 0) {
            if (o[i] < low[i] || o[i] > high[i]) return std::nullopt;
            continue;
        }
        const int sign = d[i] < 0 ? -1 : 1;
        const Fraction a{sign * ((sign > 0 ? low[i] : high[i]) - o[i]), sign * d[i]};
        const Fraction b{sign * ((sign > 0 ? high[i] : low[i]) - o[i]), sign * d[i]};
        if (!enter || *enter < a) enter = a;
        if (!leave || b < *leave) leave = b;
    }
    if (!enter || *leave < *enter || leave->over <= 0) return std::nullopt;
    const Fraction& hit = enter->over > 0 ? *enter : *leave;
    return static_cast<double>(hit.over) / static_cast<double>(hit.under);
}

TEST(ReferenceCuboid, WholeNumbersExactly) {
    Random random(6);
    const auto whole = [&](int most) {
        return static_cast<int>(std::floor(random.uniform(-most, most + 1)));
    };
    size_t hits = 0, touches = 0;
    for (int k = 0; k < 300; ++k) {
        int low[3], high[3];
        for (int i = 0; i < 3; ++i) {
            low[i] = whole(4);
            high[i] = low[i] + 1 + std::abs(whole(3));
        }
        const PackedScene scene = packBox({low[0], low[1], low[2]}, {high[0], high[1], high[2]});
        const Tracer tracer(scene);
        for (int r = 0; r < 100; ++r) {
            int o[3], d[3];
            for (int i = 0; i < 3; ++i) o[i] = whole(9), d[i] = whole(6);
            if (d[0] == 0 && d[1] == 0 && d[2] == 0) continue;
            // Coordinates may be counted from near the box, by whole numbers.
            const Ray ray{dvec3(o[0], o[1], o[2]) - scene.origin, {d[0], d[1], d[2]}};
            const auto truth = exactHit(o, d, low, high);
            const auto hit = tracer.closest(ray);
            ASSERT_EQ(hit.has_value(), truth.has_value()) << k << " " << r;
            EXPECT_EQ(hit, tracer.closestBruteForce(ray));
            if (!truth) continue;
            ++hits;
            EXPECT_EQ(hit->t, *truth);
            const dvec3 at = scene.origin + ray.origin + hit->t * ray.direction;
            int sides = 0;
            for (int i = 0; i < 3; ++i) sides += at[i] == low[i] || at[i] == high[i];
            touches += sides > 1;
        }
    }
    EXPECT_GT(hits, 400u);
    EXPECT_GT(touches, 20u) << "edges and corners are among them";
}

// A ray that starts on a face leaves the box for good, or meets the face where it goes out.
TEST(ReferenceCuboid, TheSourceIsNeverMetAgain) {
    const PackedScene scene = packBox({-1, -1, -1}, {1, 1, 1});
    const Tracer tracer(scene);
    const auto hit = tracer.closest({{0.25, 5, 0.5}, {0, -1, 0}});
    ASSERT_TRUE(hit);
    EXPECT_EQ(hit->primitive >> shared::kPartShift & shared::kPartMask, 3u) << "the upper face across y";
    const dvec3 on(0.25, 1, 0.5);
    EXPECT_FALSE(tracer.closest({on, {0.5, 1, 0}}, sourceOf(*hit)));
    EXPECT_FALSE(tracer.closest({on - dvec3(0, 1e-9, 0), {0.5, 1e-3, 0}}, sourceOf(*hit))) << "from below";
    const auto through = tracer.closest({on + dvec3(0, 1e-9, 0), {0, -1, 0}}, sourceOf(*hit));
    ASSERT_TRUE(through) << "from above";
    EXPECT_NEAR(through->t, 2, 1e-8);
    EXPECT_EQ(through->primitive >> shared::kPartShift & shared::kPartMask, 2u);
    EXPECT_NEAR(tracer.closest({on, {1, -0.5, 0}}, sourceOf(*hit))->t, 0.75, 1e-12) << "the side";
}

TEST(ReferenceCuboid, AllHitsAreTwo) {
    const PackedScene scene = packBox({-1, -1, -1}, {1, 1, 1});
    const Tracer tracer(scene);
    const auto hits = tracer.allHits({{0.5, 0.25, 7}, {0, 0, -1}});
    ASSERT_EQ(hits.size(), 2u);
    EXPECT_EQ(hits[0].t, 6);
    EXPECT_EQ(hits[1].t, 8);
}

// u to the right and v upwards as seen from outside; top and bottom as floor and ceiling.
TEST(ReferenceCuboid, CoordinatesOfFaces) {
    const PackedScene scene = packBox({0, 0, 0}, {4, 2, 1});
    const Tracer tracer(scene);
    const auto uvAt = [&](const dvec3& point, const dvec3& out) {
        const Ray ray{point + out, -out};
        return tracer.surfaceAt(ray, tracer.closest(ray).value()).uv;
    };
    EXPECT_EQ(uvAt({1, 0.5, 1}, {0, 0, 1}), glm::dvec2(0.25, 0.25));
    EXPECT_EQ(uvAt({1, 0.5, 0}, {0, 0, -1}), glm::dvec2(0.75, 0.25));
    EXPECT_EQ(uvAt({4, 0.5, 0.25}, {1, 0, 0}), glm::dvec2(0.75, 0.25));
    EXPECT_EQ(uvAt({0, 0.5, 0.25}, {-1, 0, 0}), glm::dvec2(0.25, 0.25));
    EXPECT_EQ(uvAt({1, 2, 0.25}, {0, 1, 0}), glm::dvec2(0.25, 0.75));
    EXPECT_EQ(uvAt({1, 0, 0.25}, {0, -1, 0}), glm::dvec2(0.25, 0.25));
}

}  // namespace glint::reference::test::cuboid_test
