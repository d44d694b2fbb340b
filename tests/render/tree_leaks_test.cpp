// Boxes hold whatever the fp32 triangle test may accept, so no tree lets a ray out of a closed mesh. The test
// errs by a few units of 2^-24 of a corner's distance, a slab by as much of the ray's way to it: of a
// triangle far longer than the way, tight boxes refuse hits, and where the neighbour's fp32 test misses too,
// the ray is out. So: boxes and corridors with long triangles whose edges are also sides of boxes, seen from
// nearby.
#include <cmath>
#include <iostream>

#include "bvh/bvh.h"
#include "support.h"

namespace glint::render::test::tree_leaks_test {

using glm::dvec3;
using glm::vec3;

// A closed axis-aligned box about the origin, its faces cut into 2 x 2 quads of two triangles: edges lie at
// 0, where coordinates give boxes no margin.
struct Hull {
    dvec3 half;
    glint::test::ClosedMesh mesh = glint::test::gridCube(2);

    explicit Hull(const dvec3& halfSize) : half(halfSize) {
        for (dvec3& v : mesh.vertices) v *= half;
    }

    // What fp32 makes of the corners may lie this far off: a ray that starts nearer to a side may be outside.
    double margin() const { return 0x1p-20 * std::max({half.x, half.y, half.z}); }
    // Needles have their t worse, by their length over their height.
    double apart() const {
        return margin() * std::max({half.x, half.y, half.z}) / std::min({half.x, half.y, half.z});
    }
};

// Boxes no wider than their triangles but for an ulp, from node `index` down.
Box tighten(PackedScene& scene, uint32_t index) {
    shared::Node& node = scene.nodes[index];
    const auto boxOf = [&](uint32_t child) {
        Box box;
        if ((child & shared::kLeafFlag) == 0) return tighten(scene, child);
        const uint32_t first = child & shared::kLeafFirstMask;
        const uint32_t count = (child >> shared::kLeafCountShift & shared::kLeafCountMask) + 1;
        for (uint32_t i = first; i < first + count; ++i)
            for (const vec3& v : {scene.triangles[i].v0, scene.triangles[i].v1, scene.triangles[i].v2})
                box.include(v);
        for (int axis = 0; axis < 3; ++axis) {
            box.lo[axis] -= std::max(std::abs(box.lo[axis]) * 0x1p-23f, 0x1p-100f);
            box.hi[axis] += std::max(std::abs(box.hi[axis]) * 0x1p-23f, 0x1p-100f);
        }
        return box;
    };
    const Box a = boxOf(node.child0), b = boxOf(node.child1);
    node.lo0 = a.lo, node.hi0 = a.hi, node.lo1 = b.lo, node.hi1 = b.hi;
    Box both = a;
    both.include(b);
    return both;
}

class TreeLeaksTest : public RenderTest {
  protected:
    // From inside at points of edges, from 1e-4 of the hull's size away on.
    std::vector<RayInput> raysIn(const Hull& hull, int count) {
        std::vector<RayInput> rays;
        while (rays.size() < static_cast<size_t>(count)) {
            const glm::uvec3& t =
                hull.mesh.triangles[random_.below(static_cast<uint32_t>(hull.mesh.triangles.size()))];
            const uint32_t side = random_.below(3);
            const dvec3 a = hull.mesh.vertices[t[static_cast<int>(side)]],
                        b = hull.mesh.vertices[t[static_cast<int>((side + 1) % 3)]];
            // Beside the edge by as much as the test errs: nearer, every box has pad enough.
            const double beside = hull.margin() * std::exp(random_.uniform(std::log(1e-3), 0));
            const dvec3 target = glm::mix(a, b, random_.uniform(0, 1)) + random_.box(beside);
            dvec3 away = random_.box(1) * hull.half;
            // Along short sides too, not only into a corridor's length.
            if (random_.below(2)) away[2] = target[2] + random_.uniform(-1, 1) * hull.half.x;
            const double way = std::exp(random_.uniform(std::log(1e-4), 0));
            const vec3 from(glm::mix(target, away, way));
            const dvec3 room = hull.half - glm::abs(dvec3(from));
            if (std::min({room.x, room.y, room.z}) < hull.apart()) continue;
            rays.push_back(rayTowards(from, target, rays.size() % 2));
        }
        return rays;
    }
    static Scene sceneOf(const Hull& hull) {
        Scene scene = emptyScene();
        addMesh(scene, hull.mesh.vertices, hull.mesh.triangles);
        return scene;
    }
    Random random_{36};
};

const Hull kHulls[] = {Hull(dvec3(1000)), Hull(dvec3(1)), Hull({1, 1, 10}), Hull({1, 0.75, 32}),
                       Hull({1, 0.75, 100})};

const BuildQuality kQualities[] = {BuildQuality::Fast, BuildQuality::Default, BuildQuality::High};

// Not only no leak: each ray hits what it hits when every triangle is tested.
TEST_F(TreeLeaksTest, NoRayLeavesAHull) {
    size_t rayCount = 0;
    for (const Hull& hull : kHulls) {
        const std::vector<RayInput> rays = raysIn(hull, 100000);
        const std::vector<RayHit> truth =
            hitsOf(withOpenBoxes(packScene(sceneOf(hull))), rays, {.traversal = Traversal::Lane});
        EXPECT_EQ(misses(truth), 0u) << hull.half.z;
        for (const BuildQuality quality : kQualities) {
            const PackedScene packed = packScene(sceneOf(hull), {quality});
            for (const Traversal traversal : traversals()) {
                const std::vector<RayHit> hits = hitsOf(packed, rays, {.traversal = traversal});
                size_t wrong = 0;
                for (size_t i = 0; i < rays.size(); ++i)
                    wrong += hits[i].hit != truth[i].hit || hits[i].t != truth[i].t ||
                             hits[i].data.primitive != truth[i].data.primitive;
                EXPECT_EQ(wrong, 0u) << hull.half.z << ", " << misses(hits) << " leaks";
                rayCount += rays.size();
            }
        }
    }
    std::cout << "[ measured ] " << rayCount << " rays, no leak\n";
}

// The defect that this guards against: boxes that are right for exact rays.
TEST_F(TreeLeaksTest, TightBoxesLeak) {
    const Hull& hull = std::end(kHulls)[-1];
    const std::vector<RayInput> rays = raysIn(hull, 100000);
    PackedScene packed = packScene(sceneOf(hull));
    tighten(packed, 0);
    for (const Traversal traversal : traversals())
        EXPECT_GT(misses(hitsOf(packed, rays, {.traversal = traversal})), 10u);
}

// Scenes whose triangles were split for the BVH: the same hits as without, and no leak at the cuts or edges.

// A closed box from `from` to `to`, square of the given thickness: 12 triangles as long as the box.
struct Beam {
    dvec3 ends[2];
    glint::test::ClosedMesh mesh = glint::test::gridCube(1);

