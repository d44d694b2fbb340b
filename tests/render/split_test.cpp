// Scenes whose triangles were split for the BVH: the same hits as without, and no leak at the cuts or edges.
#include "support.h"

namespace glint::render::test::split_test {
using glm::dvec3;

// A closed box from `from` to `to`, square of the given thickness: 12 triangles as long as the box.
struct Beam {
    std::vector<dvec3> corners;

    Beam(const dvec3& from, const dvec3& to, double thickness) {
        const dvec3 along = glm::normalize(to - from);
        const dvec3 side = thickness * glm::normalize(glm::cross(along, dvec3(0.3, 1, 0.2)));
        const dvec3 up = glm::cross(along, side);
        for (const dvec3& end : {from, to})
            for (const dvec3& corner : {-side - up, side - up, side + up, -side + up})
                corners.push_back(dvec3(glm::vec3(end + corner)));
    }
    static std::vector<glm::uvec3> triangles() {
        return {{0, 2, 1}, {0, 3, 2}, {4, 5, 6}, {4, 6, 7}, {0, 1, 5}, {0, 5, 4},
                {1, 2, 6}, {1, 6, 5}, {2, 3, 7}, {2, 7, 6}, {3, 0, 4}, {3, 4, 7}};
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
            addMesh(scene_, beams_.back().corners, Beam::triangles());
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
    const std::vector<glm::uvec3> triangles = Beam::triangles();
    for (const Beam& beam : beams_) {
        dvec3 ends[2] = {dvec3(0), dvec3(0)};
        for (int i = 0; i < 8; ++i) ends[i / 4] += beam.corners[i] / 4.0;
        for (int i = 0; i < 2000; ++i) {
            const dvec3 from = glm::mix(ends[0], ends[1], random_.uniform(0.02, 0.98));
            const glm::uvec3 t = triangles[random_.below(12)];
            const dvec3 target = glm::mix(beam.corners[t.x], beam.corners[t.y], random_.uniform(0, 1));
            rays.push_back(rayTowards(from, target, i % 2));
        }
    }
    Renderer renderer(device(), packed);
    EXPECT_EQ(misses(renderer.trace(rays, false)), 0u);
}

// A ray that starts on a triangle must not meet it in another of its places.
TEST_F(SplitTest, SamePictureAsWithout) {
    scene_.camera.eye = {0, 0, 14};
    scene_.maxDepth = 4;
    scene_.materials[0].mirror = Color(0.5);
    scene_.lights = {PointLight{{3, 8, 9}}, PointLight{{-6, 2, 3}}};
    Case whole{scene_, packScene(scene_, {BuildQuality::Fast}), {}, 96, 72};
    Case split{scene_, packScene(scene_, {BuildQuality::High}), {}, 96, 72};
    ASSERT_GT(split.packed.statistics.splitTriangles, 300u);
    for (Case* c : {&whole, &split})
        c->camera = packCamera(scene_.camera, c->width, c->height, c->packed.origin);
    EXPECT_EQ(draw(device(), whole).color.pixels, draw(device(), split).color.pixels);
}

}  // namespace glint::render::test::split_test
