// How verify tells rounding from a defect.
#include "verify/explain.h"
#include "scene/sampling.h"
#include "verify/ceiling.h"

#include <cmath>

#include "support.h"

namespace glint::verify::explain_test {
namespace {

using glm::dvec3;
using render::test::Case;

// A bright square before a dark wall: its right edge is at x = 1.
Case squareCase() {
    Scene scene = render::test::emptyScene();
    scene.ambient = Color(1);
    const uint32_t dark = render::test::addMaterial(scene, Color(0.1));
    render::test::addTriangle(scene, {-1, -1, 0}, {1, -1, 0}, {1, 1, 0});
    render::test::addTriangle(scene, {-1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
    render::test::addPlane(scene, {0, 0, -3}, {0, 0, 1}, dark);
    return render::test::makeCase(scene, 8, 8);
}

reference::Ray rayAt(const Case& c, const dvec3& target) {
    reference::Ray ray;
    ray.origin = dvec3(c.camera.eye);
    ray.direction = glm::normalize(target - ray.origin);
    return ray;
}

// What the device would report had it seen `record`.
DifferingPixel pixelOf(const reference::PixelRecord& device, const reference::PixelRecord& reference) {
    DifferingPixel pixel;
    pixel.deviceColor = glm::vec3(device.color);
    pixel.device.pathHash = device.pathHash;
    if (device.hit) {
        pixel.device.depth = device.hit->t;
        pixel.device.object = device.surface->object;
        pixel.device.primitive = device.surface->primitive;
        pixel.device.position = device.surface->position;
        pixel.device.normal = glm::vec3(device.surface->shadingNormal);
        pixel.device.geometricNormal = glm::vec3(device.surface->geometricNormal);
        pixel.device.u = static_cast<float>(device.hit->u);
        pixel.device.v = static_cast<float>(device.hit->v);
    }
    pixel.reference = reference;
    return pixel;
}

DifferingPixel explainedBy(const reference::Tracer& tracer, const reference::Ray& ray, const Case& c,
                           DifferingPixel pixel) {
    explain(tracer, ray, c.packed, quantitiesOf(pixel.deviceColor, pixel.device), pixel);
    return pixel;
}

class ExplainTest : public testing::Test {
  protected:
    // The reference sees `seen`, the device claims what a ray at `claimed` sees.
    DifferingPixel explained(const dvec3& seen, const dvec3& claimed) const {
        const reference::Tracer tracer(case_.packed);
        const reference::Ray ray = rayAt(case_, seen);
        DifferingPixel pixel = pixelOf(tracer.trace(rayAt(case_, claimed)), tracer.trace(ray, {}, true));
        return explainedBy(tracer, ray, case_, pixel);
    }
    const Case case_ = squareCase();
};

TEST_F(ExplainTest, OtherSideOfAnEdgeIsExplained) {
    // A tenth of an ulp inside and outside the edge, 5 away from the eye.
    const double tiny = 0.1 * 0x1p-24;
    const DifferingPixel pixel = explained({1 - tiny, 0.3, 0}, {1 + tiny, 0.3, 0});
    EXPECT_EQ(pixel.reason, Reason::Edge);
    EXPECT_LE(pixel.ulps, 8);
    const DifferingPixel back = explained({1 + tiny, 0.3, 0}, {1 - tiny, 0.3, 0});
    EXPECT_EQ(back.reason, Reason::Edge);
    EXPECT_LE(back.ulps, 8);
}

TEST_F(ExplainTest, FartherFromAnEdgeTakesMoreJitter) {
    const double unit = 5 * 0x1p-24;  // one unit of direction, seen 5 away
    const DifferingPixel near = explained({1 - 0.1 * unit, 0.3, 0}, {1 + 0.1 * unit, 0.3, 0});
    const DifferingPixel far = explained({1 - 12 * unit, 0.3, 0}, {1 + 0.1 * unit, 0.3, 0});
    EXPECT_EQ(near.reason, Reason::Edge);
    EXPECT_EQ(far.reason, Reason::Edge);
    EXPECT_LT(near.ulps, far.ulps);
}

TEST_F(ExplainTest, MiddleOfASurfaceIsNotExplained) {
    EXPECT_EQ(explained({0.5, 0.3, 0}, {1.5, 0.3, 0}).reason, Reason::Unexplained);
    EXPECT_EQ(explained({1.5, 0.3, 0}, {0.5, 0.3, 0}).reason, Reason::Unexplained);
    // A thousandth of a pixel is far more than rounding.
    EXPECT_EQ(explained({1 - 5e-4, 0.3, 0}, {1.01, 0.3, 0}).reason, Reason::Unexplained);
}

TEST_F(ExplainTest, RightPathWithAWrongColourIsNotExplained) {
    const reference::Tracer tracer(case_.packed);
    const reference::Ray ray = rayAt(case_, {0.5, 0.3, 0});
    DifferingPixel pixel = pixelOf(tracer.trace(ray), tracer.trace(ray, {}, true));
    pixel.deviceColor *= 1.01f;
    pixel = explainedBy(tracer, ray, case_, pixel);
    EXPECT_EQ(pixel.reason, Reason::Unexplained);
    // Nor is a colour between the two sides of an edge that is not near.
    pixel.deviceColor = glm::vec3(0.4f);
    pixel = explainedBy(tracer, ray, case_, pixel);
    EXPECT_EQ(pixel.reason, Reason::Unexplained);
}

TEST_F(ExplainTest, CoincidentSurfacesAreATie) {
    Scene scene = render::test::emptyScene();
    scene.ambient = Color(1);
    const uint32_t dark = render::test::addMaterial(scene, Color(0.1));
    render::test::addTriangle(scene, {-1, -1, 0}, {1, -1, 0}, {0, 1, 0});
    render::test::addTriangle(scene, {-1, -1, 0}, {0.9, -1, 0}, {0, 0.9, 0}, dark);
    const Case both = render::test::makeCase(scene, 8, 8);
    const reference::Tracer tracer(both.packed);
    const reference::Ray ray = rayAt(both, {-0.1, -0.3, 0});
    const reference::PixelRecord first = tracer.trace(ray, {}, true);
    ASSERT_EQ(first.surface->object, 0u);
    // The device took the second triangle, at the same t.
    Scene alone = scene;
    alone.objects.erase(alone.objects.begin());
    const Case other = render::test::makeCase(alone, 8, 8);
    reference::PixelRecord second = reference::Tracer(other.packed).trace(ray);
    second.surface->object = 1;
    second.pathHash = (2166136261u ^ 2u) * 16777619u;  // docs/reference/shading.md: k = id + 1
    DifferingPixel pixel = pixelOf(second, first);
    pixel = explainedBy(tracer, ray, both, pixel);
    EXPECT_EQ(pixel.reason, Reason::Tie);
}

// ---- the bound on the jitter ----

double boundOf(const PackedScene& scene, double t, const dvec3& origin = dvec3(0)) {
    reference::PixelRecord record;
    record.path.resize(1);
    record.path[0].ray.origin = origin;
    record.path[0].hit = reference::Hit{t};
    return roundingBound(scene, record, false);
}

TEST(RoundingBound, GrowsWithTheSceneAndWithNearness) {
    PackedScene scene;
    double last = 0;
    for (const float extent : {1.0f, 2.0f, 10.0f, 1e3f, 1e6f}) {
        scene.boundsHi = glm::vec3(extent);
        EXPECT_GT(boundOf(scene, 1), last);
        last = boundOf(scene, 1);
    }
    scene.boundsHi = glm::vec3(1);
    scene.boundsLo = glm::vec3(0, -1e6f, 0);
    EXPECT_EQ(boundOf(scene, 1), last);  // either side counts
    last = std::numeric_limits<double>::infinity();
    for (const double t : {1e-3, 0.1, 1.0, 50.0, 1e4}) {
        EXPECT_LT(boundOf(scene, t), last);
        EXPECT_GE(boundOf(scene, t), 8);  // what a camera ray alone may be off
        last = boundOf(scene, t);
    }
    EXPECT_GT(boundOf(scene, 1, dvec3(0, 0, 1e8)), boundOf(scene, 1));
}

TEST(RoundingBound, ShortestDistanceOfTheReferencesPathCounts) {
    PackedScene scene;
    scene.boundsHi = glm::vec3(10);
    EXPECT_EQ(roundingBound(scene, {}, false), 8);
    reference::PixelRecord hit;
    hit.path.resize(2);
    hit.path[0].hit = reference::Hit{3};
    const double far = roundingBound(scene, hit, false);
    hit.path[1].hit = reference::Hit{0.25};
    EXPECT_GT(roundingBound(scene, hit, false), far);
}

TEST(RoundingBound, InstancesWidenThePathsThatMeetThem) {
    PackedScene scene;
    scene.boundsHi = glm::vec3(10);
    scene.instanceGain = 100;
    reference::PixelRecord hit;
    hit.path.resize(1);
    hit.path[0].hit = reference::Hit{3};
    EXPECT_GT(roundingBound(scene, hit, true), 50 * roundingBound(scene, hit, false));
}

// ---- limits from counts ----

// Tables of the Poisson distribution, and its own definition.
TEST(Ceiling, LimitsOfCounts) {
    EXPECT_NEAR(greatestMean(0), -std::log(1 - kConfidence), 1e-9);
    for (const uint64_t count : {uint64_t{1}, uint64_t{10}, uint64_t{400}, uint64_t{3000}}) {
        const double mean = greatestMean(count);
        EXPECT_GT(mean, static_cast<double>(count) + 3 * std::sqrt(static_cast<double>(count)));
        EXPECT_LT(mean, static_cast<double>(count) + 3.3 * std::sqrt(static_cast<double>(count)) + 8);
    }
    EXPECT_EQ(greatestCount(0), 0u);
    EXPECT_EQ(greatestCount(1), 5u);    // P(X > 5) = 0.0006, P(X > 4) = 0.0037
    EXPECT_EQ(greatestCount(10), 21u);  // P(X > 21) = 0.0007, P(X > 20) = 0.0016
    EXPECT_NEAR(static_cast<double>(greatestCount(10000)), 10000 + 3.09 * 100, 3);
}

TEST(Sensitivity, WideMovesCountForAsManyUnits) {
    Sensitivity s;
    s.tried = 1000;
    s.changedWidely = 100;
    EXPECT_NEAR(s.changedShare(), greatestMean(100) / kWideUnits / 1000, 1e-12);
    s.changed = 50;  // chaotic: far more than a thirty-second of them
    EXPECT_NEAR(s.changedShare(), greatestMean(50) / 1000, 1e-12);
    s.moves = 3;  // by all three together
    EXPECT_NEAR(s.changedShare(), greatestMean(50) / 3 / 1000, 1e-12);
    EXPECT_EQ(s.tieShare(), 0);
    s.ties = 5;
    EXPECT_NEAR(s.tieShare(), 2 * greatestMean(5) / 1000, 1e-12);
}

// ---- the verdict ----

TEST(Report, PassesUpToWhatTheReferencePredicts) {
    Report report;
    report.pixels = 100000;
    report.sensitivity.tried = 1000;
    report.sensitivity.changedWidely = 10;
    const uint64_t most = report.allowedOthers();
    EXPECT_EQ(most, greatestCount(kShareOfPrediction * greatestMean(10) / kWideUnits / 1000 * 100000));
    report.edges = most - 3;
    report.roundings = 3;
    EXPECT_EQ(report.explained(), most);
    EXPECT_TRUE(report.passed());
    ++report.roundings;
    EXPECT_FALSE(report.passed());
    report.edges = 0;
    report.unexplained = 1;
    EXPECT_FALSE(report.passed());
    report = Report();
    report.pixels = 10;
    report.interrupted = true;
    EXPECT_FALSE(report.passed());
}

TEST(Report, ThePercentileIsJudgedByKappa) {
    Report report;
    report.pixels = 1000;
    report.sensitivity.kappaLimit = 10;
    report.floorP99 = 1e-7;
    EXPECT_NEAR(report.allowedP99(), 16 * 10 * 0x1p-24 + 1e-7, 1e-15);
    report.p99 = 0.99 * report.allowedP99();
    EXPECT_TRUE(report.passed());
    report.p99 = 1.01 * report.allowedP99();
    EXPECT_FALSE(report.passed());
}

TEST(Report, ReasonsHaveNames) {
    EXPECT_EQ(nameOf(Reason::Tie), "tie");
    EXPECT_EQ(nameOf(Reason::Edge), "edge");
    EXPECT_EQ(nameOf(Reason::Rounding), "rounding");
    EXPECT_EQ(nameOf(Reason::Unexplained), "unexplained");
}

class VerifyTest : public render::test::RenderTest {};

TEST_F(VerifyTest, EverySampleIsAPictureOfItsOwn) {
    const Case c = render::test::fileCase("triangles", 40, 30);
    render::Renderer renderer(device(), c.packed);
    Options options;
    options.width = c.width;
    options.height = c.height;
    options.samples = PackedSamples::fixed(sampleOffsets(4));
    double progress = 0;
    options.progress = [&](double fraction) {
        EXPECT_GE(fraction, progress);
        progress = fraction;
    };
    const Report report = verify(renderer, c.packed, c.camera, options);
    EXPECT_EQ(report.pixels, 4u * 40 * 30);
    EXPECT_EQ(progress, 1.0);
    EXPECT_TRUE(report.passed());
    EXPECT_GT(report.rmse, 0);  // float is not double
    EXPECT_LT(report.rmseSamePath, 1e-4);
    EXPECT_LE(report.rmseSamePath, report.maxSamePath);
    EXPECT_LE(report.worst.size(), options.worstCount);
    EXPECT_EQ(report.difference.width, 40);
}

// Balls with many small mirrors in each other: the device differs in many pixels, as the reference predicts,
// and a device that puts one ball elsewhere by a thousandth of its radius still fails.
TEST_F(VerifyTest, SensitiveScenesAreJudgedByTheirPrediction) {
    Scene scene = render::test::emptyScene();
    const uint32_t mirror = render::test::addMaterial(scene, Color(0.1), Color(0.8));
    for (int x = -2; x <= 2; ++x)
        for (int y = -2; y <= 2; ++y)
            for (int z = -1; z <= 1; ++z) render::test::addSphere(scene, {x, y, z}, 0.45, mirror);
    scene.background = Color(0.5);
    scene.lights = {PointLight{{3, 4, 9}, Color(1)}};
    scene.camera.eye = {0.3, 0.2, 8};
    scene.maxDepth = 8;
    const Case c = render::test::makeCase(scene, 96, 72);
    Options options;
    options.width = c.width;
    options.height = c.height;
    render::Renderer right(device(), c.packed);
    const Report good = verify(right, c.packed, c.camera, options);
    EXPECT_TRUE(good.passed()) << good.explained() << ' ' << good.allowedOthers();
    EXPECT_GT(good.explained(), 0u);
    PackedScene moved = c.packed;
    for (shared::Sphere& sphere : moved.spheres)
        if (sphere.id == 62) sphere.point.x += 0.45e-3f;  // of the nearest layer
    render::Renderer wrong(device(), moved);
    const Report bad = verify(wrong, c.packed, c.camera, options);
    EXPECT_FALSE(bad.passed());
    EXPECT_EQ(bad.allowedOthers(), good.allowedOthers());  // a defect cannot raise its own limit
}

// Inside an ellipsoid that mirrors, 100 large, rays begin some 2000 units of 2^-24 from its side, where their
// points are off by a hundred: seen by six mirrors that moves the squares of the floor more than all
// rounding.
TEST_F(VerifyTest, RaysThatBeginClearOfMirrorsArePredicted) {
    const Case c = render::test::textCase(R"({
        "camera": {"eye": [10, 30, 20], "target": [40, -20, -30], "fovY": 60}, "maxDepth": 6, "ambient": 1,
        "materials": {"wall": {"mirror": 0.9}, "floor": {"diffuse": {"checker": [0.2, 0.8], "scale": 6}, "mirror": 0.8}},
        "objects": [{"type": "quadric", "coefficients": [0.0001, 0.0002, 0.00015, 0.00003, -0.00002, 0.00001, 0, 0, 0, -1],
                     "bounds": [[-120, -120, -120], [120, 120, 120]], "material": "wall"},
                    {"type": "plane", "point": [0, -20, 0], "normal": [0, 1, 0], "material": "floor"}]})",
                                          192, 144);
    const Report report = verified(c);
    EXPECT_TRUE(report.passed()) << report.explained() << ' ' << report.allowedOthers();
    EXPECT_GT(report.explained(), 100u);
}

TEST_F(VerifyTest, CancelledIsInterruptedAndNotPassed) {
    const Case c = render::test::fileCase("triangles", 40, 30);
    render::Renderer renderer(device(), c.packed);
    Options options;
    options.width = c.width;
    options.height = c.height;
    options.cancelled = [] { return true; };
    const Report report = verify(renderer, c.packed, c.camera, options);
    EXPECT_TRUE(report.interrupted);
    EXPECT_FALSE(report.passed());
}

}  // namespace
}  // namespace glint::verify::explain_test
