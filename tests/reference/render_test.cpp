// Whole pictures: camera, AOVs, crop, samples, threads, cancelling.
#include "reference/render.h"

#include <gtest/gtest.h>

#include <cstring>

#include "support/packed_scene_maker.h"

namespace glint::reference::test::render_test {
using namespace glint::test;

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
    static Request whole() {
        Request request;
        request.width = kWidth;
        request.height = kHeight;
        request.data = request.exact = true;
        return request;
    }
    Picture draw(const Request& request = whole(), unsigned threads = 0) const {
        return render(Tracer(scene_, request), camera_, request, {.threads = threads});
    }
    PackedScene scene_;
    shared::Camera camera_;
};

// Pixel (x, y) of the whole picture.
void expectSame(const Picture& a, const Picture& b, int x, int y) {
    const size_t i = a.indexOf(x, y), k = b.indexOf(x, y);
    for (int c = 0; c < 4; ++c) EXPECT_EQ(a.color.pixels[i * 4 + c], b.color.pixels[k * 4 + c]);
    EXPECT_EQ(a.exact[i], b.exact[k]);
    static_assert(sizeof(PixelData) == 32 + 16 * sizeof(float), "no padding: bytes are values");
    EXPECT_EQ(std::memcmp(&a.data[i], &b.data[k], sizeof(PixelData)), 0) << x << ',' << y;
}
void expectSame(const Picture& a, const Picture& b) {
    for (int y = a.region.y0; y < a.region.y1; ++y)
        for (int x = a.region.x0; x < a.region.x1; ++x) expectSame(a, b, x, y);
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

// The coordinates are sums of: 10 + 4/3, 30 + 1 and 20 for this origin; for this direction, 1 + 1 in y,
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
    const Picture picture = draw();
    ASSERT_TRUE(picture.complete);
    const Tracer tracer(scene_);
    int seen[4] = {0, 0, 0, 0};
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            const PixelData& pixel = picture.at(x, y);
            const PixelRecord record = tracer.trace(tracer.cameraRay(camera_, x + .5, y + .5));
            ++seen[pixel.object + 1];  // kNoIndex + 1 is 0
            EXPECT_EQ(picture.exactAt(x, y), record.color);
            for (int c = 0; c < 3; ++c)
                EXPECT_EQ(picture.color.at(x, y, c), static_cast<float>(record.color[c]));
            EXPECT_EQ(pixel.pathHash, record.pathHash);
            EXPECT_EQ(pixel.cost, record.cost());
            EXPECT_EQ(picture.color.at(x, y, 3), record.hit ? 1 : 0);
            if (!record.hit) {
                EXPECT_EQ(pixel.object, PixelData::kNoIndex);
                EXPECT_EQ(pixel.depth, std::numeric_limits<double>::infinity());
                EXPECT_EQ(pixel.position, dvec3(0));
                EXPECT_EQ(pixel.material, PixelData::kNoIndex);
                EXPECT_EQ(pixel.primitive, PixelData::kNoIndex);
                EXPECT_EQ(pixel.bounces, 0u);
                EXPECT_EQ(picture.exactAt(x, y), dvec3(vec3(.1f, .2f, .3f)));
                continue;
            }
            EXPECT_NEAR(glm::length(pixel.position - scene_.origin), pixel.depth, 1e-8)
                << "an ulp at 3e6 is 5e-10";
            EXPECT_EQ(pixel.normal, vec3(record.surface->shadingNormal));
            EXPECT_EQ(pixel.geometricNormal, vec3(record.surface->geometricNormal));
            EXPECT_EQ(pixel.primitive, 0u);
            EXPECT_EQ(pixel.material, pixel.object == 0 ? 0u : 1u);
            if (pixel.object == 0) {
                EXPECT_EQ(pixel.normal, vec3(0, 1, 0));
                EXPECT_EQ(pixel.bounces, 0u);
            } else {
                EXPECT_GE(pixel.bounces, 1u);
            }
            if (pixel.object != 2) {
                EXPECT_EQ(pixel.u, 0);
            }
        }
    }
    for (const int count : seen) EXPECT_GT(count, 5);
}

// A triangle whose vertex normals lean to one side: the two normals are not the same.
TEST_F(ReferenceRender, GeometricNormalIsNotTheShadingNormal) {
    SceneMaker maker;
    const vec3 leaning = glm::normalize(vec3(1, 0, 2));
    shared::VertexNormals normals;
    normals.n0 = normals.n1 = normals.n2 = leaning;
    maker.triangle({-9, -9, -5}, {9, -9, -5}, {0, 9, -5}, normals);
    scene_ = maker.finish();
    const Picture picture = draw();
    const PixelData& middle = picture.at(kWidth / 2, kHeight / 2);
    EXPECT_EQ(middle.geometricNormal, vec3(0, 0, 1));
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(middle.normal[i], leaning[i], 1e-6);
}

