// Surfaces of flat shapes, boxes, ties, and the BVH against testing every primitive.
#include <gtest/gtest.h>

#include <functional>

#include "support/packed_scene_maker.h"

namespace glint::reference::test::traversal_test {

using namespace glint::test;

using glm::dvec3;
using glm::vec3;

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// A ray that starts on a flat shape never hits it again, however far its start is off.
TEST(ReferenceFlat, SurfaceAndSource) {
    const std::function<void(SceneMaker&, float)> shapes[] = {
        [](SceneMaker& maker, float z) {
            maker.triangle({0, 0, z}, {1, 0, z}, {0, 1, z}, 1);
        },
        [](SceneMaker& maker, float z) {
            maker.disc({0, 0, z}, {0, 0, 1}, 2, 1);
        },
        [](SceneMaker& maker, float z) {
            maker.polygon({{0, 0, z}, {2, 0, z}, {2, 1, z}, {0, 1, z}}, 1);
        },
        [](SceneMaker& maker, float z) {
            maker.plane({0, 0, z}, {0, 0, 1}, 1);
        }};
    for (const auto& add : shapes) {
        SceneMaker maker;
        maker.material(vec3(0.5));
        add(maker, 0);
        add(maker, -1);
        const SceneTracer tracer(maker);
        Ray ray = makeRay({0.25, 0.5, 3}, {0, 0, -1});
        const auto hit = tracer.closest(ray);
        ASSERT_TRUE(hit);
        EXPECT_EQ(hit->id, 0u);
        const Surface surface = tracer.surfaceAt(ray, *hit);
        EXPECT_EQ(surface.position, dvec3(0.25, 0.5, 0));
        EXPECT_EQ(surface.geometricNormal, dvec3(0, 0, 1));
        EXPECT_EQ(surface.shadingNormal, dvec3(0, 0, 1));
        EXPECT_EQ(surface.material, 1u);
        const auto next = tracer.closest(ray, hit->primitive);
        ASSERT_TRUE(next);
        EXPECT_EQ(next->id, 1u);
        EXPECT_EQ(next, closestOfAll(tracer, ray, hit->primitive));
        ray.tMax = 3.5;
        EXPECT_TRUE(tracer.occluded(ray));
        EXPECT_FALSE(tracer.occluded(ray, hit->primitive));
    }
}

// Reprojected: the distance from the plane is a few roundings of the coordinates, not of t.
TEST(ReferencePlane, SurfaceLiesOnThePlane) {
    Random random(69);
    for (int i = 0; i < 500; ++i) {
        SceneMaker maker;
        const vec3 point(random.box(10)), normal(random.direction());
        maker.plane(point, normal);
        const SceneTracer tracer(maker);
        const dvec3 at = dvec3(point) + random.box(1);
        const Ray ray = rayTowards(at + 1e6 * random.direction(), at);
        const auto hit = tracer.closest(ray);
        ASSERT_TRUE(hit);
        const Surface surface = tracer.surfaceAt(ray, *hit);
        const dvec3 n = glm::normalize(dvec3(normal));
        EXPECT_EQ(surface.geometricNormal, n);
        const double coordinates = glm::length(surface.position) + glm::length(dvec3(point));
        EXPECT_LE(std::abs(glm::dot(n, surface.position - dvec3(point))), 8 * 0x1p-53 * coordinates);
    }
}

TEST(ReferenceBoxes, TinyDirections) {
    SceneMaker maker;
    maker.triangle({0, 0, .5f}, {1, 0, .5f}, {0, 1, .5f});
    const SceneTracer tracer(maker);
    EXPECT_DOUBLE_EQ(tracer.closest(makeRay({.25, .25, 0}, {0, 0, 1e-40}))->t, .5e40);
    EXPECT_DOUBLE_EQ(tracer.closest(makeRay({.25, .25, 0}, {1e-50, 0, 1e-40}))->t, .5e40);
    EXPECT_FALSE(tracer.closest(makeRay({.25, .25, 0}, {0, 0, 0})));
    EXPECT_FALSE(tracer.occluded(makeRay({.25, .25, 0}, {0, -0.0, 0})));
}

TEST(ReferenceBoxes, EmptyBoxIsNeverEntered) {
    SceneMaker maker;
    maker.triangle({0, 0, .5f}, {1, 0, .5f}, {0, 1, .5f});
    PackedScene scene = maker.finish();
    for (const float huge : {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::max()}) {
        scene.nodes[0].lo0 = vec3(huge);
        scene.nodes[0].hi0 = vec3(-huge);
        const Tracer tracer(scene);
        Random random(43);
        for (int i = 0; i < 1000; ++i)
            EXPECT_FALSE(tracer.closest(rayTowards(random.box(2), {.25, .25, .5})));
        EXPECT_FALSE(tracer.closest(makeRay({.25, .25, 0}, {0, 0, 1})));
    }
}

TEST(ReferenceTraversal, NotFiniteRaysMissAtOnce) {
    SceneMaker maker;
    Random random(45);
    for (int i = 0; i < 1000; ++i) {
        const vec3 c(random.box(10));
        maker.triangle(c, c + vec3(random.box(1)), c + vec3(random.box(1)));
    }
    maker.sphere(vec3(0), 1);
    maker.plane(vec3(0), {0, 1, 0});
    const SceneTracer tracer(maker);
    for (const double bad : {kNan, kInf, -kInf}) {
        for (int component = 0; component < 6; ++component) {
            Ray ray = makeRay({0, 5, 0}, {0, -1, 0});
            (component < 3 ? ray.origin : ray.direction)[component % 3] = bad;
            uint64_t cost = 0;
            EXPECT_FALSE(tracer.closest(ray, shared::kNone, &cost));
            EXPECT_FALSE(tracer.occluded(ray, shared::kNone, &cost));
            EXPECT_FALSE(closestOfAll(tracer, ray));
            EXPECT_EQ(cost, 0u);
        }
    }
    Ray ray = makeRay({0, 5, 0}, {0, -1, 0});
    ray.tMax = kNan;
    EXPECT_FALSE(tracer.closest(ray));
    ray.tMax = kInf;
    ray.tMin = kNan;
    EXPECT_FALSE(tracer.closest(ray));
}

// One box with one triangle (the second child is absent) and a plane: three tests; missing the box: two.
TEST(ReferenceTraversal, CostCountsBoxesAndPrimitives) {
    SceneMaker maker;
    maker.triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    maker.plane({0, 0, -1}, {0, 0, 1});
    const SceneTracer tracer(maker);
    uint64_t cost = 0;
    tracer.closest(makeRay({.25, .25, 1}, {0, 0, -1}), shared::kNone, &cost);
    EXPECT_EQ(cost, 3u);
    tracer.closest(makeRay({5, 5, 1}, {0, 0, -1}), shared::kNone, &cost);
    EXPECT_EQ(cost, 5u) << "adds to what is there";
    cost = 0;
    tracer.occluded(makeRay({5, 5, 1}, {0, 0, -1}), shared::kNone, &cost);
    EXPECT_EQ(cost, 1u) << "the first hit ends it";
}

TEST(ReferenceTraversal, ParallelRayBesideABoxDoesNotEnterIt) {
    SceneMaker maker;
    maker.triangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
    const SceneTracer tracer(maker);
    for (const double zero : {0.0, -0.0}) {
        uint64_t cost = 0;
        EXPECT_FALSE(tracer.closest(makeRay({5, .5, 1}, {zero, zero, -1}), shared::kNone, &cost));
        EXPECT_FALSE(tracer.closest(makeRay({.5, -5, 1}, {zero, zero, -1}), shared::kNone, &cost));
        EXPECT_EQ(cost, 2u) << "one box for each ray";
    }
}

// Overlapping triangles in the plane z = 1, each in a leaf of its own: the flat boxes' near t rounds
// otherwise than the hit's t, and must not hide an equal t with a lower id.
TEST(ReferenceTies, CoplanarTrianglesInDifferentBoxes) {
    SceneMaker maker;
    for (uint32_t i = 0; i < 16; ++i) {
        maker.setNextId((i * 7) % 16);
        const float size = 4.0f + static_cast<float>(i);
        maker.triangle({-size, -size, 1}, {size, -size, 1}, {0, size, 1});
    }
    const SceneTracer tracer(maker, 1);
    Random random(95);
    for (int i = 0; i < 5000; ++i) {
        const dvec3 from = random.box(3) + dvec3(0, 0, 5);
        const dvec3 at(random.uniform(-1, 1), random.uniform(-1, 1), 1);
        const auto hit = tracer.closest(makeRay(from, glm::normalize(at - from)));
        ASSERT_TRUE(hit);
        EXPECT_EQ(hit->id, 0u) << i;
    }
}

// Many primitives that share vertices and touch: mixed kinds, any scale, near the origin or away from it.
struct MixedScene {
    PackedScene scene;
    std::vector<dvec3> targets;  // vertices, tangent points, box corners

