// The textbooks' intersection tests: the same hits where nothing is hard, and their faults where it is.
#include <cmath>

#include "reference/tracer.h"
#include "support.h"

namespace glint::render::test::methods_test {
using glm::dvec3;

constexpr TriangleMethod kTriangleMethods[] = {TriangleMethod::Watertight, TriangleMethod::Barycentric,
                                               TriangleMethod::Projection, TriangleMethod::Planar3d};
constexpr SphereMethod kSphereMethods[] = {SphereMethod::Robust, SphereMethod::Algebraic,
                                           SphereMethod::Geometric};

class MethodsTest : public RenderTest {};

PackedScene someTriangles(Random& random, int count) {
    Scene scene = emptyScene();
    for (int i = 0; i < count; ++i) addTriangle(scene, random.box(3), random.box(3), random.box(3));
    return packScene(scene);
}

std::vector<RayInput> raysFromAround(Random& random, int count) {
    std::vector<RayInput> rays;
    for (int i = 0; i < count; ++i) rays.push_back(rayTowards(9.0 * random.direction(), random.box(2)));
    return rays;
}

// Far from edges all agree, with each other and with the reference: 64 roundings over the cosine.
TEST_F(MethodsTest, SameHitsOnPlainTriangles) {
    Random random(4);
    const PackedScene packed = someTriangles(random, 20);
    RayTracer renderer(device(), packed);
    const std::vector<RayInput> rays = raysFromAround(random, 3000);
    for (const TriangleMethod method : kTriangleMethods) {
        const Methods methods{.triangles = method};
        const auto hits = renderer.trace(rays, false, methods);
        const reference::Tracer tracer(packed, {.methods = methods});
        size_t hit = 0;
        for (size_t i = 0; i < rays.size(); ++i) {
            const auto expected = tracer.closest({dvec3(rays[i].origin), dvec3(rays[i].direction)});
            ASSERT_EQ(hits[i].hit, expected.has_value()) << nameOf(method) << text(rays[i]);
            if (!expected) continue;
            ++hit;
            EXPECT_NEAR(hits[i].t, expected->t, 1e-4) << nameOf(method);
            EXPECT_NEAR(hits[i].data.u, expected->u, 1e-3) << nameOf(method);
            EXPECT_NEAR(hits[i].data.v, expected->v, 1e-3) << nameOf(method);
        }
        EXPECT_GT(hit, 500u);
    }
}

// pbrt's bumpy sphere (Triangle.Watertight): rays from inside a closed mesh at points of its edges.
TEST_F(MethodsTest, OnlyTheWatertightTestIsWatertight) {
    const auto mesh = glint::test::makeBumpyMesh(1);
    Scene scene = emptyScene();
    addMesh(scene, mesh.vertices, mesh.triangles);
    const PackedScene packed = packScene(scene);
    RayTracer renderer(device(), packed);
    Random random(9);
    std::vector<RayInput> rays;
    for (int i = 0; i < 20000; ++i) {
        const glm::uvec3 c = mesh.triangles[random.below(static_cast<uint32_t>(mesh.triangles.size()))];
        const dvec3 a(mesh.vertices[c.x]), b(mesh.vertices[c.y]);
        rays.push_back(rayTowards(random.box(0.3), glm::mix(a, b, random.uniform(0, 1))));
    }
    for (const TriangleMethod method : kTriangleMethods) {
        const size_t leaks = misses(renderer.trace(rays, false, {.triangles = method}));
        if (method == TriangleMethod::Watertight)
            EXPECT_EQ(leaks, 0u);
        else
            EXPECT_GT(leaks, 20u) << nameOf(method);
    }
}

// A unit sphere seen from afar; hit or miss is known from the impact parameter.
TEST_F(MethodsTest, OnlyTheRobustSphereIsRoundFromAfar) {
    constexpr double kDistance = 4100;
    Scene scene = emptyScene();
    addSphere(scene, dvec3(0), 1);
    scene.camera.eye = {0, 0, kDistance};
    const PackedScene packed = packScene(scene);
    RayTracer renderer(device(), packed);
    Random random(12);
    std::vector<RayInput> rays;
    std::vector<bool> inside;
    while (rays.size() < 4000) {
        // From all sides: along an axis the roundings happen to fit.
        const dvec3 away = random.direction();
        const dvec3 aside = glm::normalize(glm::cross(away, random.direction()));
        const RayInput ray =
            rayTowards(kDistance * away, 1.2 * std::sqrt(random.uniform(0, 1)) * aside, true);
        const dvec3 o(ray.origin), d(ray.direction);
        const double impact = glm::length(glm::cross(o, d)) / glm::length(d);
        if (std::abs(impact - 1) < 1e-2) continue;
        rays.push_back(ray);
        inside.push_back(impact < 1);
    }
    for (const SphereMethod method : kSphereMethods) {
        const Methods methods{.spheres = method};
        const auto hits = renderer.trace(rays, false, methods);
        size_t wrong = 0;
        for (size_t i = 0; i < rays.size(); ++i) wrong += hits[i].hit != inside[i];
        // At this distance half a unit of D^2 is the sphere's own square radius.
        if (method == SphereMethod::Robust)
            EXPECT_EQ(wrong, 0u);
        else
            EXPECT_GT(wrong, rays.size() / 20) << nameOf(method);
        const reference::Tracer tracer(packed, {.methods = methods});
        for (size_t i = 0; i < rays.size(); ++i)
            ASSERT_EQ(tracer.closest({dvec3(rays[i].origin), dvec3(rays[i].direction)}).has_value(),
                      inside[i])
                << "double has digits enough";
    }
}

// From outside, the normal of any hit beyond the limb faces the ray. Rays within a few roundings of the limb;
// half a unit of 2^-24 for each product of n.d.
TEST_F(MethodsTest, ASphereSeenFromOutsideShowsItsOutside) {
    constexpr double kDistance = 40, kFewRoundings = 4 * kDistance * kDistance * 0x1p-24;
    Scene scene = emptyScene();
    addSphere(scene, dvec3(0.3, -0.2, 0.1), 1);
    scene.camera.eye = {0, 0, kDistance};
    const PackedScene packed = packScene(scene);
    RayTracer renderer(device(), packed);
    Random random(13);
    std::vector<RayInput> rays;
    for (int i = 0; i < 20000; ++i) {
        const dvec3 away = random.direction();
        const dvec3 aside = glm::normalize(glm::cross(away, random.direction()));
        const dvec3 center(0.3, -0.2, 0.1);
        // The limb's ring lies 1 / D before the centre.
        const dvec3 limb = away / kDistance + std::sqrt(1 - 1 / (kDistance * kDistance)) *
                                                  (1 + random.uniform(-kFewRoundings, kFewRoundings)) * aside;
        rays.push_back(rayTowards(center + kDistance * away - packed.origin, center + limb - packed.origin));
    }
    for (const SphereMethod method : kSphereMethods) {
        const auto hits = renderer.trace(rays, false, {.spheres = method});
        size_t hit = 0, away = 0;
        for (size_t i = 0; i < rays.size(); ++i) {
            if (!hits[i].hit) continue;
            ++hit;
            const dvec3 n(hits[i].data.geometricNormal), d(rays[i].direction);
            away += glm::dot(n, d) > 2 * 0x1p-24 * glm::length(d);
        }
        EXPECT_GT(hit, rays.size() / 4) << nameOf(method);
        EXPECT_EQ(away, 0u) << nameOf(method);
    }
}

// Near a sphere of radius 1e6 only the anchored form resolves the height.
TEST_F(MethodsTest, OnlyTheRobustSphereHoldsUnderTheEye) {
    Scene scene = emptyScene();
    addSphere(scene, {0, -1e6, 0}, 1e6);
    aim(scene.camera, {0, 1, 0}, {1, 0, 0});
    const PackedScene packed = packScene(scene);
    RayTracer renderer(device(), packed);
    const RayInput ray = rayTowards(dvec3(0.3, 1, 0.2) - packed.origin, dvec3(0.5, 0, 0.1) - packed.origin);
    const auto errorOf = [&](SphereMethod method) {
        const Methods methods{.spheres = method};
        const RayHit hit = renderer.trace({ray}, false, methods)[0];
        const auto expected = reference::Tracer(packed, {.methods = methods})
                                  .closest({dvec3(ray.origin), dvec3(ray.direction)});
        return hit.hit && expected ? std::abs(hit.t - expected->t) : 1.0;
    };
    EXPECT_LT(errorOf(SphereMethod::Robust), 1e-6);
    EXPECT_GT(errorOf(SphereMethod::Algebraic), 1e-4);
    EXPECT_GT(errorOf(SphereMethod::Geometric), 1e-4);
}

// Pictures of the device alone, green channel.
size_t litPixels(const gpu::Device& device, const Case& c, OriginOffset offset) {
    Renderer renderer(device, c.packed);
    auto request = sized<Request>(c);
    request.methods.offsets = offset;
    const Picture picture = renderer.render(request);
    size_t lit = 0;
    for (size_t i = 0; i < picture.done.size(); ++i) lit += picture.color.pixels[4 * i + 1] > 0 ? 1 : 0;
    return lit;
}

// Between a floor and a lid 1e-5 above it, light from above: all is dark. A shadow ray that starts 1e-4 above
// the floor has left the lid behind.
TEST_F(MethodsTest, AFixedOffsetLeaksThroughAThinGap) {
    const Case c = textCase(R"({"camera": {"eye": [0, 5e-6, 0], "target": [0, 0, -5e-6], "fovY": 60},
        "lights": [{"type": "directional", "direction": [0, -1, 0]}], "materials": {"m": {"diffuse": 0.5}},
        "objects": [{"type": "plane", "point": [0, 0, 0], "normal": [0, 1, 0], "material": "m"},
                    {"type": "disc", "center": [0, 1e-5, 0], "normal": [0, 1, 0], "radius": 1, "material": "m"}]})",
                            16, 12);
    EXPECT_EQ(litPixels(device(), c, OriginOffset::ErrorBox), 0u);
    EXPECT_GT(litPixels(device(), c, OriginOffset::Fixed), 96u) << "more than half of 192 show the floor";
}

