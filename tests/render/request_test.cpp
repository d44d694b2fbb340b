// One packed scene, many requests: what varies from picture to picture is no part of the scene.
#include "trace/request.h"

#include <functional>
#include <stdexcept>

#include "pack/request_environment.h"
#include "reference/render.h"
#include "support.h"

namespace glint::render::test::request_test {
class RequestTest : public RenderTest {};

struct Wish {
    const char* name;
    std::function<void(Request&)> ask;
};

const Wish kWishes[] = {
    {"plain", [](Request&) {}},
    {"barycentric", [](Request& r) { r.methods.triangles = TriangleMethod::Barycentric; }},
    {"geometric", [](Request& r) { r.methods.spheres = SphereMethod::Geometric; }},
    {"slabs", [](Request& r) { r.methods.slabs = SlabPad::None; }},
    {"offsets", [](Request& r) { r.methods.offsets = OriginOffset::Fixed; }},
    {"depth 1", [](Request& r) { r.limits.depth = 1; }},
    {"depth 0", [](Request& r) { r.limits.depth = 0; }},
    {"cut", [](Request& r) { r.limits.minContribution = 0.5; }},
    {"no shadows", [](Request& r) { r.shadows = false; }},
    {"cost", [](Request& r) { r.cost = true; }},
    {"tally", [](Request& r) { r.tally = true; }},
    {"four samples",
     [](Request& r) {
         r.samples = PackedSamples::fixed({{.2, .2}, {.7, .3}, {.4, .8}, {.9, .6}});
     }},
};

// Kernels for later bounces are made only for later bounces, even if the pipeline has code for more.
TEST_F(RequestTest, KernelsOfLaterBouncesAreLeftOut) {
    const Case mirrors = fileCase("shift", 16, 16);
    const auto codeBytes = [&](const Case& c, uint32_t maxDepth, bool withMirrors) {
        Options options;
        options.also.mirrors = withMirrors;
        Renderer renderer(device(), c.packed, options);
        Request request = wholeWithData(c);
        request.limits.depth = maxDepth;
        renderer.render(request);
        return renderer.codeBytes();
    };
    // Camera rays go by packets, others do not. Without packets one kernel serves both.
    const double share = runsPackets(device().info()) ? 0.8 : 1.0001;
    EXPECT_LT(codeBytes(mirrors, 0, false), share * static_cast<double>(codeBytes(mirrors, 1, false)));
    // Code for mirrors in a scene without any: in the kernels that there are, not kernels more.
    const Case matte = fileCase("knot", 16, 16);
    EXPECT_LT(codeBytes(matte, 8, true), 1.2 * static_cast<double>(codeBytes(matte, 8, false)));
}

// A renderer that has drawn other images before draws the same as a new one, by every traversal.
TEST_F(RequestTest, OneRendererDrawsWhatOneForEachRequestDraws) {
    for (const char* name : {"corridor", "glass"}) {
        const Case c = fileCase(name, 40, 30);
        for (const Traversal traversal : {Traversal::Auto, Traversal::Lane}) {
            Options options = {.traversal = traversal};
            Renderer renderer(device(), c.packed, options);
            std::vector<Picture> first;
            for (const Wish& wish : kWishes) {
                Request request = wholeWithData(c);
                wish.ask(request);
                first.push_back(renderer.render(request));
                options.expected = &request;
                Renderer fresh(device(), c.packed, options);
                EXPECT_TRUE(sameBits(first.back(), fresh.render(request))) << name << ", " << wish.name;
            }
            for (size_t i = 0; i < first.size(); ++i) {
                Request request = wholeWithData(c);
                kWishes[i].ask(request);
                EXPECT_TRUE(sameBits(renderer.render(request), first[i]))
                    << name << ", again " << kWishes[i].name;
            }
        }
    }
}

// Lights and background of a request: as if the scene had been packed with them.
TEST_F(RequestTest, LightingIsAsIfTheSceneHadIt) {
    const Case all = fileCase("lights", 40, 30);
    ASSERT_GT(all.packed.lights.size(), 1u);
    Scene other = all.scene;
    other.lights.erase(other.lights.begin());
    other.background = Color(0.5, 0.25, 0.125);
    const Case less = makeCase(other, 40, 30);
    Request request = wholeWithData(all);
    Lighting& lighting = request.lighting.emplace();
    lighting.lights = {all.packed.lights.begin() + 1, all.packed.lights.end()};
    lighting.background = glm::vec3(0.5f, 0.25f, 0.125f);
    Renderer renderer(device(), all.packed);
    const Picture before = draw(renderer, all);
    EXPECT_TRUE(sameBits(renderer.render(request), draw(device(), less)));
    EXPECT_EQ(reference::render(all.packed, request).exact,
              reference::render(less.packed, wholeWithData(less)).exact);
    lighting.lights.clear();
    EXPECT_NE(renderer.render(request).color.pixels, before.color.pixels);
    EXPECT_TRUE(sameBits(draw(renderer, all), before)) << "the scene's own are back";
    lighting.lights.assign(all.packed.lights.size() + 1, all.packed.lights[0]);
    EXPECT_THROW(renderer.render(request), std::invalid_argument);
}

Tracing toDepth(uint32_t depth) {
    Tracing tracing;
    tracing.limits.depth = depth;
    return tracing;
}

// The scene's bound does not hold with brighter lights, or more bounces than it was made for.
TEST_F(RequestTest, RadianceBoundGoesWithTheRequest) {
    Scene scene = fileCase("corridor", 8, 8).scene;
    scene.maxDepth = 1;
    const PackedScene packed = packScene(scene);
    EXPECT_EQ(radianceBoundOf(packed, {}), packed.environment.radianceBound);
    EXPECT_EQ(radianceBoundOf(packed, toDepth(0)), packed.environment.radianceBound);
    scene.maxDepth = 6;
    EXPECT_EQ(radianceBoundOf(packed, toDepth(6)), packScene(scene).environment.radianceBound);
    Tracing tracing;
    tracing.lighting = Lighting{packed.lights, packed.environment.background};
    EXPECT_EQ(radianceBoundOf(packed, tracing), packed.environment.radianceBound);
    for (shared::Light& light : tracing.lighting->lights) light.intensity *= 8.0f;
    EXPECT_GT(radianceBoundOf(packed, tracing), packed.environment.radianceBound);
}

// The pipeline's features decide, not the scene's: Options::also gives code for what the scene lacks.
TEST_F(RequestTest, FurtherFeaturesServeFurtherRequests) {
    Scene scene = fileCase("spheres", 40, 30).scene;
    scene.maxDepth = 0;
    const Case flat = makeCase(scene, 40, 30);
    ASSERT_FALSE(flat.packed.features.mirrors || flat.packed.features.parallelCamera);
    scene.camera.projection = Projection::Orthographic;
    Request request = wholeWithData(flat);
    request.camera = scene.camera;
    Renderer bare(device(), flat.packed);
    EXPECT_THROW(bare.render(request), std::invalid_argument);
    Options options;
    options.also.mirrors = options.also.parallelCamera = true;
    Renderer able(device(), flat.packed, options);
    EXPECT_TRUE(sameBits(able.render(request), draw(device(), makeCase(scene, 40, 30))));
    request.limits.depth = 3;
    scene.maxDepth = 3;
    EXPECT_TRUE(sameBits(able.render(request), draw(device(), makeCase(scene, 40, 30))));
}

// In glass and in air, whichever the scene was packed for.
TEST_F(RequestTest, CameraRaysStartInTheMediaAroundTheRequestsEye) {
    const Case inside = fileCase("inside_glass", 40, 30);
    Scene scene = inside.scene;
    scene.camera.eye = {0, 8, 3};
    const Case outside = makeCase(scene, 40, 30);
    ASSERT_NE(inside.packed.environment.eyeMedium0, outside.packed.environment.eyeMedium0);
    for (Case c : {inside, outside}) {
        c.camera = c.packed.environment.eyeMedium0 == 0 ? inside.camera : outside.camera;
        EXPECT_TRUE(verified(c).passed());
    }
}

// The reference supports images without shadows, too.
TEST_F(RequestTest, WithoutShadowsBothTracersAgree) {
    for (const char* name : {"lights", "glass"}) {
        const Case c = fileCase(name, 40, 30);
        Renderer renderer(device(), c.packed);
        verify::Options options;
        options.shadows = false;
        EXPECT_TRUE(verified(renderer, c, options).passed()) << name;
        Request request = wholeWithData(c);
        request.shadows = false;
        const Picture picture = renderer.render(request);
        EXPECT_EQ(countPixels(picture, [](const PixelData& d) { return d.shadowBits != 0; }), 0u) << name;
    }
}

}  // namespace glint::render::test::request_test
