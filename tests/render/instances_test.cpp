// Instances on the device and in the reference: the cases T77, T79 and T80 of the numerical test list, order,
// flattened copies, trips. The parser's tests hold T76 (singular transforms).
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "reference/tracer.h"
#include "scene/transform.h"
#include "support.h"
#include "support/packed_scene_maker.h"
#include "verify/verify.h"

namespace glint::render::test::instances_test {
using glm::dvec3;

// A closed surface with a bump here and there, of 2 n n triangles; large enough to be worth storing once.
std::shared_ptr<const Mesh> bumpyBall(uint32_t n = 48) {
    auto mesh = glint::test::gridMesh(n);
    for (dvec3& p : mesh->positions) {
        const double a = std::numbers::pi * p.y / n, b = 2 * std::numbers::pi * std::fmod(p.x, n) / n;
        const double r = 1 + 0.15 * std::sin(5 * b) * std::sin(a) * std::sin(3 * a);
        p = glm::vec3(r * dvec3(std::sin(a) * std::cos(b), std::cos(a), std::sin(a) * std::sin(b)));
    }
    return mesh;
}

Affine turned(const dvec3& axis, double degrees, const dvec3& scale, const dvec3& place) {
    return then(then(rotation(axis, degrees), scaling(scale)), translation(place));
}

void addObject(Scene& scene, Shape shape, const Affine& transform, uint32_t material = 0) {
    scene.objects.push_back({"", std::move(shape), material, transform});
}

// As a mesh of its own each: nothing is shared, so everything is baked.
Scene flattened(Scene scene) {
    for (Object& object : scene.objects)
        if (auto* shape = std::get_if<MeshShape>(&object.shape))
            shape->mesh = std::make_shared<const Mesh>(*shape->mesh);
    return scene;
}

double angle(const dvec3& a, const dvec3& b) {
    return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

class InstanceTest : public RenderTest {
  protected:
    // Twelve turned, stretched and mirrored balls, two ellipsoids and an ellipse.
    static Scene crowd() {
        Scene scene = emptyScene();
        const auto ball = bumpyBall();
        Random random(80);
        for (int i = 0; i < 12; ++i) {
            const dvec3 place(2.3 * (i % 4) - 3.5, 2.3 * (i / 4) - 2.3, 0.4 * (i % 3));
            const dvec3 scale(random.uniform(0.6, 1.1), random.uniform(0.6, 1.1) * (i % 3 ? 1 : -1), 0.8);
            addObject(scene, MeshShape{ball},
                      turned(random.direction(), random.uniform(0, 360), scale, place),
                      addMaterial(scene, dvec3(0.2 + 0.05 * i, 0.5, 0.7), dvec3(i % 4 ? 0 : 0.4)));
        }
        addObject(scene, SphereShape{{0.1, 0, 0}, 0.5}, turned({1, 2, 0}, 40, {1, 3, 0.5}, {0, 0, 2}));
        addObject(scene, SphereShape{{0, 0, 0}, 2}, turned({0, 1, 1}, 70, {0.2, 0.6, 1}, {3, 2, 1}));
        addObject(scene, DiscShape{{0, 0, 0}, {1, 1, 0}, 1}, turned({0, 0, 1}, 10, {1, 2, 1}, {-3, 2, 2}));
        scene.lights.push_back(PointLight{{4, 6, 9}, dvec3(0.9)});
        scene.camera.eye = {0.4, 0.7, 11};
        scene.maxDepth = 3;
        return scene;
    }
    static std::vector<RayInput> raysAt(const Scene& scene, int count, uint32_t seed) {
        std::vector<RayInput> rays;
        Random random(seed);
        for (int i = 0; i < count; ++i) {
            const Object& object = scene.objects[random.below(static_cast<uint32_t>(scene.objects.size()))];
            rays.push_back(rayTowards(random.direction() * 12.0, object.transform->offset + random.box(0.9)));
        }
        return rays;
    }
};

TEST_F(InstanceTest, StoredOnce) {
    const PackedScene packed = packScene(crowd());
    // The two ellipsoids are quadrics, of their own.
    EXPECT_EQ(packed.instances.size(), 13u);
    EXPECT_EQ(packed.statistics.prototypes, 2u);
    EXPECT_EQ(packed.spheres.size(), 0u);
    EXPECT_EQ(packed.quadrics.size(), 2u);
    EXPECT_EQ(packed.discs.size(), 1u);
    EXPECT_LE(packed.triangles.size(), 2u * 48 * 48);
    EXPECT_EQ(packed.statistics.instancedTriangles, 12 * packed.triangles.size());
    // Slivers at the poles lose their area in some places of the flattened copies.
    const size_t copied = packScene(flattened(crowd())).triangles.size(), all = 12 * packed.triangles.size();
    EXPECT_LE(copied, all);
    EXPECT_GE(copied, all - 12 * 2 * 48);
}

// T77. Each triangle's normal in the prototype, times the transposed fp32 matrix, in double, is what a normal
// on an instance must be.
TEST_F(InstanceTest, T77normalsUnderUnevenScale) {
    Scene scene = emptyScene();
    const auto ball = bumpyBall();
    const dvec3 scale(1e-4, 1, 1e4);
    for (int i = 0; i < 2; ++i)
        addObject(scene, MeshShape{ball}, turned({1, 2, 3}, 33, scale, {3.0 * i, 0, 0}));
    const PackedScene packed = packScene(scene);
    ASSERT_EQ(packed.instances.size(), 2u);
    std::vector<RayInput> rays;
    Random random(77);
    for (int i = 0; i < 6000; ++i) {
        const dvec3 place(3.0 * (i % 2), 0, 0);
        rays.push_back(
            rayTowards(place + scale * (random.direction() * 3.0), place + scale * random.box(0.4)));
    }
    const std::vector<RayHit> hits = hitsOf(packed, rays);
    ASSERT_LT(misses(hits), 60u);
    std::vector<double> errors;
    const reference::Tracer tracer(packed);
    for (size_t i = 0; i < rays.size(); ++i) {
        if (!hits[i].hit) continue;
        const shared::Instance* instance = nullptr;
        for (const shared::Instance& row : packed.instances)
            if (row.object == hits[i].data.object) instance = &row;
        ASSERT_NE(instance, nullptr);
        const auto& surface = packed.triangleSurfaces[hits[i].kindAndIndex & shared::kPrimitiveIndexMask];
        const dvec3 n(surface.normal);
        const dvec3 expected = n.x * dvec3(instance->toObjectX) + n.y * dvec3(instance->toObjectY) +
                               n.z * dvec3(instance->toObjectZ);
        errors.push_back(angle(dvec3(hits[i].data.geometricNormal), expected));
    }
    std::sort(errors.begin(), errors.end());
    EXPECT_LE(errors[errors.size() * 99 / 100], 1e-6);
    EXPECT_LE(errors.back(), 1e-3);
}

// Blown up 1e20 times, so that squares of what normals become are no normal floats; flattened so much that
// normals of corners, here tilted at random, come to look away from their face.
TEST_F(InstanceTest, ExtremeScalesKeepTheirNormals) {
    const auto tiny = std::make_shared<Mesh>(*bumpyBall()), tilted = std::make_shared<Mesh>(*bumpyBall());
    for (dvec3& p : tiny->positions) p *= 1e-4;
    Random random(81);
    for (const dvec3& p : tilted->positions)
        tilted->normals.push_back(glm::normalize(p) + 0.7 * random.direction());
    tilted->normalCorners = tilted->corners;
    const struct {
        std::shared_ptr<const Mesh> mesh;
        dvec3 scale;
        double size;
    } kinds[] = {{tiny, dvec3(1e20, 2e20, -1e20), 1e16}, {tilted, dvec3(1, 0.1, -1), 1}};
    for (const auto& [mesh, scale, size] : kinds) {
        Scene scene = emptyScene();
        scene.ambient = Color(0.1);
        scene.lights.push_back(DirectionalLight{{-0.5, -1, -0.7}, Color(0.8)});
        for (const double x : {-1.3, 1.3})
            addObject(scene, MeshShape{mesh}, then(scaling(scale), translation({x * size, 0, 0})));
        aim(scene.camera, size * dvec3(0, 2, 6), {0, 0, 0});
        const Case c = makeCase(scene, 64, 48);
        ASSERT_EQ(c.packed.instances.size(), 2u);
        const verify::Report report = verified(c);
        EXPECT_EQ(report.unexplained, 0u) << scale.y;
        EXPECT_TRUE(report.passed()) << scale.y;
    }
}

// T79. Two ellipsoids 2e7 apart, so that no local frame helps: for a near eye, the hit's position and its
// normal are right within 2 ulp(1e7) = 2; in a local frame, where 1e7 - 1e7 is exact, within 1e-5.
TEST_F(InstanceTest, T79translatedFarAway) {
    const Affine shape = scaling({3, 2, 1});
    for (const bool both : {true, false}) {
        Scene scene = emptyScene();
        for (const double side : {1e7, -1e7}) {
            if (!both && side < 0) continue;
            addObject(scene, SphereShape{}, then(shape, translation({side, side, -side})));
            // And a translation there and back, which must leave nothing.
            const Affine back = then(then(shape, translation(dvec3(side))), translation(dvec3(-side)));
            EXPECT_EQ(back.offset, dvec3(0));
        }
        aim(scene.camera, {1e7, 1e7, -1e7 + 20}, {1e7, 1e7, -1e7});
        const PackedScene packed = packScene(scene);
        EXPECT_EQ(packed.origin == dvec3(0), both);
        const dvec3 center = dvec3(1e7, 1e7, -1e7) - packed.origin;
        Random random(79);
        RayTracer renderer(device(), packed);
        const reference::Tracer tracer(packed);
        for (int i = 0; i < 200; ++i) {
            const glm::vec3 from(center + 16.0 * glm::normalize(random.direction() + dvec3(0, 0, 1.5)));
            const RayInput ray = rayTowards(dvec3(from), center);
            const RayHit hit = renderer.trace({ray}, false)[0];
            const auto expected = tracer.closest(exactRay(ray));
            ASSERT_TRUE(hit.hit && expected) << text(ray);
            const dvec3 world = packed.origin + dvec3(ray.origin) + expected->t * dvec3(ray.direction);
            for (int axis = 0; axis < 3; ++axis)
                EXPECT_NEAR(hit.data.position[axis], world[axis], both ? 2 : 1e-5) << text(ray);
            // On the ellipsoid: (x/3)^2 + (y/2)^2 + z^2 = 1, about its exact centre.
            const dvec3 p = (world - dvec3(1e7, 1e7, -1e7)) / dvec3(3, 2, 1);
            EXPECT_NEAR(glm::length(p), 1, both ? 1 : 1e-6) << text(ray);
        }
    }
}

// T80. Rigid motions: t is that of a copy whose vertices were moved in double, within 8 ulp of the ray's
// length to it. Rays at less than 30 degrees to the surface are left out, as the rounding of the vertices
// moves their t by more.
TEST_F(InstanceTest, T80rigidMotion) {
    Scene scene = emptyScene();
    const auto ball = bumpyBall();
    Random random(8);
    for (int i = 0; i < 9; ++i)
        addObject(scene, MeshShape{ball},
                  turned(random.direction(), random.uniform(0, 360), dvec3(1),
                         {2.6 * (i % 3 - 1), 2.6 * (i / 3 - 1), 0}));
    const PackedScene once = packScene(scene), copies = packScene(flattened(scene));
    ASSERT_EQ(once.instances.size(), 9u);
    ASSERT_EQ(copies.instances.size(), 0u);
    const std::vector<RayInput> rays = raysAt(scene, 20000, 81);
    const std::vector<RayHit> a = hitsOf(once, rays), b = hitsOf(copies, rays);
    const reference::Tracer tracerOnce(once), tracerCopies(copies);
    int compared = 0, other = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        const reference::Ray ray = exactRay(rays[i]);
        const auto c = tracerOnce.closest(ray), d = tracerCopies.closest(ray);
        const bool same = a[i].hit == b[i].hit && (!a[i].hit || (a[i].data.object == b[i].data.object &&
                                                                 a[i].data.primitive == b[i].data.primitive));
        other += !same || c.has_value() != d.has_value() || (c && c->id != d->id);
        if (!same || !a[i].hit || !c || !d || c->id != d->id) continue;
        const double cosine =
            std::abs(glm::dot(glm::normalize(ray.direction), dvec3(b[i].data.geometricNormal)));
        if (cosine < 0.5) continue;
        ++compared;
        const double ulp = std::ldexp(1.0, std::ilogb(b[i].t) - 23);
        EXPECT_LE(std::abs(double{a[i].t} - double{b[i].t}), 8 * ulp) << text(rays[i]);
        EXPECT_LE(std::abs(c->t - d->t), 8 * ulp) << text(rays[i]);
    }
    EXPECT_GT(compared, 8000);
    EXPECT_LT(other, 40);  // edges: 2e-3 of the rays
}

TEST_F(InstanceTest, OrderIsIrrelevant) {
    const Scene scene = crowd();
    const size_t count = scene.objects.size();
    Scene reversed = scene;
    std::reverse(reversed.objects.begin(), reversed.objects.end());
    const std::vector<RayInput> rays = raysAt(scene, 6000, 5);
    const std::vector<RayHit> a = hitsOf(packScene(scene), rays), b = hitsOf(packScene(reversed), rays);
    EXPECT_GT(rays.size() - misses(a), 3000u);
    for (size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(a[i].hit, b[i].hit) << text(rays[i]);
        if (!a[i].hit) continue;
        ASSERT_EQ(std::bit_cast<uint32_t>(a[i].t), std::bit_cast<uint32_t>(b[i].t)) << text(rays[i]);
        EXPECT_EQ(a[i].data.object, count - 1 - b[i].data.object) << text(rays[i]);
        EXPECT_EQ(a[i].data.primitive, b[i].data.primitive);
        EXPECT_EQ(a[i].data.position, b[i].data.position);
        EXPECT_EQ(a[i].data.normal, b[i].data.normal);
    }
    const Case one = makeCase(scene, 64, 48), other = makeCase(reversed, 64, 48);
    EXPECT_EQ(draw(device(), one).color.pixels, draw(device(), other).color.pixels);
}

// The corners of triangles are exchanged in a mirrored instance, and with them the texture coordinates: a
// shadow ray through coloured glass would look its colour up at another place than a camera ray.
TEST_F(InstanceTest, ShadowsOfMirroredGlassHaveItsPicture) {
    Scene scene = emptyScene();
    auto sheet = std::make_shared<Mesh>(*bumpyBall());
    for (const dvec3& p : sheet->positions) sheet->uvs.emplace_back(0.5 + 0.4 * p.x, 0.5 + 0.4 * p.z);
    sheet->uvCorners = sheet->corners;
    auto image = std::make_shared<Image>(8, 8, 3, 0.0f);
    for (int i = 0; i < 8 * 8 * 3; ++i)
        image->at(i / 3 % 8, i / 24, i % 3) = 0.1f + 0.012f * static_cast<float>(i * 7 % 70);
    scene.textures.push_back({ImageTexture{"", image}});
    scene.materials.push_back({});
    Material& glass = scene.materials.back();
    glass.ambient = glass.diffuse = Color(0);
    glass.transmission = Color(1);
    glass.transmissionTexture = 0;
    glass.ior = 1;
    const auto material = static_cast<uint32_t>(scene.materials.size() - 1);
    for (const double side : {-1.0, 1.0})
        addObject(scene, MeshShape{sheet}, turned({0, 0, 1}, 10, {side, 1, 1}, {1.4 * side, 0, 0}), material);
    addPlane(scene, {0, -2, 0}, {0, 1, 0});
    PointLight lamp;
    lamp.position = {0.2, 9, 0.3};
    scene.lights.push_back(lamp);
    aim(scene.camera, {0, 5, 9}, {0, -1, 0});
    const Case c = makeCase(scene, 96, 72);
    ASSERT_EQ(c.packed.instances.size(), 2u);
    ASSERT_TRUE(c.packed.features.coloredShadows && c.packed.features.uvs);
    EXPECT_EQ(verified(c).unexplained, 0u);
}

// The device agrees with the search of every primitive of every instance, which reads no box.
TEST_F(InstanceTest, NothingIsMissed) {
    const Scene scene = crowd();
    const PackedScene packed = packScene(scene);
    const reference::Tracer tracer(packed);
    const std::vector<RayInput> rays = raysAt(scene, 400, 9);
    const std::vector<RayHit> hits = hitsOf(packed, rays);
    int differing = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        const reference::Ray ray = exactRay(rays[i]);
        const auto all = closestOfAll(tracer, ray), tree = tracer.closest(ray);
        ASSERT_EQ(all, tree) << text(rays[i]);
        const bool same =
            hits[i].hit == all.has_value() &&
            (!all || (hits[i].kindAndIndex == all->primitive && std::abs(hits[i].t - all->t) < 1e-4));
        differing += !same;
    }
    EXPECT_LE(differing, 2);
}