    Beam(const dvec3& from, const dvec3& to, double thickness) : ends{from, to} {
        const dvec3 along = glm::normalize(to - from);
        const dvec3 side = thickness * glm::normalize(glm::cross(along, dvec3(0.3, 1, 0.2)));
        const dvec3 up = glm::cross(along, side);
        for (dvec3& v : mesh.vertices) v = dvec3(vec3((v.z < 0 ? from : to) + v.x * side + v.y * up));
    }
};

class SplitTest : public RenderTest {
  protected:
    SplitTest() {
        scene_ = emptyScene();
        for (int i = 0; i < 60; ++i) {
            const dvec3 middle = random_.box(3.0);
            const dvec3 along = 12.0 * random_.direction();
            beams_.emplace_back(middle - along, middle + along, 0.05);
            addMesh(scene_, beams_.back().mesh.vertices, beams_.back().mesh.triangles);
        }
    }
    Random random_{31};
    Scene scene_;
    std::vector<Beam> beams_;
};

// From inside each beam at points of its edges and of its diagonals, near and far.
TEST_F(SplitTest, BeamsAreClosed) {
    const PackedScene packed = packScene(scene_, {BuildQuality::High});
    ASSERT_GT(packed.statistics.splitTriangles, 300u);
    std::vector<RayInput> rays;
    for (const Beam& beam : beams_) {
        for (int i = 0; i < 2000; ++i) {
            const dvec3 from = glm::mix(beam.ends[0], beam.ends[1], random_.uniform(0.02, 0.98));
            const glm::uvec3 t = beam.mesh.triangles[random_.below(12)];
            const dvec3 target =
                glm::mix(beam.mesh.vertices[t.x], beam.mesh.vertices[t.y], random_.uniform(0, 1));
            rays.push_back(rayTowards(from, target, i % 2));
        }
    }
    EXPECT_EQ(missesOf(packed, rays), 0u);
}

// A ray that starts on a triangle must not meet it in another of its places.
TEST_F(SplitTest, SamePictureAsWithout) {
    scene_.camera.eye = {0, 0, 14};
    scene_.maxDepth = 4;
    scene_.materials[0].mirror = Color(0.5);
    scene_.lights = {PointLight{{3, 8, 9}}, PointLight{{-6, 2, 3}}};
    const Case whole = makeCase(scene_, 96, 72, BuildQuality::Fast),
               split = makeCase(scene_, 96, 72, BuildQuality::High);
    ASSERT_GT(split.packed.statistics.splitTriangles, 300u);
    EXPECT_EQ(draw(device(), whole).color.pixels, draw(device(), split).color.pixels);
}

}  // namespace glint::render::test::tree_leaks_test
