// Boxes on the device and in the reference: hits known by hand, edges and corners, walls of boxes, the
// reference's hits for random rays, packets.
#include <cmath>

#include "reference/tracer.h"
#include "scene/transform.h"
#include "support.h"

namespace glint::render::test::box_test {
namespace {

using glm::dvec3;
using glm::vec3;

constexpr double kUnit = 0x1p-24;

void addBox(Scene& scene, const dvec3& low, const dvec3& high, const std::optional<Affine>& transform = {}) {
    scene.objects.push_back({"/objects/" + std::to_string(scene.objects.size()), BoxShape{low, high}, 0});
    scene.objects.back().transform = transform;
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

TEST_F(BoxTest, WhatIsNotFiniteMisses) {
    Scene scene = emptyScene();
    addBox(scene, {-1, -1, -1}, {1, 1, 1});
    const float nan = std::nanf(""), inf = INFINITY;
    const std::vector<RayInput> rays = {rayOf({nan, 0, 5}, {0, 0, -1}), rayOf({0, 0, 5}, {0, nan, -1}),
                                        rayOf({0, inf, 5}, {0, 0, -1}), rayOf({0, 0, 5}, {0, 0, -inf}),
                                        rayOf({0, 0, 5}, {0, 0, 0})};
    EXPECT_EQ(misses(hitsOf(scene, rays)), rays.size());
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

// Turned, mirrored and sheared boxes. Rays at points of a face whose place is known; those within 1e-4 of an
// edge are left out.
TEST_F(BoxTest, RandomBoxesAgreeWithTheReference) {
    Random random(17);
    for (int i = 0; i < 40; ++i) {
        Scene scene = emptyScene();
        Affine transform{glm::dmat3(random.box(1), random.box(1), random.box(1)), random.box(5)};
        if (std::abs(glm::determinant(transform.linear)) < 0.05) continue;
        const dvec3 half(std::exp(random.uniform(-3, 1)), std::exp(random.uniform(-3, 1)),
                         std::exp(random.uniform(-3, 1)));
        addBox(scene, -half, half, transform);
        std::vector<RayInput> rays;
        std::vector<int> faces;
        for (int k = 0; k < 60; ++k) {
            const int face = k % 6, axis = face / 2;
            dvec3 own = half * random.box(0.9999);
            own[axis] = face % 2 == 1 ? half[axis] : -half[axis];
            const dvec3 target = transform.linear * own + transform.offset;
            dvec3 outwards(0);
            outwards[axis] = face % 2 == 1 ? 1 : -1;
            const dvec3 n = glm::normalize(glm::transpose(glm::inverse(transform.linear)) * outwards);
            rays.push_back(rayTowards(target + 3.0 * (random.direction() + 1.3 * n), target));
            faces.push_back(face);
        }
        const PackedScene packed = packScene(scene);
        Renderer renderer(device(), packed);
        const std::vector<RayHit> hits = renderer.trace(rays, false);
        const reference::Tracer tracer(packed);
        for (size_t k = 0; k < rays.size(); ++k) {
            const reference::Ray ray{dvec3(rays[k].origin), dvec3(rays[k].direction)};
            const auto expected = tracer.closest(ray);
            ASSERT_TRUE(expected) << text(rays[k]);
            ASSERT_TRUE(hits[k].hit) << text(rays[k]);
            ASSERT_EQ(hits[k].kindAndIndex, expected->primitive) << text(rays[k]);
            EXPECT_EQ(expected->primitive >> shared::kPartShift & shared::kPartMask,
                      static_cast<uint32_t>(faces[k]));
            const reference::Surface surface = tracer.surfaceAt(ray, *expected);
            const double cosine = std::abs(glm::dot(glm::normalize(ray.direction), surface.geometricNormal));
            const double reach = glm::length(ray.direction) + glm::length(transform.offset) + 10;
            EXPECT_NEAR(hits[k].t * glm::length(ray.direction), expected->t * glm::length(ray.direction),
                        64 * kUnit * reach / cosine);
            EXPECT_LE(glm::distance(dvec3(hits[k].data.geometricNormal), surface.geometricNormal), 8 * kUnit);
            EXPECT_NEAR(static_cast<double>(hits[k].data.u), surface.uv.x, 1e-3);
            EXPECT_NEAR(static_cast<double>(hits[k].data.v), surface.uv.y, 1e-3);
        }
    }
}

// A box in the light shades itself only where it looks away, wherever it lies and whatever its size.
TEST_F(BoxTest, NoAcne) {
    for (const double offset : {0.0, 1e3}) {
        for (const double size : {1e-3, 1.0, 1e3}) {
            for (const bool turned : {false, true}) {
                Scene scene = emptyScene();
                const dvec3 at(offset, -offset, offset);
                std::optional<Affine> transform;
                if (turned) transform = then(rotation({1, 2, 3}, 50), translation(at));
                addBox(scene, (turned ? dvec3(0) : at) - size, (turned ? dvec3(0) : at) + size, transform);
                // From the eye: whatever is seen is lit.
                scene.camera.eye = at + 4 * size * dvec3(1.1, 1.3, 0.9);
                scene.camera.target = at;
                scene.lights.push_back(PointLight{scene.camera.eye, Color(1)});
                const Picture picture = draw(device(), makeCase(scene, 48, 48));
                size_t seen = 0, dark = 0;
                for (const PixelData& data : picture.data) {
                    seen += data.object == 0;
                    dark += data.object == 0 && data.shadowBits != 0;
                }
                EXPECT_GT(seen, 300u);
                EXPECT_EQ(dark, 0u) << offset << " " << size << " " << turned;
            }
        }
    }
}

TEST_F(BoxTest, PacketsFindTheSameBits) {
    Random random(3);
    Scene scene = emptyScene();
    for (int i = 0; i < 300; ++i) {
        const dvec3 low = random.box(4);
        std::optional<Affine> turned;
        if (i % 2 == 1) turned = rotation(random.direction(), random.uniform(0, 360));
        addBox(scene, low, low + 0.05 + 0.5 * glm::abs(random.box(1)), turned);
    }
    scene.camera.eye = {0, 1, 12};
    scene.camera.target = {0, 0, 0};
    scene.lights.push_back(PointLight{{5, 9, 8}, Color(1)});
    const Case c = makeCase(scene, 96, 72);
    Options options;
    options.traversal = Traversal::Lane;
    const Picture lanes = draw(device(), c, options);
    options.traversal = Traversal::Packet;
    EXPECT_TRUE(chooseTraversal(Traversal::Packet, device().info(), c.packed).packets);
    EXPECT_TRUE(sameBits(draw(device(), c, options), lanes));
}

}  // namespace
}  // namespace glint::render::test::box_test
