// The reference on scenes that packScene makes: leaf order, boxes and anchored spheres as the builder writes
// them.
#include <gtest/gtest.h>

#include "support/packed_scene_maker.h"

namespace glint::reference::test::packed_test {
using namespace glint::test;

using glm::dvec3;

void addObject(Scene& scene, Shape shape) {
    Object object;
    object.shape = std::move(shape);
    scene.objects.push_back(std::move(object));
}

Scene makeScene(Random& random, double scale, const dvec3& offset) {
    Scene scene;
    scene.materials.resize(1);
    scene.camera.eye = offset + dvec3(0, 0, 3 * scale);
    scene.camera.target = offset;
    auto mesh = std::make_shared<Mesh>();
    const BumpyMesh bumpy = makeBumpyMesh(96);
    for (const glm::vec3& v : bumpy.vertices) mesh->positions.push_back(offset + .1 * scale * dvec3(v));
    mesh->corners = bumpy.triangles;
    addObject(scene, MeshShape{mesh});
    for (int i = 0; i < 50; ++i) {
        const dvec3 at = offset + random.box(scale);
        addObject(scene, SphereShape{at, random.uniform(.02, .2) * scale});
        addObject(scene, TriangleShape{{at, at + random.box(scale), at + random.box(scale)}});
        if (i % 10 == 0) scene.objects.push_back(scene.objects.back());
    }
    addObject(scene, SphereShape{offset - dvec3(0, 1e6 * scale, 0), 1e6 * scale});
    addObject(scene, PlaneShape{offset - dvec3(0, 1.5 * scale, 0), {.1, 1, .2}});
    return scene;
}

TEST(ReferencePacked, EqualsBruteForce) {
    Random random(97);
    for (const double scale : {1e-2, 1.0, 1e4}) {
        for (const double away : {0.0, 1e3}) {
            const PackedScene packed = packScene(makeScene(random, scale, away * scale * dvec3(1, 2, 3)));
            const dvec3 center = away * scale * dvec3(1, 2, 3) - packed.origin;
            const Tracer tracer(packed);
            int hits = 0;
            for (int i = 0; i < 4000; ++i) {
                const dvec3 from = center + random.box(2 * scale);
                Ray ray = makeRay(from, random.direction());
                if (i % 3 == 0) ray = rayTowards(from, packed.triangles[random.below(512)].v1);
                if (i % 3 == 1) ray.direction = dvec3(0, i % 2 ? -1 : 1, 0);
                const auto hit = tracer.closest(ray);
                ASSERT_EQ(hit, tracer.closestBruteForce(ray))
                    << "scale " << scale << " away " << away << " ray " << i;
                ASSERT_EQ(tracer.occluded(ray), hit.has_value());
                hits += hit.has_value();
            }
            EXPECT_GT(hits, 2000);
        }
    }
}

// From inside the closed mesh no ray escapes, at every vertex.
TEST(ReferencePacked, MeshStaysWatertight) {
    Scene scene;
    scene.materials.resize(1);
    auto mesh = std::make_shared<Mesh>();
    const BumpyMesh bumpy = makeBumpyMesh(98);
    for (const glm::vec3& v : bumpy.vertices) mesh->positions.push_back(dvec3(v) + dvec3(1e5, 0, 0));
    mesh->corners = bumpy.triangles;
    addObject(scene, MeshShape{mesh});
    const PackedScene packed = packScene(scene);
    const Tracer tracer(packed);
    Random random(99);
    for (int i = 0; i < 50000; ++i) {
        const dvec3 from = dvec3(1e5, 0, 0) - packed.origin + random.box(.28);
        const glm::vec3 target =
            packed.triangles[random.below(static_cast<uint32_t>(packed.triangles.size()))].v2;
        ASSERT_TRUE(tracer.closest(rayTowards(from, target))) << i;
    }
}

// The object and primitive that the file's order gives survive the leaf order.
TEST(ReferencePacked, ObjectsAreNamedByTheirOrder) {
    Random random(100);
    const Scene scene = makeScene(random, 1, dvec3(0));
    const PackedScene packed = packScene(scene);
    const Tracer tracer(packed);
    int spheres = 0;
    for (uint32_t i = 0; i < scene.objects.size(); ++i) {
        const auto* sphere = std::get_if<SphereShape>(&scene.objects[i].shape);
        if (!sphere || sphere->radius > 1) continue;
        // From the centre outwards, so that only this sphere or something inside it is met.
        const Ray ray = makeRay(sphere->center - packed.origin, random.direction());
        const auto hit = tracer.closest(ray);
        ASSERT_TRUE(hit);
        if (hit->primitive >> shared::kPrimitiveKindShift != shared::kKindSphere ||
            hit->t < .99 * sphere->radius)
            continue;
        EXPECT_EQ(tracer.surfaceAt(ray, *hit).object, i);
        ++spheres;
    }
    EXPECT_GT(spheres, 10);
}

}  // namespace glint::reference::test::packed_test