// Two coincident triangles: shadow rays count no hit below the bound on t's error (docs/design/numerics.md).
// The bound alone decides without an offset, where half of the hit points lie below the plane.
TEST_F(MethodsTest, CoincidentTrianglesDoNotShadeEachOther) {
    const Case c = textCase(R"({"camera": {"eye": [0.1, 0.2, 5], "fovY": 40},
        "lights": [{"type": "directional", "direction": [0.2, -0.3, -1]}], "materials": {"m": {"diffuse": 0.5}},
        "objects": [{"type": "triangle", "vertices": [[-7, -5, 0.7], [5, -6, 0.3], [0.3, 9, -0.9]], "material": "m"},
                    {"type": "triangle", "vertices": [[-7, -5, 0.7], [5, -6, 0.3], [0.3, 9, -0.9]], "material": "m"}]})",
                            32, 24);
    EXPECT_EQ(litPixels(device(), c, OriginOffset::ErrorBox), 32u * 24u);
    EXPECT_EQ(litPixels(device(), c, OriginOffset::None), 32u * 24u);
}

// Pads widen boxes, which hold the same primitives.
TEST_F(MethodsTest, PadsDoNotChangeWhatIsHitAwayFromEdges) {
    Random random(5);
    const PackedScene packed = someTriangles(random, 40);
    RayTracer renderer(device(), packed);
    const std::vector<RayInput> rays = raysFromAround(random, 2000);
    const auto expected = renderer.trace(rays, false);
    for (const SlabPad pad : {SlabPad::Gamma3, SlabPad::None}) {
        const auto hits = renderer.trace(rays, false, {.slabs = pad});
        for (size_t i = 0; i < rays.size(); ++i) {
            EXPECT_EQ(hits[i].kindAndIndex, expected[i].kindAndIndex) << text(rays[i]);
            EXPECT_EQ(hits[i].t, expected[i].t);
        }
    }
}

}  // namespace glint::render::test::methods_test