TEST_F(ReferenceRender, DoesNotDependOnThreads) {
    expectSame(draw(whole(), 1), draw(whole(), 5));
}

TEST_F(ReferenceRender, CropIsPartOfTheWhole) {
    Request request = whole();
    request.region = {7, 11, 23, 1000};  // cut off at the edge
    const Picture crop = draw(request);
    ASSERT_EQ(crop.region.width(), 16);
    ASSERT_EQ(crop.region.height(), kHeight - 11);
    EXPECT_EQ(crop.color.width, 16);
    expectSame(crop, draw());
    request.region = {5, 11, 5, 23};
    EXPECT_TRUE(draw(request).data.empty());
    request.region = {kWidth, 0, kWidth + 8, 8};
    EXPECT_TRUE(draw(request).complete);
    EXPECT_TRUE(draw(request).color.pixels.empty());
}

TEST_F(ReferenceRender, SamplesAverageAndTheFirstGivesTheAovs) {
    Request request = whole();
    const dvec2 offsets[] = {{.125, .875}, {.5, .5}, {.75, .25}, {0, 0}};
    std::vector<Picture> single;
    for (const dvec2& offset : offsets) {
        request.samples = PackedSamples::fixed({offset});
        single.push_back(draw(request));
    }
    request.samples = PackedSamples::fixed({std::begin(offsets), std::end(offsets)});
    const Picture all = draw(request);
    EXPECT_EQ(all.samplesPerPixel, 4u);
    int fractions = 0;
    for (size_t i = 0; i < all.exact.size(); ++i) {
        glm::dvec4 sum(0);
        for (const Picture& picture : single) sum += picture.exact[i];
        EXPECT_EQ(all.exact[i], sum / 4.0);
        EXPECT_EQ(all.color.pixels[4 * i + 3], static_cast<float>(sum.w / 4));
        EXPECT_EQ(all.data[i].object, single[0].data[i].object);
        EXPECT_EQ(all.data[i].depth, single[0].data[i].depth);
        fractions += sum.w > 0 && sum.w < 4;
    }
    EXPECT_GT(fractions, 5) << "outlines";
}

TEST_F(ReferenceRender, ProgressRisesToOne) {
    Request request = whole();
    std::vector<double> seen;
    request.progress = [&](double fraction) { seen.push_back(fraction); };
    draw(request, 3);
    ASSERT_EQ(seen.size(), static_cast<size_t>(kHeight));
    EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
    EXPECT_EQ(seen.back(), 1);
}

TEST_F(ReferenceRender, CancelledRenderKeepsItsFinishedRows) {
    Request request = whole();
    int polls = 0;
    request.cancelled = [&] { return ++polls > 10; };  // one poll for each row of 40 pixels
    const Picture part = draw(request, 1), all = draw();
    EXPECT_FALSE(part.complete);
    for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) {
            EXPECT_EQ(part.done[part.indexOf(x, y)], y < 10 ? 1 : 0) << y;
            if (y < 10) {
                expectSame(part, all, x, y);
            } else {
                EXPECT_EQ(part.color.at(x, y, 0), 0) << "nothing of a row that was not finished";
            }
        }
    }
}

// Rows of many pixels are given up in the middle.
TEST_F(ReferenceRender, CancelledInARowLeavesNothingOfIt) {
    Request request = whole();
    request.width = 4 * kWidth;
    request.region = {0, 0, 4 * kWidth, kHeight};
    int polls = 0;
    request.cancelled = [&] { return ++polls > 7; };  // three polls for each row of 160 pixels
    const Picture part = draw(request, 1);
    EXPECT_FALSE(part.complete);
    EXPECT_EQ(std::count(part.done.begin(), part.done.end(), 1), 2 * 4 * kWidth);
    for (int x = 0; x < 4 * kWidth; ++x) {
        EXPECT_NE(part.color.at(x, 1, 0), 0);
        EXPECT_EQ(part.color.at(x, 2, 0), 0);
        EXPECT_EQ(part.at(x, 2).object, PixelData::kNoIndex);
    }
}

TEST_F(ReferenceRender, WithoutDataOnlyColorAndAlpha) {
    Request request = whole();
    request.data = request.exact = false;
    const Picture plain = draw(request), full = draw();
    EXPECT_TRUE(plain.data.empty());
    EXPECT_TRUE(plain.exact.empty());
    EXPECT_EQ(plain.color.pixels, full.color.pixels);
    request.cost = true;
    EXPECT_FALSE(draw(request).data.empty());
}

}  // namespace glint::reference::test::render_test
