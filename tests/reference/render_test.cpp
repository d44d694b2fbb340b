// Whole pictures: camera, AOVs, crop, samples, threads, cancelling.
#include "reference/render.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <mutex>

#include "scene_maker.h"

namespace glint::reference::test {
namespace {

using glm::dvec2;
using glm::dvec3;
using glm::vec3;

constexpr int kWidth = 40, kHeight = 30;

class ReferenceRender : public testing::Test {
  protected:
    ReferenceRender() {
        SceneMaker maker;
        const uint32_t mirror = maker.material(vec3(.3f), vec3(.5f), 20, vec3(.5f), vec3(.3f));
        maker.plane({0, -1, 0}, {0, 1, 0});
        maker.sphere({-1, 0, -6}, 1, mirror);
        maker.triangle({0, -1, -5}, {2, -1, -7}, {1, 1, -6}, mirror);
        maker.light(shared::kLightPoint, {5, 5, 0});
        maker.environment.background = {.1f, .2f, .3f};
        maker.environment.ambient = vec3(.5f);
        scene_ = maker.finish();
        scene_.origin = {1e6, 2e6, 3e6};
        // Eye at the local origin, looking along -z, 90 degrees high: the picture is 2 high at distance 1.
        camera_.center = {0, 0, -1};
        camera_.stepX = {2.0f / kHeight, 0, 0};
        camera_.stepY = {0, -2.0f / kHeight, 0};
        camera_.halfWidth = kWidth / 2.0f;
        camera_.halfHeight = kHeight / 2.0f;
        camera_.farT = shared::kInfinity;
    }
    RenderResult draw(const RenderOptions& options = {}) const {
        return render(scene_, camera_, kWidth, kHeight, options);
    }
    PackedScene scene_;
    shared::Camera camera_;
};

void expectSame(const PixelResult& a, const PixelResult& b) {
    EXPECT_EQ(a.color, b.color);
    EXPECT_EQ(a.alpha, b.alpha);
    EXPECT_EQ(a.depth, b.depth);
    EXPECT_EQ(a.position, b.position);
    EXPECT_EQ(a.normal, b.normal);
    EXPECT_EQ(a.object, b.object);
    EXPECT_EQ(a.pathHash, b.pathHash);
    EXPECT_EQ(a.shadowBits, b.shadowBits);
    EXPECT_EQ(a.cost, b.cost);
    EXPECT_EQ(a.hit, b.hit);
}

TEST_F(ReferenceRender, CameraRaysGoThroughTheFilm) {
    const Tracer tracer(scene_);
    const Ray middle = tracer.cameraRay(camera_, kWidth / 2.0, kHeight / 2.0);
    EXPECT_EQ(middle.direction, dvec3(0, 0, -1));
    EXPECT_EQ(middle.tMin, 0);
    EXPECT_EQ(middle.tMax, std::numeric_limits<double>::infinity());
    const Ray corner = tracer.cameraRay(camera_, 0, 0);  // the top left: (-4/3, 1, -1)
    const dvec3 expected = glm::normalize(dvec3(-4.0 / 3, 1, -1));
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(corner.direction[i], expected[i], 1e-7);
    camera_.nearT = 2;
    camera_.farT = 7;
    EXPECT_EQ(tracer.cameraRay(camera_, 3, 4).tMin, 2);
    EXPECT_EQ(tracer.cameraRay(camera_, 3, 4).tMax, 7);
}

// Shirley & Marschner, Fundamentals of Computer Graphics, sec. 4.3.1: origin e + u U + v V, direction -W.
TEST_F(ReferenceRender, ParallelCameraRaysStartOnTheFilm) {
    const Tracer tracer(scene_);
    std::swap(camera_.stepX, camera_.originStepX);
    std::swap(camera_.stepY, camera_.originStepY);
    camera_.eye = {10, 20, 30};
    EXPECT_EQ(tracer.cameraRay(camera_, kWidth / 2.0, kHeight / 2.0).origin, dvec3(10, 20, 30));
    const Ray corner = tracer.cameraRay(camera_, 0, 0);
    const dvec3 expected(10 - 4.0 / 3, 21, 30);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(corner.origin[i], expected[i], 1e-6);
    EXPECT_EQ(corner.direction, dvec3(0, 0, -1));
}

// What the coordinates are sums of: 10 + 4/3, 30 + 1 and 20 for this origin; for this direction, 1 + 1 in y,
// which cancel, over the length of (-4/3, 0, -1), 5/3.
TEST_F(ReferenceRender, CameraRaysKnowTheirCancellation) {
    const Tracer tracer(scene_);
    EXPECT_EQ(tracer.cameraRay(camera_, 0, 0).directionScale, 1) << "nothing cancels";
    camera_.center = {0, -1, -1};
    EXPECT_NEAR(tracer.cameraRay(camera_, 0, 0).directionScale, 2 * 3.0 / 5, 1e-6);
    std::swap(camera_.stepX, camera_.originStepX);
    std::swap(camera_.stepY, camera_.originStepY);
    camera_.eye = {10, -30, 20};
    EXPECT_NEAR(tracer.cameraRay(camera_, 0, 0).originScale, 31, 1e-5);
    EXPECT_EQ(tracer.cameraRay(camera_, 0, 0).directionScale, 1);
}

TEST_F(ReferenceRender, AovsAreWhatTheRaySees) {
    const RenderResult result = draw();
    ASSERT_TRUE(result.complete);
    const Tracer tracer(scene_);
    int seen[4] = {0, 0, 0, 0};
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const PixelResult& pixel = result.at(x, y);
            const Ray ray = tracer.cameraRay(camera_, x + .5, y + .5);
            ++seen[pixel.object + 1];
            EXPECT_EQ(pixel.color, tracer.trace(ray).color);
            EXPECT_EQ(pixel.pathHash, tracer.trace(ray).pathHash);
            if (pixel.object < 0) {
                EXPECT_EQ(pixel.alpha, 0);
                EXPECT_EQ(pixel.depth, std::numeric_limits<double>::infinity());
                EXPECT_EQ(pixel.position, dvec3(0));
                EXPECT_EQ(pixel.material, -1);
                EXPECT_EQ(pixel.primitive, -1);
                EXPECT_EQ(pixel.color, dvec3(vec3(.1f, .2f, .3f)));
                continue;
            }
            EXPECT_EQ(pixel.alpha, 1);
            EXPECT_NEAR(glm::length(pixel.position - scene_.origin), pixel.depth, 1e-8)
                << "an ulp at 3e6 is 5e-10";
            EXPECT_NEAR(glm::length(pixel.normal), 1, 1e-15);
            EXPECT_EQ(pixel.primitive, 0);
            EXPECT_EQ(pixel.material, pixel.object == 0 ? 0 : 1);
            if (pixel.object == 0) {
                EXPECT_EQ(pixel.normal, dvec3(0, 1, 0));
            }
            if (pixel.object == 0) {
                EXPECT_EQ(pixel.bounces, 0u);
            }
            if (pixel.object != 0) {
                EXPECT_GE(pixel.bounces, 1u);
            }
            if (pixel.object != 2) {
                EXPECT_EQ(pixel.u, 0);
            }
        }
    }
    for (const int count : seen) EXPECT_GT(count, 5);
}

