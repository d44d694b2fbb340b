// verify must distinguish rounding from defects.
#include "verify/certificate.h"
#include "scene/sampling.h"

#include <cmath>

#include "support.h"

namespace glint::verify::certificate_test {
using glm::dvec3;
using namespace render::test;

// A bright square before a dark wall: its right edge is at x = 1.
Case squareCase() {
    Scene scene = emptyScene();
    scene.ambient = Color(1);
    const uint32_t dark = addMaterial(scene, Color(0.1));
    addTriangle(scene, {-1, -1, 0}, {1, -1, 0}, {1, 1, 0});
    addTriangle(scene, {-1, -1, 0}, {1, 1, 0}, {-1, 1, 0});
    addPlane(scene, {0, 0, -3}, {0, 0, 1}, dark);
    return makeCase(scene, 8, 8);
}

reference::Ray rayAt(const Case& c, const dvec3& target) {
    reference::Ray ray;
    ray.origin = dvec3(filmOf(c).eye);
    ray.direction = glm::normalize(target - ray.origin);
    return ray;
}

// The report of a device that traced `record`.
SeenPath seenAs(const reference::PixelRecord& record, const Trail& trail) {
    SeenPath seen;
    seen.trail = &trail;
    seen.first = quantitiesOf(record, dvec3(0));
    return seen;
}

// The reference traces `ray`, and the device claims `record`, by `trail`.
Certificate certificateOf(const PackedScene& scene, const reference::Ray& ray,
                          const reference::PixelRecord& record, const Trail& trail) {
    return certify(reference::Tracer(scene), scene, ray, seenAs(record, trail), kMostStepsOfPixel);
}

class CertificateTest : public testing::Test {
  protected:
    // The reference's ray goes to `target`; the device reports the hit of the ray to `claimed`.
    Certificate certificate(const dvec3& target, const dvec3& claimed) const {
        const auto device = reference::Tracer(case_.packed).trace(rayAt(case_, claimed), {}, true);
        return certificateOf(case_.packed, rayAt(case_, target), device, trailOf(device));
    }
    const Case case_ = squareCase();
};
using Verdict = Certificate::Verdict;

TEST_F(CertificateTest, TheReferencesOwnPathHoldsInOneStep) {
    const Certificate own = certificate({0.5, 0.3, 0}, {0.5, 0.3, 0});
    EXPECT_EQ(own.verdict, Verdict::Holds);
    EXPECT_EQ(own.openDecisions, 0u);
    EXPECT_EQ(own.steps, 1u);
}

TEST_F(CertificateTest, OtherSideOfAnEdgeHolds) {
    // A tenth of an ulp inside and outside the edge, 5 away from the eye.
    const double tiny = 0.1 * 0x1p-24;
    EXPECT_EQ(certificate({1 - tiny, 0.3, 0}, {1 + tiny, 0.3, 0}).verdict, Verdict::Holds);
    EXPECT_EQ(certificate({1 + tiny, 0.3, 0}, {1 - tiny, 0.3, 0}).verdict, Verdict::Holds);
}

// A certificate starts from the device's own ray, and a camera ray must start as the reference's.
TEST_F(CertificateTest, CameraRaysMayTurnByAFewUnits) {
    const double unit = 5 * 0x1p-24;  // one unit of direction, seen 5 away
    EXPECT_EQ(certificate({1 - 12 * unit, 0.3, 0}, {1 + 0.1 * unit, 0.3, 0}).verdict, Verdict::Holds);
    EXPECT_EQ(certificate({1 - 60 * unit, 0.3, 0}, {1 + 0.1 * unit, 0.3, 0}).verdict, Verdict::Fails);
    EXPECT_EQ(certificate({0.5, 0.3, 0}, {1.5, 0.3, 0}).verdict, Verdict::Fails);
}

// The device's own ray with a hit that only another ray has.
TEST_F(CertificateTest, HitsAreJudgedByTheDevicesOwnRay) {
    const reference::Tracer tracer(case_.packed);
    const double unit = 5 * 0x1p-24;
    const auto claimed = [&](double beside) {
        const reference::PixelRecord wall = tracer.trace(rayAt(case_, {1 + 0.1 * unit, 0.3, 0}), {}, true);
        Trail trail = trailOf(wall);
        const reference::Ray ray = rayAt(case_, {1 - beside * unit, 0.3, 0});
        trail[0].direction = ray.direction;
        return certificateOf(case_.packed, ray, wall, trail);
    };
    const Certificate near = claimed(2);
    EXPECT_EQ(near.verdict, Verdict::Holds);
    EXPECT_EQ(near.openDecisions, 1u);
    EXPECT_GT(near.units, 0);
    EXPECT_LE(near.units, kStepUnits);
    EXPECT_EQ(claimed(1000).verdict, Verdict::Fails);
    EXPECT_EQ(claimed(2).steps, near.steps) << "the same answer each time";
}

TEST_F(CertificateTest, RightPathWithAWrongColourFails) {
    const reference::Tracer tracer(case_.packed);
    const reference::Ray ray = rayAt(case_, {0.5, 0.3, 0});
    const reference::PixelRecord record = tracer.trace(ray, {}, true);
    const Trail trail = trailOf(record);
    SeenPath seen = seenAs(record, trail);
    seen.first[0] *= 1.01;
    EXPECT_EQ(certify(tracer, case_.packed, ray, seen, kMostStepsOfPixel).verdict, Verdict::Fails);
    // Nor is a colour between the two sides of an edge that is not near.
    for (size_t i = 0; i < 3; ++i) seen.first[i] = 0.4;
    EXPECT_EQ(certify(tracer, case_.packed, ray, seen, kMostStepsOfPixel).verdict, Verdict::Fails);
}

// Certificates take throughput and sum of light from the device, so those of the camera ray must be right.
TEST_F(CertificateTest, CameraRaysStartWithTheSamplesWeightAndNoLight) {
    const reference::Tracer tracer(case_.packed);
    const reference::Ray ray = rayAt(case_, {0.5, 0.3, 0});
    const reference::PixelRecord record = tracer.trace(ray, {}, true);
    const auto claimed = [&](double throughput, double sum) {
        Trail trail = trailOf(record);
        trail[0].throughput = dvec3(throughput);
        trail[0].sum = dvec3(sum);
        SeenPath seen = seenAs(record, trail);
        for (size_t i = 0; i < 3; ++i) seen.first[i] = throughput * seen.first[i] + sum;
        return certify(tracer, case_.packed, ray, seen, kMostStepsOfPixel).verdict;
    };
    EXPECT_EQ(claimed(1, 0), Verdict::Holds);
    EXPECT_EQ(claimed(0.5, 0), Verdict::Fails);
    EXPECT_EQ(claimed(1, 0.25), Verdict::Fails);
}

// Glass balls within each other. Each ray is deeper in the recursion: one thread's stack held 2,350.
TEST(ManyRays, PathsOfThousandsOfRaysAreCertified) {
    const Case balls = textCase(R"({"camera": {"eye": [1, 1.5, 5], "target": [0.4, 0, 0]}, "background": 0.5,
        "maxDepth": 16, "materials": {"a": {"transmission": 0.9, "ior": 1.6}, "b": {"transmission": 0.9}},
        "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 0.8, "material": "a"},
                    {"type": "sphere", "center": [0.3, 0, 0], "radius": 0.8, "material": "b"},
                    {"type": "sphere", "center": [0.6, 0, 0], "radius": 0.8, "material": "a"}]})",
                                8, 8);
    const reference::Ray ray = rayAt(balls, {0.4, 0.1, 0});
    const reference::PixelRecord record = reference::Tracer(balls.packed).trace(ray, {}, true);
    const Trail trail = trailOf(record);
    EXPECT_GT(trail.size(), 5000u);
    EXPECT_EQ(certificateOf(balls.packed, ray, record, trail).verdict, Verdict::Holds);
}

