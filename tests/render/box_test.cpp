// Boxes on the device and in the reference: hits known by hand, edges and corners, walls of boxes.
#include <cmath>

#include "reference/tracer.h"
#include "support.h"

namespace glint::render::test::box_test {
using glm::dvec3;
using glm::vec3;

void addBox(Scene& scene, const dvec3& low, const dvec3& high) {
    scene.objects.push_back({"/objects/" + std::to_string(scene.objects.size()), BoxShape{low, high}, 0});
}

class BoxTest : public RenderTest {
  protected:
    // Of the device and, as a check on the test, of the reference, which must agree about what is hit.
    static std::vector<RayHit> hitsOf(const Scene& scene, const std::vector<RayInput>& rays) {
        const PackedScene packed = packScene(scene);
        Renderer renderer(device(), packed);
        const std::vector<RayHit> hits = renderer.trace(rays, false);
        const reference::Tracer tracer(packed);
        for (size_t i = 0; i < rays.size(); ++i) {
            const auto hit = tracer.closest({dvec3(rays[i].origin), dvec3(rays[i].direction)});
            EXPECT_EQ(hit.has_value(), hits[i].hit) << text(rays[i]);
        }
        return hits;
    }
};

TEST_F(BoxTest, FacesFromOutsideAndInside) {
    Scene scene = emptyScene();
    addBox(scene, {-1, -2, -3}, {1, 2, 3});
    for (int axis = 0; axis < 3; ++axis) {
        for (const float side : {-1.0f, 1.0f}) {
            vec3 out(0);
            out[axis] = side;
            const auto size = static_cast<float>(axis + 1);
            const std::vector<RayHit> hits = hitsOf(
                scene, {rayOf((size + 2) * out, -out), rayOf(vec3(0.25f), out), rayOf(size * out, -out)});
            EXPECT_EQ(hits[0].t, 2);
            EXPECT_EQ(hits[0].data.geometricNormal, out);
            EXPECT_EQ(hits[1].t, size - side * 0.25f);
            EXPECT_EQ(hits[1].data.position[axis], side * size) << "exactly on the face";
            EXPECT_EQ(hits[2].t, 2 * size) << "t = 0 is no hit: the far face";
        }
    }
}

// Boxes are closed: a ray along a face meets the box, one a float beside it does not.
TEST_F(BoxTest, RaysAlongFacesAndEdges) {
    Scene scene = emptyScene();
    addBox(scene, {-1, -1, -1}, {1, 1, 1});
    const float beside = std::nextafter(1.0f, 2.0f);
    std::vector<RayInput> hit, missed;
    for (const float zero : {0.0f, -0.0f}) {
        for (const float side : {-1.0f, 1.0f}) {
            hit.push_back(rayOf({-5, side, 0.5f}, {1, zero, zero}));  // in a face's plane
            hit.push_back(rayOf({-5, side, side}, {1, zero, zero}));  // along an edge
            hit.push_back(rayOf({5, side, -side}, {-1, zero, zero}));
            missed.push_back(rayOf({-5, side * beside, 0.5f}, {1, zero, zero}));
            missed.push_back(rayOf({-5, side, side * beside}, {1, zero, zero}));
            missed.push_back(rayOf({1, side, 0}, {1, zero, zero}));  // leaves at t = 0
        }
    }
    for (const RayHit& h : hitsOf(scene, hit)) {
        ASSERT_TRUE(h.hit);
        EXPECT_EQ(h.t, 4);
    }
    EXPECT_EQ(misses(hitsOf(scene, missed)), missed.size());
}

// Rays at exact corners, edges and inner points of the joints of a wall: no ray gets through, nor past the
// joints of the boxes behind, whose planes are the same floats.
TEST_F(BoxTest, NoRayGetsThroughAWall) {
    Random random(9);
    std::vector<float> xs{-4}, ys{-4};
    for (int i = 0; i < 8; ++i) {
        xs.push_back(xs.back() + static_cast<float>(random.uniform(0.2, 1)));
        ys.push_back(ys.back() + static_cast<float>(random.uniform(0.2, 1)));
    }
    Scene scene = emptyScene();
    for (size_t i = 0; i + 1 < xs.size(); ++i)
        for (size_t j = 0; j + 1 < ys.size(); ++j)
            addBox(scene, {xs[i], ys[j], 0}, {xs[i + 1], ys[j + 1], 0.125});
    std::vector<RayInput> rays;
    for (size_t i = 1; i + 1 < xs.size(); ++i) {
        for (size_t j = 1; j + 1 < ys.size(); ++j) {
            for (int k = 0; k < 60; ++k) {
                const dvec3 joint(xs[i], ys[j], k % 2 == 0 ? 0.125 : 0.0625);
                const dvec3 along(0, k % 3 == 0 ? random.uniform(0, 0.2) : 0.0, 0);
                const dvec3 origin =
                    joint + dvec3(random.uniform(-9, 9), random.uniform(-9, 9), 1) *
                                (k % 5 == 0 ? dvec3(0, 0, 3) : dvec3(1, 1, random.uniform(1, 9)));
                rays.push_back(rayTowards(origin, joint + along));
            }
        }
    }
    const PackedScene packed = packScene(scene);
    Renderer renderer(device(), packed);
    EXPECT_EQ(misses(renderer.trace(rays, false)), 0u);
    EXPECT_EQ(misses(renderer.trace(rays, true)), 0u);
}

}  // namespace glint::render::test::box_test