TEST_F(ReferenceRender, DoesNotDependOnThreads) {
    RenderOptions one, five;
    one.threads = 1;
    five.threads = 5;
    const RenderResult a = draw(one), b = draw(five);
    ASSERT_EQ(a.pixels.size(), b.pixels.size());
    for (size_t i = 0; i < a.pixels.size(); ++i) expectSame(a.pixels[i], b.pixels[i]);
}

TEST_F(ReferenceRender, CropIsPartOfTheWhole) {
    RenderOptions options;
    options.x0 = 7;
    options.y0 = 11;
    options.x1 = 23;
    options.y1 = 1000;  // clipped
    const RenderResult whole = draw(), crop = draw(options);
    ASSERT_EQ(crop.width, 16);
    ASSERT_EQ(crop.height, kHeight - 11);
    for (int y = 0; y < crop.height; ++y) {
        for (int x = 0; x < crop.width; ++x) expectSame(crop.at(x, y), whole.at(x + 7, y + 11));
    }
    options.x0 = options.x1 = 5;
    EXPECT_TRUE(draw(options).pixels.empty());
}

TEST_F(ReferenceRender, SamplesAverageAndTheFirstGivesTheAovs) {
    RenderOptions options;
    const dvec2 offsets[] = {{.125, .875}, {.5, .5}, {.75, .25}, {0, 0}};
    std::vector<RenderResult> single;
    for (const dvec2& offset : offsets) {
        options.sampleOffsets = {offset};
        single.push_back(draw(options));
    }
    options.sampleOffsets.assign(std::begin(offsets), std::end(offsets));
    const RenderResult all = draw(options);
    int fractions = 0;
    for (size_t i = 0; i < all.pixels.size(); ++i) {
        dvec3 color(0);
        double alpha = 0;
        for (const RenderResult& result : single) {
            color += result.pixels[i].color;
            alpha += result.pixels[i].alpha;
        }
        EXPECT_EQ(all.pixels[i].color, color / 4.0);
        EXPECT_EQ(all.pixels[i].alpha, alpha / 4);
        EXPECT_EQ(all.pixels[i].hit, single[0].pixels[i].hit);
        EXPECT_EQ(all.pixels[i].depth, single[0].pixels[i].depth);
        fractions += alpha > 0 && alpha < 4;
    }
    EXPECT_GT(fractions, 5) << "outlines";
}

TEST_F(ReferenceRender, ProgressRisesToOne) {
    RenderOptions options;
    std::vector<double> seen;
    options.progress = [&](double fraction) { seen.push_back(fraction); };
    options.threads = 3;
    draw(options);
    ASSERT_EQ(seen.size(), static_cast<size_t>(kHeight));
    EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
    EXPECT_EQ(seen.back(), 1);
}

TEST_F(ReferenceRender, CancelledRenderKeepsItsFinishedRows) {
    RenderOptions options;
    options.threads = 1;
    int polls = 0;
    options.cancelled = [&] { return ++polls > 10; };  // one poll for each row of 40 pixels
    const RenderResult result = draw(options), whole = draw();
    EXPECT_FALSE(result.complete);
    for (int y = 0; y < kHeight; ++y) {
        EXPECT_EQ(result.rowsDone[y], y < 10 ? 1 : 0) << y;
        for (int x = 0; x < kWidth && result.rowsDone[y]; ++x) expectSame(result.at(x, y), whole.at(x, y));
    }
}

TEST_F(ReferenceRender, WithoutAovsOnlyColorAndAlpha) {
    RenderOptions options;
    options.aovs = false;
    const RenderResult plain = draw(options), full = draw();
    for (size_t i = 0; i < plain.pixels.size(); ++i) {
        EXPECT_EQ(plain.pixels[i].color, full.pixels[i].color);
        EXPECT_EQ(plain.pixels[i].alpha, full.pixels[i].alpha);
        EXPECT_EQ(plain.pixels[i].object, -1);
        EXPECT_EQ(plain.pixels[i].hit, std::nullopt);
    }
}

}  // namespace
}  // namespace glint::reference::test