// 5000 of 400,000 triangles: 2 x 10^9 of them, ids beyond 2^30 and a hit on the last; 11,000 are too many.
TEST_F(InstanceTest, TwoBillionTriangles) {
    Scene grid = emptyScene();
    addGrid(grid, 447);
    const auto mesh = std::get<MeshShape>(grid.objects[0].shape).mesh;
    ASSERT_GE(mesh->corners.size() * 5005, 2000000000u);
    Scene scene = emptyScene();
    for (int i = 0; i < 5005; ++i) addObject(scene, MeshShape{mesh}, translation({0, 0, -0.01 * i}));
    const PackedScene packed = packScene(scene);
    ASSERT_EQ(packed.instances.size(), 5005u);
    // From behind the last one.
    const RayInput ray = rayOf({0.3f, 0.6f, -60}, {0, 0, 1});
    const RayHit hit = hitOf(packed, ray);
    ASSERT_TRUE(hit.hit);
    EXPECT_EQ(hit.data.object, 5004u);
    const auto expected = reference::Tracer(packed).closest(exactRay(ray));
    ASSERT_TRUE(expected);
    EXPECT_EQ(expected->id, 5004u * mesh->corners.size() + hit.data.primitive);
    EXPECT_GT(expected->id, 1u << 30);
    while (scene.objects.size() < 11000) addObject(scene, MeshShape{mesh}, translation({0, 0, 5}));
    EXPECT_THROW(packScene(scene), Error);
}

}  // namespace glint::render::test::instances_test
