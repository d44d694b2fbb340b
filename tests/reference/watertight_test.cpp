// Closed meshes: a ray that meets the mesh hits it. Random rays find nothing here, so the rays aim at edges
// and vertices.
#include <gtest/gtest.h>

#include "support/packed_scene_maker.h"

namespace glint::reference::test::watertight_test {
using namespace glint::test;

using glm::dvec3;
using glm::vec3;

// pbrt-v4, Triangle.Watertight: origins within 0.5 of the centre, all radii are at least 1.
class BumpySphere : public testing::Test {
  protected:
    BumpySphere() : mesh_(makeBumpyMesh(15)) {
        SceneMaker maker;
        for (const glm::uvec3& t : mesh_.triangles) {
            maker.triangle(mesh_.vertices[t.x], mesh_.vertices[t.y], mesh_.vertices[t.z]);
        }
        scene_ = maker.finish();
    }
    int missesOf(const std::function<dvec3()>& target) {
        const Tracer tracer(scene_);
        int misses = 0;
        for (int i = 0; i < 100000; ++i) {
            const dvec3 from = random_.box(.28);  // 0.28 sqrt(3) < 0.5
            Ray ray = rayTowards(from, target());
            if (i % 2) ray.direction = glm::normalize(ray.direction);
            misses += !tracer.closest(ray);
        }
        return misses;
    }
    BumpyMesh mesh_;
    PackedScene scene_;
    Random random_{16};
};

TEST_F(BumpySphere, RandomRaysHit) {
    EXPECT_EQ(missesOf([&] { return 10.0 * random_.direction(); }), 0);
}

TEST_F(BumpySphere, RaysAtVerticesHit) {
    EXPECT_EQ(missesOf([&] {
                  return dvec3(mesh_.vertices[random_.below(static_cast<uint32_t>(mesh_.vertices.size()))]);
              }),
              0);
}

TEST_F(BumpySphere, RaysAtEdgesHit) {
    EXPECT_EQ(missesOf([&] {
                  const glm::uvec3& t =
                      mesh_.triangles[random_.below(static_cast<uint32_t>(mesh_.triangles.size()))];
                  const double w = random_.uniform(0, 1);
                  return (1 - w) * dvec3(mesh_.vertices[t.x]) + w * dvec3(mesh_.vertices[t.y]);
              }),
              0);
}

// Straight through a corner of a cube, t = 9; and through points of its edges from many sides.
TEST(ReferenceWatertight, CubeCornersAndEdges) {
    SceneMaker maker;
    maker.cube(vec3(0), 1);
    const PackedScene scene = maker.finish();
    const Tracer tracer(scene);
    for (int corner = 0; corner < 8; ++corner) {
        const dvec3 c(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, corner & 4 ? 1 : -1);
        const auto hit = tracer.closest(makeRay(10.0 * c, -c));
        ASSERT_TRUE(hit);
        EXPECT_EQ(hit->t, 9);
    }
    Random random(19);
    for (int i = 0; i < 20000; ++i) {
        dvec3 at(random.uniform(-1, 1), random.below(2) ? 1 : -1, random.below(2) ? 1 : -1);
        at = i % 3 == 0 ? at : i % 3 == 1 ? dvec3(at.y, at.z, at.x) : dvec3(at.z, at.x, at.y);
        EXPECT_TRUE(tracer.closest(rayTowards(random.box(.9), at))) << "from inside, ray " << i;
    }
}

}  // namespace glint::reference::test::watertight_test
