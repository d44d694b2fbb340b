// lavapipe before Mesa 25 ends all loops of a subgroup after 65,535 trips, without an error
// (LP_MAX_TGSI_LOOP_ITERATIONS, lp_bld_limits.h of Mesa 22.3). These rays need more trips. Our kernels must
// be right on any driver; a kernel without a trip budget is wrong exactly where the driver ends loops.
#include <algorithm>
#include <numbers>

#include "gpu/compute.h"
#include "loop_probe.spv.h"
#include "mutant_kernels.h"
#include "reference/tracer.h"
#include "support.h"
#include "verify/verify.h"

namespace glint::render::test::trips_test {
using glm::dvec3;
using glm::vec3;

// Enough primitives in boxes that all coincide for more trips than lavapipe allows: every leaf of four costs
// six and more. Without splits, which would take such heaps apart.
constexpr uint32_t kPages = 48000;

class TripTest : public RenderTest {
  protected:
    // Never gives up, and would not report it.
    static Options naive(const KernelCode& code) {
        Options options = optionsWith(code);
        options.tripBudget = 1u << 30;
        return options;
    }
    // True if the device ends a loop of 100,000 trips early, as Mesa's lavapipe before version 25 does.
    static bool endsLoops() {
        constexpr uint32_t kTrips = 100'000, kLanes = 64;
        const gpu::Buffer buffer(device(), "words", 3 * kLanes * sizeof(uint32_t), gpu::Access::StorageBuffer,
                                 gpu::MemoryKind::Host);
        auto* const words = static_cast<uint32_t*>(buffer.mapped());
        for (uint32_t i = 0; i < kLanes; ++i) words[i] = (i + 1) % kLanes;
        gpu::Kernel kernel(
            device(),
            {.name = "loop_probe", .spirv = loop_probe_spv, .bindings = {gpu::Access::StorageBuffer}});
        const gpu::Buffer* const bound[] = {&buffer};
        kernel.bind(bound);
        gpu::Submission submission(device());
        submission.dispatch(kernel, 1, {});
        submission.submit();
        return *std::min_element(words + kLanes, words + 2 * kLanes) < kTrips;
    }
    const KernelCode naiveKernels_ = mutantKernels("naive");
};

// A light that begins where another's ray has ended that was traced in part, through glass: what that ray has
// lost is not the next one's. The first light, which shines on nothing, leaves no ray unfinished, so that the
// next two share a dispatch.
TEST_F(TripTest, ALightBeginsWithNothingOfTheOneBefore) {
    std::string lights = R"({"type": "spot", "position": [0, 50, 0], "direction": [0, 1, 0], "angle": 1})";
    for (const char* direction : {"[0.3, -1, -0.6]", "[-0.4, -1, -0.3]"})
        lights +=
            std::string(R"(, {"type": "directional", "intensity": 0.5, "direction": )") + direction + "}";
    const std::string text =
        R"({"camera": {"eye": [0, 0.4, 6], "target": [0, 0.1, 0], "fovY": 40}, "ambient": 0.1,
        "materials": {"g": {"transmission": 0.9, "ior": 1.2, "attenuation": [0.3, 0.9, 0.5]}},
        "objects": [{"type": "plane", "point": [0, -1.6, 0], "normal": [0, 1, 0]},
            {"type": "sphere", "center": [-0.9, 0, 0.6], "radius": 0.5, "material": "g"},
            {"type": "sphere", "center": [0.1, 0.4, 0.2], "radius": 0.6, "material": "g"},
            {"type": "sphere", "center": [0.8, -0.2, 0.5], "radius": 0.7, "material": "g"},
            {"type": "sphere", "center": [0.2, 0.6, -1.5], "radius": 0.7, "material": "g"}], "lights": [)" +
        lights + "]}";
    const Case c = textCase(text, 32, 24);
    ASSERT_TRUE(c.packed.features.coloredShadows);
    const Options plenty = {.traversal = Traversal::Lane};
    const Picture picture = draw(device(), c, plenty);
    for (const uint32_t budget : {1u, 2u, 3u, 5u}) {
        Options tight = plenty;
        tight.tripBudget = budget;
        tight.sliceSeconds = 1000;  // however busy the machine is, lights are added to a dispatch
        Renderer renderer(device(), c.packed, tight);
        EXPECT_TRUE(sameBits(draw(renderer, c), picture)) << "budget " << budget;
        EXPECT_GT(renderer.times().resumes, 0u);
    }
}

// ---- rays that need more trips than lavapipe allows ----

// The pages of a book opened all around: all triangles share the edge from (-1, -1, -1) to (1, 1, 1), so all
// have the box between these points, and any ray inside it must be tested against all of them.
struct Book {
    dvec3 e1 = glm::normalize(dvec3(1, -1, 0)), e2 = glm::normalize(dvec3(1, 1, -2));
    // Where page number `page` is `radius` away from the spine; a fraction is between pages.
    dvec3 at(double page, double radius) const {
        const double angle = 2 * std::numbers::pi * page / kPages;
        return radius * (std::cos(angle) * e1 + std::sin(angle) * e2);
    }
    Scene scene() const {
        Scene result = emptyScene();
        std::vector<dvec3> positions = {{-1, -1, -1}, {1, 1, 1}};
        std::vector<glm::uvec3> corners;
        for (uint32_t page = 0; page < kPages; ++page) {
            positions.push_back(at(page, 1));
            corners.emplace_back(0, 1, page + 2);
        }
        addMesh(result, positions, corners);
        return result;
    }
    // From the middle between two pages, near their tips, to page number `page`, which is thus the closest
    // one. It is 6e-5 away: a t of less than 3e-5 could not be told from zero here (PBRT sec. 6.8.7 with
    // corners up to 2 away).
    RayInput rayTo(uint32_t page) const { return rayTowards(at(page - 0.5, 0.9), at(page, 0.9), true); }
};

// Groups of 8, llvmpipe's subgroups, so that each page of a group is missed should its leaf be cut short.
std::vector<uint32_t> somePages() {
    std::vector<uint32_t> pages;
    for (uint32_t first = 0; first < kPages; first += 160) {
        for (uint32_t i = 0; i < 8; ++i) pages.push_back(first + i);
    }
    return pages;
}

TEST_F(TripTest, EveryPageOfALongBookIsFound) {
    const Book book;
    const Case c = makeCase(book.scene(), 8, 8, BuildQuality::Fast);
    ASSERT_EQ(c.packed.triangles.size(), kPages);
    const std::vector<uint32_t> pages = somePages();
    std::vector<RayInput> rays;
    for (const uint32_t page : pages) rays.push_back(book.rayTo(page));
    const auto wrong = [&](const std::vector<RayHit>& hits) {
        size_t count = 0;
        for (size_t i = 0; i < pages.size(); ++i) count += hits[i].data.primitive != pages[i];
        return count;
    };
    RayTracer renderer(device(), c.packed, {.traversal = Traversal::Lane});
    EXPECT_EQ(wrong(renderer.trace(rays, false)), 0u);
    EXPECT_GT(renderer.resumes(), 0u);
    const reference::Tracer tracer(c.packed);
    for (size_t i = 0; i < pages.size(); i += 97) {
        const auto hit = tracer.closest({dvec3(rays[i].origin), dvec3(rays[i].direction)});
        ASSERT_TRUE(hit);
        EXPECT_EQ(hit->id, pages[i]);
    }
    RayTracer ignorant(device(), c.packed, naive(naiveKernels_));
    EXPECT_EQ(wrong(ignorant.trace(rays, false)) > 0, endsLoops());
}

// Identical primitives: the lowest id wins, which is in the leaf that is visited last.
class PileTest : public TripTest, public testing::WithParamInterface<bool> {};

TEST_P(PileTest, LowestIdOfAPileWins) {
    const bool spheres = GetParam();
    Scene scene = emptyScene();
    if (spheres) {
        for (uint32_t i = 0; i < kPages; ++i) addSphere(scene, {0, 0, 0}, 1);
    } else {
        addMesh(scene, {{-1, -1, 0}, {1, -1, 0}, {0, 1, 0}}, std::vector<glm::uvec3>(kPages, {0, 1, 2}));
    }
    Case c = makeCase(scene, 8, 8, BuildQuality::Fast);
    // Ids only break ties, so they may be dealt out backwards.
    for (shared::Triangle& t : c.packed.triangles) t.id = kPages - 1 - t.id;
    for (shared::Sphere& s : c.packed.spheres) s.id = kPages - 1 - s.id;
    const auto lowest = [&](const RayHit& hit) {
        const uint32_t index = hit.kindAndIndex & shared::kPrimitiveIndexMask;
        return hit.hit && (spheres ? c.packed.spheres[index].id : c.packed.triangles[index].id) == 0;
    };
    std::vector<RayInput> rays;
    for (int i = 0; i < 64; ++i)
        rays.push_back(rayTowards({0.1 * (i % 8), 0.1 * (i / 8), 3}, {0.01 * (i % 8), -0.02 * (i / 8), 0}));
    const std::vector<RayHit> hits = hitsOf(c.packed, rays),
                              cut = hitsOf(c.packed, rays, naive(naiveKernels_));
    EXPECT_EQ(std::count_if(hits.begin(), hits.end(), lowest), 64);
    EXPECT_EQ(std::count_if(cut.begin(), cut.end(), lowest) < 64, endsLoops());
}

INSTANTIATE_TEST_SUITE_P(All, PileTest, testing::Bool(),
                         [](const auto& p) { return std::string(p.param ? "spheres" : "triangles"); });

// A roof of triangles over a floor, with the camera between them. All have the roof's box; all but the last
// cover one half of it, so a shadow ray through the other half must pass all boxes to find the triangle that
// shades.
Scene roof() {
    Scene scene = emptyScene();
    const std::vector<dvec3> half = {{-3, -3, 2}, {3, -3, 2.5}, {-3, 3, 3}};
    addMesh(scene, half, std::vector<glm::uvec3>(kPages, {0, 1, 2}));
    addTriangle(scene, {3, 3, 2}, {-3, 3, 2.5}, {3, -3, 3});
    addPlane(scene, {0, 0, 0}, {0, 0, 1});
    scene.lights.push_back(PointLight{{0, 0, 10}, Color(1)});
    aim(scene.camera, {0, 0, 1.8}, {0, 0.2, 0});
    scene.camera.fovY = 80;
    return scene;
}

TEST_F(TripTest, ShadowBehindManyBoxesIsFound) {
    const Case c = makeCase(roof(), 24, 24, BuildQuality::Fast);
    // By lanes: packets take a level's children in fewer trips, and do not run out.
    Renderer renderer(device(), c.packed, {.traversal = Traversal::Lane});
    const Picture picture = draw(renderer, c);
    EXPECT_GT(renderer.times().resumes, 0u);
    // The roof shades the whole floor in view: up to 1.7 from the centre, seen from the light 1.7 * 0.8 < 3.
    const auto lit = [](const Picture& p) {
        return countPixels(p, [](const PixelData& d) { return d.shadowBits != 1; });
    };
    EXPECT_EQ(lit(picture), 0u);
    EXPECT_EQ(lit(draw(device(), c)), 0u);

    const Picture cut = draw(device(), c, naive(naiveKernels_));
    EXPECT_EQ(lit(cut) > 24 * 24 / 4, endsLoops());
}

// As many corners as a polygon may have.
std::vector<dvec3> longRing(double radius, double z) {
    std::vector<dvec3> ring;
    for (uint32_t i = 0; i < 8192; ++i) {
        const double angle = 2 * std::numbers::pi * i / 8192;
        ring.emplace_back(radius * std::cos(angle), radius * std::sin(angle), z);
    }
    return ring;
}

// Rings of growing size behind each other: a ray half a unit from every outline goes by the smaller ones.
TEST_F(TripTest, LongOutlinesHitAndMissed) {
    constexpr uint32_t kRings = 12;
    Scene scene = emptyScene();
    scene.camera.eye = {0, 0, 4};
    for (uint32_t r = 0; r < kRings; ++r) addPolygon(scene, longRing(1 + r, -0.125 * r));
    const PackedScene packed = packScene(scene);
    ASSERT_EQ(packed.polygons.size(), kRings);
    std::vector<RayInput> rays;
    std::vector<uint32_t> nearest;
    Random random(8);
    for (int i = 0; i < 256; ++i) {
        nearest.push_back(random.below(kRings));
        const double angle = random.uniform(0, 7), radius = nearest.back() + 0.5;
        rays.push_back(rayOf({radius * std::cos(angle), radius * std::sin(angle), 3}, {0, 0, -1}));
    }
    const std::vector<RayHit> hits = hitsOf(packed, rays);
    for (size_t i = 0; i < rays.size(); ++i) {
        ASSERT_TRUE(hits[i].hit) << text(rays[i]);
        ASSERT_EQ(hits[i].data.object, nearest[i]) << text(rays[i]);
        ASSERT_EQ(hits[i].t, 3 + 0.125f * static_cast<float>(nearest[i]));
    }
    // A budget of one trip: every leaf in a dispatch of its own, and the same answers.
    RayTracer tight(device(), packed, {.tripBudget = 1});
    const std::vector<RayInput> some(rays.begin(), rays.begin() + 64);
    EXPECT_TRUE(sameBits(tight.trace(some, false), {hits.begin(), hits.begin() + 64}, some));
    EXPECT_GT(tight.resumes(), 0u);
}

// Rays through a corner of the boxes of 40 rings, outside all outlines: 40 x 2048 loop trips to follow them,
// where lavapipe ends all loops after 65,535. The triangle behind them is tested last.
TEST_F(TripTest, MoreEdgesThanLavapipeAllows) {
    constexpr uint32_t kRings = 40;
    Scene scene = emptyScene();
    scene.camera.eye = {0, 0, 4};
    for (uint32_t r = 0; r < kRings; ++r) addPolygon(scene, longRing(20, -0.125 * r));
    addTriangle(scene, {-90, -90, -9}, {90, -90, -9}, {0, 90, -9});
    const PackedScene packed = packScene(scene);
    std::vector<RayInput> rays;
    for (int i = 0; i < 64; ++i)
        rays.push_back(rayOf(vec3(15 + 0.25 * (i % 8), -15 - 0.25 * (i / 8), 3), {0, 0, -1}));
    const auto found = [](const std::vector<RayHit>& hits) {
        return std::count_if(hits.begin(), hits.end(),
                             [](const RayHit& h) { return h.hit && h.data.object == kRings; });
    };
    RayTracer renderer(device(), packed);
    EXPECT_EQ(found(renderer.trace(rays, false)), 64);
    EXPECT_GT(renderer.resumes(), 0u);
    RayTracer ignorant(device(), packed, naive(naiveKernels_));
    EXPECT_EQ(found(ignorant.trace(rays, false)) < 64, endsLoops());
}

TEST_F(TripTest, TwoHundredReflectionsAgreeWithTheReference) {
    const Case c = textCase(R"({
      "camera": {"eye": [0.2, 0.5, 1.2], "target": [-1, 0.55, 1], "fovY": 50},
      "background": 0.3, "ambient": 0.2, "maxDepth": 200,
      "lights": [{"type": "point", "position": [0.3, 1.6, 1]}, {"type": "point", "position": [-0.5, 1.2, -1], "intensity": 0.4},
                 {"type": "directional", "direction": [0.1, -1, -0.3], "intensity": 0.3}],
      "materials": {"m": {"diffuse": 0.01, "mirror": 0.97}, "f": {"diffuse": 0.5}, "s": {"diffuse": [0.8, 0.3, 0.2], "specular": 0.4}},
      "objects": [{"type": "plane", "point": [-1, 0, 0], "normal": [1, 0, 0], "material": "m"},
                  {"type": "plane", "point": [1, 0, 0], "normal": [-1, 0, 0], "material": "m"},
                  {"type": "plane", "point": [0, 0, 0], "normal": [0, 1, 0], "material": "f"},
                  {"type": "sphere", "center": [0, 0.3, 0], "radius": 0.3, "material": "s"}]
    })",
                            80, 60);
    Renderer renderer(device(), c.packed);
    const verify::Report report = verified(renderer, c);
    EXPECT_TRUE(report.passed()) << report.unexplained << " unexplained, " << report.explained()
                                 << " explained";
    uint32_t deepest = 0;
    for (const PixelData& data : draw(renderer, c).data) deepest = std::max(deepest, data.bounces);
    EXPECT_EQ(deepest, 200u);
}

}  // namespace glint::render::test::trips_test
