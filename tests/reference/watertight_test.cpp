// Closed meshes: a ray that meets the mesh hits it. Random rays find nothing here, so the rays aim at edges
// and vertices.
#include <gtest/gtest.h>

#include <numbers>

#include "support/packed_scene_maker.h"

namespace glint::reference::test::watertight_test {
namespace {

using namespace glint::test;

using glm::dvec3;
using glm::vec3;

// github.com/Oblikovati issue 2146: leaks along the diagonal of a quad.
TEST(ReferenceWatertight, DiagonalSweep) {
    SceneMaker maker;
    maker.triangle({-5, -5, 0}, {5, -5, 0}, {5, 5, 0});
    maker.triangle({-5, -5, 0}, {5, 5, 0}, {-5, 5, 0});
    const PackedScene scene = maker.finish();
    const Tracer tracer(scene);
    for (int k = 1; k <= 3999; ++k) {
        const double p = k / 1000.0;
        const dvec3 d = glm::normalize(dvec3(p, p, -10));
        EXPECT_TRUE(tracer.closest(makeRay({0, 0, 10}, d))) << k;
        EXPECT_TRUE(tracer.closest(makeRay({0, 0, 10}, dvec3(vec3(d))))) << k << " rounded to fp32";
    }
    EXPECT_TRUE(tracer.closest(makeRay({0, 0, 10}, vec3(0.30458447f, 0.30458447f, -0.9024725f))));
}

// Vulkan CTS, ray tracing watertightness, closed fans of n triangles around the axis.
TEST(ReferenceWatertight, ClosedFans) {
    for (const int n : {4, 16, 64, 256, 1024}) {
        SceneMaker maker;
        std::vector<vec3> rim;
        for (int i = 0; i < n; ++i) {
            const double angle = 2 * std::numbers::pi * i / n;
            rim.emplace_back(std::cos(angle), std::sin(angle), 0.25);
        }
        for (int i = 0; i < n; ++i) maker.triangle(vec3(0, 0, 1), rim[i], rim[(i + 1) % n]);
        const PackedScene scene = maker.finish();
        const Tracer tracer(scene);
        const dvec3 from(0, 0, -1);
        EXPECT_TRUE(tracer.closest(rayTowards(from, {0, 0, 1})));
        for (int i = 0; i < n; ++i) {
            for (const double w : {0.5, 1.0 / 3, 0.9}) {
                const dvec3 at = (1 - w) * dvec3(0, 0, 1) + w * dvec3(rim[i]);
                EXPECT_TRUE(tracer.closest(rayTowards(from, at))) << n << " spoke " << i;
            }
        }
    }
}

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

// A 16 x 16 grid at offset 0, 1e3, 1e6: aimed at its 225 inner vertices and at their edges.
TEST(ReferenceWatertight, GridFarAway) {
    Random random(18);
    for (const float offset : {0.0f, 1e3f, 1e6f}) {
        SceneMaker maker;
        const auto at = [&](int x, int y) {
            return vec3(offset + static_cast<float>(x), offset + static_cast<float>(y), offset);
        };
        for (int y = 0; y < 16; ++y) {
            for (int x = 0; x < 16; ++x) {
                maker.triangle(at(x, y), at(x + 1, y), at(x + 1, y + 1));
                maker.triangle(at(x, y), at(x + 1, y + 1), at(x, y + 1));
            }
        }
        const PackedScene scene = maker.finish();
        const Tracer tracer(scene);
        for (int y = 1; y < 16; ++y) {
            for (int x = 1; x < 16; ++x) {
                const dvec3 from = dvec3(at(8, 8)) +
                                   dvec3(random.uniform(-9, 9), random.uniform(-9, 9), random.uniform(1, 9));
                const double w = random.uniform(-1, 1);
                EXPECT_TRUE(tracer.closest(rayTowards(from, at(x, y))));
                EXPECT_TRUE(tracer.closest(rayTowards(from, dvec3(at(x, y)) + dvec3(w, 0, 0))));
                EXPECT_TRUE(tracer.closest(rayTowards(from, dvec3(at(x, y)) + dvec3(w, w, 0))));
            }
        }
    }
}

}  // namespace
}  // namespace glint::reference::test::watertight_test