    MixedScene(Random& random, double scale, const dvec3& offset) {
        SceneMaker maker;
        const auto point = [&] { return vec3(offset + random.box(scale)); };
        vec3 last = point();
        for (int i = 0; i < 60; ++i) {
            const vec3 a = point();
            const vec3 b = a + vec3(random.box(.3 * scale)),
                       c = random.below(3) ? a + vec3(random.box(.3 * scale)) : last;
            maker.triangle(a, b, c);
            if (i % 7 == 0) maker.triangle(a, c, b);  // the same again, from behind
            targets.insert(targets.end(), {dvec3(a), dvec3(b), .5 * dvec3(a) + .5 * dvec3(b)});
            last = a;
        }
        for (int i = 0; i < 30; ++i) {
            const vec3 c = point();
            const auto r = static_cast<float>(random.uniform(.02, .3) * scale);
            maker.sphere(c, r);
            if (i % 7 == 0) maker.sphere(c, r);
            targets.push_back(dvec3(c) + static_cast<double>(r) * random.direction());
        }
        maker.anchoredSphere(vec3(offset - dvec3(0, scale, 0)), {0, 1, 0}, static_cast<float>(1e4 * scale));
        maker.plane(vec3(offset - dvec3(0, scale, 0)), {0, 1, 0});
        maker.plane(point(), vec3(random.direction()));
        scene = maker.finish(1 + random.below(8));
        for (const shared::Node& n : scene.nodes) targets.insert(targets.end(), {dvec3(n.lo0), dvec3(n.hi0)});
    }

