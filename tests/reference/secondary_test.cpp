// Shadows with closed forms, and rays that start on surfaces: neither acne nor leaks.
#include <gtest/gtest.h>

#include <functional>
#include <numbers>

#include "support/packed_scene_maker.h"

namespace glint::reference::test::secondary_test {
using namespace glint::test;

using glm::dvec3;
using glm::vec3;
using shared::kLightDirectional;
using shared::kLightPoint;

// A sphere of radius R at height H under a point light at height L: the tangent cone has sin a = R / (L - H),
// so the shadow's radius on y = 0 is L tan a.
TEST(ReferenceShadow, SphereOverPlaneCastsADisc) {
    SceneMaker maker;
    maker.plane(vec3(0), {0, 1, 0});
    maker.sphere({0, 2, 0}, 1);
    maker.light(kLightPoint, {0, 7, 0});
    const SceneTracer tracer(maker);
    const double radius = 7 * std::tan(std::asin(1.0 / 5));
    for (int i = 0; i < 360; ++i) {
        const double angle = i * std::numbers::pi / 180;
        for (const double margin : {-0.5, -1e-9, 1e-9, 0.5}) {
            const dvec3 at = (radius + margin) * dvec3(std::cos(angle), 0, std::sin(angle));
            const PixelRecord record = tracer.trace(rayTowards(at + dvec3(0, -1, 0) * -0.2, at));
            ASSERT_TRUE(record.hit);
            EXPECT_EQ(record.shadowBits, margin < 0 ? 1u : 0u) << i << " " << margin;
            EXPECT_EQ(record.color.x > 0, margin > 0);
        }
    }
}

TEST(ReferenceShadow, OneBitForEachLight) {
    SceneMaker maker;
    maker.plane(vec3(0), {0, 1, 0});
    maker.sphere({0, 2, 0}, 1);
    maker.light(kLightDirectional, {0, 1, 0});   // blocked
    maker.light(kLightDirectional, {1, 0, 0});   // does not face the plane
    maker.light(kLightPoint, {0, 0.5f, 0});      // below the sphere
    maker.light(kLightPoint, {0, 9, 0});         // blocked
    maker.light(kLightDirectional, {0, -1, 0});  // behind
    const SceneTracer tracer(maker);
    const PixelRecord record = tracer.trace(makeRay({3, 3, 0}, {-1, -1, 0}), {}, true);
    EXPECT_EQ(record.shadowBits, 0b01001u);
    EXPECT_EQ(record.path[0].occluded, (std::vector<uint8_t>{1, 0, 0, 1, 0}));
}

// A convex body alone never shadows its lit side.
struct Lighting {
    SceneMaker maker;
    Random random{81};
    dvec3 center;
    double size;

    Lighting(double radius, double offset) : center(vec3(offset * dvec3(1, -1, 1))), size(radius) {}