// Two triangles in one place: the device must hit the lower id. If the second lies
// behind or in front by about the rule's bound, the device may take either.
TEST_F(CertificateTest, SurfacesAtTheBoundAreAnOpenDecision) {
    const auto takesSecond = [](double z) {
        const auto caseOf = [z](double firstZ) {
            Scene scene = emptyScene();
            scene.ambient = Color(1);
            const uint32_t dark = addMaterial(scene, Color(0.1));
            addTriangle(scene, {-1, -1, firstZ}, {1, -1, firstZ}, {0, 1, firstZ});
            addTriangle(scene, {-1, -1, z}, {0.9, -1, z}, {0, 0.9, z}, dark);
            return makeCase(scene, 8, 8);
        };
        const Case both = caseOf(0), other = caseOf(-1);
        const reference::Ray ray = rayAt(both, {-0.1, -0.3, 0});
        const reference::PixelRecord second = reference::Tracer(other.packed).trace(ray, {}, true);
        return certificateOf(both.packed, ray, second, trailOf(second));
    };
    EXPECT_EQ(takesSecond(0).verdict, Verdict::Fails);
    // The eye is 5 away, so that each height errs by at most 60 units.
    const double unit = 0x1p-24;
    EXPECT_EQ(takesSecond(-20 * unit).verdict, Verdict::Fails) << "behind";
    EXPECT_EQ(takesSecond(400 * unit).openDecisions, 0u) << "in front";
    const Certificate open = takesSecond(100 * unit);
    EXPECT_EQ(open.verdict, Verdict::Holds);
    EXPECT_EQ(open.openDecisions, 1u);
    EXPECT_EQ(open.units, 0) << "of the ray itself";
}