    Ray ray(Random& random, double scale, const dvec3& offset) const {
        const dvec3 from = random.below(4) ? offset + random.box(2 * scale)
                                           : targets[random.below(static_cast<uint32_t>(targets.size()))];
        Ray r = makeRay(from, random.direction());
        const uint32_t kind = random.below(4);
        if (kind == 0) r = rayTowards(from, targets[random.below(static_cast<uint32_t>(targets.size()))]);
        if (kind == 1) {  // along an axis, through a target
            const dvec3 at = targets[random.below(static_cast<uint32_t>(targets.size()))];
            const int axis = static_cast<int>(random.below(3));
            r = makeRay(at, dvec3(0));
            r.origin[axis] = offset[axis] + 3 * scale;
            r.direction[axis] = -1;
        }
        if (random.below(4) == 0) r.tMin = random.uniform(0, scale) / glm::length(r.direction);
        if (random.below(4) == 0) r.tMax = random.uniform(0, 3 * scale) / glm::length(r.direction);
        return r;
    }
};

TEST(ReferenceTraversal, EqualsBruteForce) {
    Random random(49);
    for (const double scale : {1e-3, 1.0, 1e3}) {
        for (const double away : {0.0, 10.0, 1e5}) {
            int hits = 0, occluded = 0;
            for (int s = 0; s < 8; ++s) {
                const dvec3 offset = away * scale * dvec3(1, -1, .5);
                const MixedScene mixed(random, scale, offset);
                const Tracer tracer(mixed.scene);
                for (int i = 0; i < 1500; ++i) {
                    const Ray ray = mixed.ray(random, scale, offset);
                    auto hit = tracer.closest(ray);
                    ASSERT_EQ(hit, closestOfAll(tracer, ray))
                        << "scale " << scale << " away " << away << " ray " << i;
                    ASSERT_EQ(tracer.occluded(ray), hit.has_value());
                    hits += hit.has_value();
                    if (!hit) continue;
                    // Onwards from the hit, with it as the source.
                    const Ray next = makeRay(tracer.surfaceAt(ray, *hit).position, random.direction());
                    const auto second = tracer.closest(next, hit->primitive);
                    ASSERT_EQ(second, closestOfAll(tracer, next, hit->primitive));
                    ASSERT_EQ(tracer.occluded(next, hit->primitive), second.has_value());
                    occluded += second.has_value();
                }
            }
            EXPECT_GT(hits, 6000);
            EXPECT_GT(occluded, 2000);
        }
    }
}

// A row of nested, concentric boxes, and one of primitives at powers of two: deep and lopsided.
TEST(ReferenceTraversal, NestedAndExponentialScenes) {
    SceneMaker nested, row;
    for (int i = 1; i <= 200; ++i) nested.cube(vec3(0), static_cast<float>(i));
    for (int i = -60; i <= 60; ++i) {
        const float x = std::ldexp(1.0f, i);
        row.triangle({x, -x, -x}, {x, x, -x}, {x, 0, x});
    }
    Random random(48);
    for (const SceneMaker* maker : {&nested, &row}) {
        const SceneTracer tracer(maker->finish());
        for (int i = 0; i < 500; ++i) {
            const Ray ray =
                makeRay(random.box(i % 2 ? 250 : 1e-3), i % 3 ? random.direction() : dvec3(1, 0, 0));
            ASSERT_EQ(tracer.closest(ray), closestOfAll(tracer, ray));
        }
    }
}

}  // namespace glint::reference::test::traversal_test