    // Expects eight lights without shadow at the hits of rays towards the points that `target` makes.
    void expectNone(const std::function<dvec3()>& target) {
        for (int i = 0; i < 4; ++i) {
            maker.light(kLightDirectional, vec3(random.direction()));
            maker.light(kLightPoint, vec3(center + 5 * size * random.direction()));
        }
        const SceneTracer tracer(maker);
        int lit = 0, shadowed = 0;
        for (int i = 0; i < 4000; ++i) {
            const dvec3 eye = center + size * (i % 10 == 0 ? 1e5 : 4.0) * random.direction();
            const Ray ray = rayTowards(eye, target());
            const PixelRecord record = tracer.trace(ray);
            // At an outline's edge the tie of the two faces may go to the far one, seen from inside.
            if (record.hit && glm::dot(record.surface->geometricNormal, ray.direction) > 0) continue;
            shadowed += record.shadowBits != 0;
            lit += record.color.x > 0;
        }
        EXPECT_EQ(shadowed, 0) << "size " << size << " at " << center.x;
        EXPECT_GT(lit, 1000) << "size " << size << " at " << center.x;
    }
};

// Aimed at faces and next to edges, where the neighbouring face would catch a ray that starts too low.
TEST(ReferenceAcne, CubesDoNotShadowThemselves) {
    for (const double size : {0x1p-10, 1.0, 1024.0}) {
        for (const double offset : {0.0, 1.0, 1024.0, 0x1p20}) {
            if (size < offset * 0x1p-22) continue;
            Lighting l(size, offset);
            l.maker.cube(vec3(l.center), static_cast<float>(size));
            l.expectNone([&] {
                const int axis = static_cast<int>(l.random.below(3));
                dvec3 at = l.random.box(1);
                at[axis] = l.random.below(2) ? 1 : -1;
                if (l.random.below(2)) at[(axis + 1) % 3] = 1 - std::pow(10.0, l.random.uniform(-16, -3));
                return l.center + size * at;
            });
        }
    }
}

// A ray reflected by a convex mirror never hits the mirror again.
TEST(ReferenceAcne, ConvexMirrorsReflectOnce) {
    for (const double size : {1e-3, 1.0, 1e3}) {
        for (const double offset : {0.0, 1.0, 1e3, 1e6}) {
            Lighting l(size, offset);
            const uint32_t mirror = l.maker.material(vec3(0), vec3(0), 1, vec3(1));
            l.maker.sphere(vec3(l.center), static_cast<float>(l.size), mirror);
            l.maker.environment.background = vec3(1);
            const SceneTracer tracer(l.maker);
            for (int i = 0; i < 2000; ++i) {
                const dvec3 eye = l.center + 4 * l.size * l.random.direction();
                const PixelRecord record =
                    tracer.trace(rayTowards(eye, l.center + l.size * l.random.direction()));
                if (record.alpha > 0) {
                    EXPECT_EQ(record.bounces, 1u);
                }
                EXPECT_EQ(record.color, dvec3(1));
            }
        }
    }
}

// Inside a mirror sphere a ray through the centre comes back along itself for ever: t = 2 r each time.
TEST(ReferenceAcne, MirrorSphereFromInside) {
    SceneMaker maker;
    const uint32_t mirror = maker.material(vec3(0), vec3(0), 1, vec3(1));
    maker.sphere({5, 6, 7}, 2, mirror);
    maker.environment.maxDepth = 8;
    const PixelRecord record = SceneTracer(maker).trace(makeRay({5, 6, 7}, {0, 0, 1}), {}, true);
    ASSERT_EQ(record.bounces, 8u);
    for (size_t i = 1; i < record.path.size(); ++i) EXPECT_NEAR(record.path[i].hit->t, 4, 1e-13);
}

// A sphere resting on a plane, seen at the point of contact: finite, and dark under a light from above.
TEST(ReferenceLeaks, ContactPointIsFinite) {
    SceneMaker maker;
    const uint32_t mirror = maker.material(vec3(.5f), vec3(.5f), 50, vec3(.5f));
    maker.plane(vec3(0), {0, 1, 0}, mirror);
    maker.sphere({0, 1, 0}, 1, mirror);
    maker.light(kLightPoint, {0, 5, 0});
    maker.environment.background = vec3(1);
    maker.environment.maxDepth = 50;
    const SceneTracer tracer(maker);
    for (const double off : {0.0, 1e-12, 1e-8, 1e-4}) {
        const PixelRecord record = tracer.trace(rayTowards({5, 1, 0}, {off, 0, 0}));
        for (int i = 0; i < 3; ++i) EXPECT_TRUE(std::isfinite(record.color[i]));
    }
    // From within the gap, which is x^2 / 2 high, onto the floor.
    for (const double off : {1e-1, 1e-2, 1e-4, 1e-6}) {
        const PixelRecord record = tracer.trace(rayTowards({off, off * off / 8, 0}, {.9 * off, 0, 0}));
        for (int i = 0; i < 3; ++i) EXPECT_TRUE(std::isfinite(record.color[i]));
        ASSERT_TRUE(record.hit);
        EXPECT_EQ(record.surface->object, 0u);
        EXPECT_EQ(record.shadowBits, 1u) << off;
    }
}

}  // namespace glint::reference::test::secondary_test