// A mirror that shows a square: rays that were not followed, or too many, or another one, fail.
TEST(Certificate, EachFurtherRayIsJudged) {
    Scene scene = emptyScene();
    scene.ambient = Color(1);
    scene.maxDepth = 3;
    const uint32_t mirror = addMaterial(scene, Color(0.1), Color(0.8));
    addPlane(scene, {0, 0, -3}, {0, 0, 1}, mirror);
    addPlane(scene, {0, 0, 9}, {0, 0, -1}, mirror);
    const Case c = makeCase(scene, 8, 8);
    const reference::Tracer tracer(c.packed, {.limits = {.depth = 3}});
    const reference::Ray ray = rayAt(c, {0.5, 0.3, 0});
    const reference::PixelRecord record = tracer.trace(ray, {}, true);
    ASSERT_EQ(record.path.size(), 4u);
    const auto verdictOf = [&](const Trail& trail, uint64_t steps = kMostStepsOfPixel) {
        return certify(tracer, c.packed, ray, seenAs(record, trail), steps).verdict;
    };
    const Trail right = trailOf(record);
    EXPECT_EQ(verdictOf(right), Verdict::Holds);
    EXPECT_EQ(verdictOf(right, 2), Verdict::Undecided);
    using Break = void (*)(Trail&);
    const Break breaks[] = {
        [](Trail& t) { t.pop_back(); },
        [](Trail& t) { t.push_back(t.back()); },
        [](Trail& t) { t[2].direction = glm::normalize(t[2].direction + dvec3(1e-4, 0, 0)); },
        [](Trail& t) { t[2].origin.x += 1e-3; },
        [](Trail& t) { t[2].throughput *= 1 + 1e-4; },
        [](Trail& t) { t[3].t *= 1 + 1e-5; },
        [](Trail& t) { t[3].id ^= 1; },
        [](Trail& t) { t[3].sum *= 1 + 1e-4; },
    };
    for (size_t i = 0; i < std::size(breaks); ++i) {
        Trail wrong = right;
        breaks[i](wrong);
        EXPECT_EQ(verdictOf(wrong), Verdict::Fails) << i;
    }
    SeenPath packed = seenAs(record, right);
    packed.fromDevice = false;
    EXPECT_EQ(certify(tracer, c.packed, ray, packed, kMostStepsOfPixel).verdict, Verdict::Holds);
    Trail weaker = right;
    weaker[3].throughput *= 1 - 1e-4;
    packed.trail = &weaker;
    EXPECT_EQ(certify(tracer, c.packed, ray, packed, kMostStepsOfPixel).verdict, Verdict::Fails);
}

