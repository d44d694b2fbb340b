// Discs on the device: hits known by hand, and the reference's for random rays.
#include <cmath>
#include <numbers>

#include "reference/tracer.h"
#include "support.h"

namespace glint::render::test::disc_test {
namespace {

using glm::dvec3;
using glm::vec3;

constexpr double kUnit = 0x1p-24;

class DiscTest : public RenderTest {
  protected:
    static std::vector<RayHit> hitsOf(const Scene& scene, const std::vector<RayInput>& rays,
                                      bool any = false) {
        const PackedScene packed = packScene(scene);
        Renderer renderer(device(), packed);
        return renderer.trace(rays, any);
    }
};

TEST_F(DiscTest, RimSidesAndEdge) {
    Scene scene = emptyScene();
    addDisc(scene, {0, 0, 0}, {0, 0, 3}, 5);
    const std::vector<RayInput> hit = {rayOf({0, 0, 2}, {0, 0, -1}), rayOf({3, 4, 2}, {0, 0, -1}),
                                       rayOf({-5, 0, 2}, {0, 0, -1}), rayOf({3, -4, -2}, {0, 0, 1})};
    const std::vector<RayInput> missed = {rayOf({3, std::nextafter(4.0f, 5.0f), 2}, {0, 0, -1}),
                                          rayOf({-9, 0, 0}, {1, 0, 0}),  // in its plane
                                          rayOf({1, 1, 0}, {0, 0, 1}),   // t = 0
                                          rayOf({1, 1, 1}, {0, 0, 1})};  // behind
    for (const RayHit& h : hitsOf(scene, hit)) {
        ASSERT_TRUE(h.hit);
        EXPECT_EQ(h.t, 2);
        EXPECT_EQ(h.data.geometricNormal, vec3(0, 0, 1));
        EXPECT_EQ(h.data.u, 0);
    }
    EXPECT_EQ(misses(hitsOf(scene, hit, true)), 0u);
    EXPECT_EQ(misses(hitsOf(scene, missed)), missed.size());
    EXPECT_EQ(misses(hitsOf(scene, missed, true)), missed.size());
}

// Rays at points of a known share of the radius. The point errs by the roundings of t and of the way there,
// about 16 u of the way over the cosine; shares nearer to the rim than that are left out.
TEST_F(DiscTest, RandomDiscsAgreeWithTheReference) {
    Random random(31);
    for (int i = 0; i < 40; ++i) {
        Scene scene = emptyScene();
        scene.camera.eye = {0, 0, 0};  // near enough to see the smallest: coordinates count from 0
        const dvec3 center = random.box(10), n = random.direction();
        const double radius = std::exp(random.uniform(-6, 6));
        addDisc(scene, center, n, radius);
        const dvec3 a = glm::normalize(glm::cross(n, random.direction())), b = glm::cross(n, a);
        std::vector<RayInput> rays;
        std::vector<bool> inside;
        for (int k = 0; k < 50; ++k) {
            const double angle = random.uniform(0, 2 * std::numbers::pi);
            inside.push_back(k % 2 == 0);
            const double share = inside.back() ? random.uniform(0, 0.99) : random.uniform(1.01, 2);
            const dvec3 target = center + share * radius * (std::cos(angle) * a + std::sin(angle) * b);
            rays.push_back(rayTowards(target + (radius + 1.0) * (random.direction() + 1.2 * n), target));
        }
        const PackedScene packed = packScene(scene);
        ASSERT_EQ(packed.origin, dvec3(0));
        Renderer renderer(device(), packed);
        const std::vector<RayHit> hits = renderer.trace(rays, false);
        const reference::Tracer tracer(packed);
        for (size_t k = 0; k < rays.size(); ++k) {
            const reference::Ray ray{dvec3(rays[k].origin), dvec3(rays[k].direction)};
            const auto expected = tracer.closest(ray);
            // The coordinates of a disc of radius 1/400 at 10 are off by up to 1e-3 of the radius, those of
            // the target by less.
            ASSERT_EQ(hits[k].hit, expected.has_value()) << text(rays[k]);
            ASSERT_EQ(hits[k].hit, inside[k]) << text(rays[k]);
            if (!expected) continue;
            const double cosine = std::abs(glm::dot(glm::normalize(ray.direction), n));
            const double reach = glm::length(ray.direction);
            const double bound = 64 * kUnit * (reach + glm::length(center) + radius) / cosine;
            EXPECT_NEAR(hits[k].t * reach, expected->t * reach, bound);
            const dvec3 off = dvec3(hits[k].data.position) - tracer.surfaceAt(ray, *expected).position;
            EXPECT_LE(glm::length(off), 2 * bound);
        }
    }
}

// A disc does not shade itself, wherever it lies and whatever its size, and what lies under it is shaded.
TEST_F(DiscTest, NoAcneAndNoLeak) {
    for (const double offset : {0.0, 1e3}) {
        for (const double size : {1e-3, 1.0, 1e3}) {
            Scene scene = emptyScene();
            const dvec3 at(offset, -offset, offset), n = glm::normalize(dvec3(0.3, 1, 0.2));
            addDisc(scene, at, n, size);
            scene.lights.push_back(DirectionalLight{{-0.6, -1, -0.1}, Color(1)});
            scene.camera.eye = at + 2 * size * dvec3(0.4, 1, 0.6);
            scene.camera.target = at;
            const auto shadowed = [&] {
                const Picture picture = draw(device(), makeCase(scene, 48, 48));
                size_t seen = 0, dark = 0;
                for (const PixelData& data : picture.data) {
                    seen += data.object == 0;
                    dark += data.object == 0 && data.shadowBits != 0;
                }
                EXPECT_GT(seen, 400u);
                return std::make_pair(dark, seen);
            };
            EXPECT_EQ(shadowed().first, 0u) << offset << " " << size;
            // Under a lid, far wider than the shift of its shadow, seen from between the two.
            addDisc(scene, at + 0.6 * size * n, n, 9 * size);
            scene.camera.eye = at + 0.5 * size * n + 0.2 * size * dvec3(1, 0, 0);
            const auto [dark, seen] = shadowed();
            EXPECT_EQ(dark, seen) << offset << " " << size;
        }
    }
}

}  // namespace
}  // namespace glint::render::test::disc_test