// ---- the verdict ----

TEST(Report, PassesUpToWhatTheReferencePredicts) {
    Report report;
    report.pixels = 100000;
    report.sensitivity.tried = 1000;
    report.sensitivity.changedWidely = 10;
    const uint64_t most = report.allowedExplained();
    EXPECT_EQ(most, reference::greatestCount(1e5 * report.sensitivity.explainedShare()));
    report.edges = most - 3;
    report.roundings = 3;
    EXPECT_EQ(report.explained(), most);
    EXPECT_TRUE(report.passed());
    ++report.roundings;
    EXPECT_FALSE(report.passed());
    report.roundings -= 2;
    report.undecided = 1;  // counts as one that differs
    EXPECT_TRUE(report.passed());
    ++report.undecided;
    EXPECT_FALSE(report.passed());
    report.edges = report.undecided = 0;
    report.unexplained = 1;
    EXPECT_FALSE(report.passed());
    report = Report();
    report.pixels = 10;
    report.interrupted = true;
    EXPECT_FALSE(report.passed());
}

class VerifyTest : public RenderTest {};

// The image has more pixels than are compared at a time.
TEST_F(VerifyTest, EverySampleIsAPictureOfItsOwn) {
    const Case c = fileCase("triangles", 256, 144);
    render::Renderer renderer(device(), c.packed);
    auto options = sized<Options>(c);
    options.samples = PackedSamples::fixed(sampleOffsets(4));
    double progress = 0;
    options.progress = [&](double fraction) {
        EXPECT_GE(fraction, progress);
        progress = fraction;
    };
    const Report report = verify(renderer, c.packed, options);
    EXPECT_EQ(report.pixels, 4u * 256 * 144);
    EXPECT_EQ(progress, 1.0);
    EXPECT_TRUE(report.passed());
    EXPECT_GT(report.rmse, 0);  // float is not double
    EXPECT_LT(report.rmseSamePath, 1e-4);
    EXPECT_LE(report.rmseSamePath, report.maxSamePath);
    EXPECT_LE(report.worst.size(), options.worstCount);
    EXPECT_EQ(report.difference.width, 256);
    Request first = options;
    first.samples = options.samples.only(0);
    first.progress = {};
    const Picture whole = renderer.render(first);
    for (int y = 0; y < 144; ++y)
        for (int x = 0; x < 256; ++x)
            ASSERT_EQ(report.device.at(x, y, 1), whole.color.at(x, y, 1)) << x << ',' << y;
}

TEST_F(VerifyTest, BytesPerPixelAreThoseHeld) {
    const Case c = fileCase("triangles", 64, 48);
    render::Renderer renderer(device(), c.packed);
    auto options = sized<Options>(c);
    options.limits.depth = 0;  // one ray for each path
    options.data = true;
    std::vector<Trail> trails;
    const Picture picture = renderer.render(options, &trails);
    const uint64_t pixels = 64 * 48, images = 9 * sizeof(float), differences = sizeof(float);
    uint64_t sample = trails.capacity() * sizeof(Trail) + picture.data.size() * sizeof(PixelData) +
                      picture.color.pixels.size() * sizeof(float);
    for (const Trail& trail : trails) sample += trail.capacity() * sizeof(TrailRay);
    // The sample that is compared, and the next one.
    const uint64_t bytes = 2 * sample + pixels * (sizeof(PixelData) + sizeof(DifferingPixel));
    EXPECT_EQ(bytesPerPixel(options, 0) * pixels, bytes + (images + differences) * pixels);
    // verify holds a part of a larger image: 48 rows, or 16 with deep paths.
    options.width = 640;
    options.height = 480;
    const uint64_t part = bytes / pixels;
    EXPECT_EQ(bytesPerPixel(options, 0), 40 + (part * 48 + 479) / 480);
    EXPECT_EQ(bytesPerPixel(options, 64), 40 + (part * 16 + 479) / 480);
    options.samples = PackedSamples::fixed(sampleOffsets(4));
    EXPECT_EQ(bytesPerPixel(options, 0), 52 + (part * 48 + 479) / 480);
}

// Balls with many small mirrors in each other: the device differs in many pixels, as the reference predicts,
// and a device that puts one ball elsewhere by a thousandth of its radius still fails.
TEST_F(VerifyTest, SensitiveScenesAreJudgedByTheirPrediction) {
    Scene scene = emptyScene();
    const uint32_t mirror = addMaterial(scene, Color(0.1), Color(0.8));
    for (int x = -2; x <= 2; ++x)
        for (int y = -2; y <= 2; ++y)
            for (int z = -1; z <= 1; ++z) addSphere(scene, {x, y, z}, 0.45, mirror);
    scene.background = Color(0.5);
    scene.lights = {PointLight{{3, 4, 9}, Color(1)}};
    scene.camera.eye = {0.3, 0.2, 8};
    scene.maxDepth = 8;
    const Case c = makeCase(scene, 96, 72);
    const Report good = verified(c);
    EXPECT_TRUE(good.passed()) << good.explained() << ' ' << good.allowedExplained();
    EXPECT_GT(good.explained(), 0u);
    PackedScene moved = c.packed;
    for (shared::Sphere& sphere : moved.spheres)
        if (sphere.id == 62) sphere.point.x += 0.45e-3f;  // of the nearest layer
    render::Renderer wrong(device(), moved);
    const Report bad = verified(wrong, c);
    EXPECT_FALSE(bad.passed());
    EXPECT_EQ(bad.allowedExplained(), good.allowedExplained());  // a defect cannot raise its own limit
}

// Inside a mirroring ellipsoid of size 100, rays begin some 2000 units of 2^-24 from its side, where their
// points err by a hundred units. After six mirrors that moves the squares of the floor by more than all
// rounding.
TEST_F(VerifyTest, RaysThatBeginClearOfMirrorsArePredicted) {
    const Case c = textCase(R"({
        "camera": {"eye": [10, 30, 20], "target": [40, -20, -30], "fovY": 60}, "maxDepth": 6, "ambient": 1,
        "materials": {"wall": {"mirror": 0.9}, "floor": {"diffuse": {"checker": [0.2, 0.8], "scale": 6}, "mirror": 0.8}},
        "objects": [{"type": "quadric", "coefficients": [0.0001, 0.0002, 0.00015, 0.00003, -0.00002, 0.00001, 0, 0, 0, -1],
                     "bounds": [[-120, -120, -120], [120, 120, 120]], "material": "wall"},
                    {"type": "plane", "point": [0, -20, 0], "normal": [0, 1, 0], "material": "floor"}]})",
                            192, 144);
    const Report report = verified(c);
    EXPECT_TRUE(report.passed()) << report.explained() << ' ' << report.allowedExplained();
    EXPECT_GT(report.explained(), 100u);
}

// In the middle column a light's cosine is kLeastCosine within rounding. Rounding decides for each pixel
// whether a shadow ray is traced, which changes the layer of hidden lights and hardly the colour.
TEST_F(VerifyTest, LightsThatRoundingHidesArePredicted) {
    const Case c = fileCase("../tests/mutation/scenes/terminators", 53, 81);
    const Report report = verified(c);
    EXPECT_TRUE(report.passed()) << report.explained() << ' ' << report.allowedExplained();
    EXPECT_GT(report.explained(), 20u);
}

// The limb of a cylinder, in pixels of about half a unit: the device accepts tangents within a bound, so that
// most of them are too many for the moves of rays alone.
TEST_F(VerifyTest, LimbsOutsideWithinRoundingArePredicted) {
    Scene scene = emptyScene();
    addObject(scene, CylinderShape{{0, -1, 0}, {0, 1, 0}, 1, true});
    scene.background = {0.2, 0.3, 0.5};
    aim(scene.camera, {0, 0, 5}, {std::sqrt(0.96), 0, 0.2}, {0.1, 1, 0.05});
    scene.camera.fovY = 1e-4;
    const Report report = verified(makeCase(scene, 48, 48));
    EXPECT_TRUE(report.passed()) << report.explained() << ' ' << report.allowedExplained();
    EXPECT_GT(report.explained(), 100u);
}

// The open rim of a sphere cut at 0.9999 of its radius, from inside and in pixels of about half a unit. The
// side meets the plane at 0.8 degrees, so that rounding of both t moves the rim farther than moved rays do.
TEST_F(VerifyTest, OpenRimsMovedByRoundingArePredicted) {
    Scene scene = sceneOf(generalQuadric({1, 1, 1, 0, 0, 0, 0, 0, 0, -1}, 0.9999));
    scene.background = {0.2, 0.3, 0.5};
    const double radius = std::sqrt(1 - 0.9999 * 0.9999);
    aim(scene.camera, {0.1, -0.9, 0.2}, {0.8 * radius, 0.9999, 0.6 * radius}, {1, 0.1, 0});
    scene.camera.fovY = 1e-3;
    const Report report = verified(makeCase(scene, 48, 48));
    EXPECT_TRUE(report.passed()) << report.explained() << ' ' << report.allowedExplained();
    EXPECT_GT(report.explained(), 400u);
}

// A bowl 2500 times as wide as thick: rounding of o + t d takes points off it by more than the root of the
// equation's error, and its texture changes across the thickness.
TEST_F(VerifyTest, PointsLieOnFlatQuadrics) {
    const Report report = verified(textCase(R"({
        "camera": {"eye": [3, 2.5, 4], "target": [0, 0.5, 0], "fovY": 22}, "ambient": 1,
        "materials": {"m": {"diffuse": {"checker": [0.2, 0.8], "scale": 4}}},
        "objects": [{"type": "paraboloid", "vertex": [0, 0, 0], "top": [1, 1, 0.1], "radius": 0.7, "material": "m",
                     "transform": [{"scale": [0.0004, 1, 1]}]}]})",
                                            96, 72));
    EXPECT_TRUE(report.passed()) << report.explained() << ' ' << report.allowedExplained();
}

// Fp32 takes each of these with errors that moves of the ray alone do not reach.
TEST_F(VerifyTest, RoundingOfHeightsAndRefractionIsPredicted) {
    const char* const scenes[] = {
        // Its faces are nearly parallel: heights over them are off by a hundredth of its thickness.
        R"("lights": [{"type": "point", "position": [3, 4, 5]}], "objects": [{"type": "box", "min": [-1, -1, -1], "max": [1, 1, 1],
            "transform": [{"rotate": [1, 1, 0, 40]}, {"scale": [1, 0.0001, 1]}, {"rotate": [1, 0, 1, 70]}]}])",
        // Nearly a plane through the point that it is measured from: there the terms of its equation vanish.
        R"("objects": [{"type": "quadric", "coefficients": [0, 1e-6, 0, 0, 0, 0, 0, 1, 0, 0],
            "bounds": [[-1, -1, -1], [1, 1, 1]], "transform": [{"rotate": [1, 2, 0.5, 25]}]}])",
        // The cosine's error exceeds that of the critical angle.
        R"("maxDepth": 8, "materials": {"m": {"transmission": 1, "ior": 10000}, "f": {"diffuse": {"checker": [0.2, 0.8]}}},
            "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "m"},
                        {"type": "box", "min": [1, -1, -1], "max": [2, 0.6, 0], "material": "m", "transform": [{"rotate": [0, 1, 0, 20]}]},
                        {"type": "plane", "point": [0, -1.2, 0], "normal": [0, 1, 0], "material": "f"}])"};
    for (const std::string text : scenes) {
        const Report report = verified(textCase(
            R"({"camera": {"eye": [1, 1.5, 5], "fovY": 40}, "background": [0.2, 0.3, 0.5], "ambient": 0.5, )" +
                text + "}",
            60, 45));
        EXPECT_TRUE(report.passed()) << text << report.explained() << ' ' << report.allowedExplained();
    }
}

}  // namespace glint::verify::certificate_test
