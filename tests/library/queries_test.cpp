// Many rays: types, pieces, order, cancelling, pictures.
#include <cmath>
#include <cstdio>
#include <set>

#include "closed_meshes.h"

namespace glint::library::test {
namespace {

// More rays than a piece of the device holds; fewer for the reference, which traces them in blocks.
const size_t kMany = kOnDevice ? 150'001 : 5'001;

using LibraryQueries = LibraryTest;

// Numbers asked for in fp32 are those in fp64, rounded; normals of triangles come from the packed scene then.
TEST_F(LibraryQueries, FloatsAreDoublesRounded) {
    for (const char* name : {"knot.json", "instances.json", "quadrics.json"}) {
        load(name);
        const RayList list = raysInto(scene(), 3000, 5);
        const glint_rays rays = list.rays();
        const Found wide = closest(rays);
        std::vector<float> t(list.size());
        std::vector<F3> normal(t.size()), point(t.size());
        std::vector<D3> exactPoint(t.size());
        GLINT_INIT(glint_hits, hits);
        hits.t = outOf(t);
        hits.normal = outOf(normal);
        hits.point = outOf(point);
        ASSERT_OK(glint_query_closest(scene(), &rays, &hits, nullptr));
        GLINT_INIT(glint_hits, exact);
        exact.point = outOf(exactPoint);
        ASSERT_OK(glint_query_closest(scene(), &rays, &exact, nullptr));
        size_t found = 0;
        for (size_t i = 0; i < t.size(); ++i) {
            found += wide.geometry[i] != GLINT_NONE;
            EXPECT_EQ(t[i], static_cast<float>(wide.t[i]));
            for (int axis = 0; axis < 3; ++axis) {
                const double n = wide.normal[i][axis];
                EXPECT_NEAR(static_cast<double>(normal[i][axis]), n, 0x1p-24 * std::abs(n) + 1e-12);
                EXPECT_EQ(point[i][axis], static_cast<float>(exactPoint[i][axis]));
            }
        }
        EXPECT_GT(found, 300u) << name;
    }
}

// The names of a hit are the same with and without its surface.
TEST_F(LibraryQueries, NamesAreTheSameByThemselves) {
    for (const char* name : {"knot.json", "instances.json", "quadrics.json", "groups.json"}) {
        load(name);
        const RayList list = raysInto(scene(), 3000, 6);
        const glint_rays rays = list.rays();
        Found found;
        std::array<std::vector<uint32_t>, 3> alone, with;
        for (auto* names : {&alone, &with}) {
            glint_hits hits = found.outputs(list.size());
            if (names == &alone) hits.hit = hits.t = hits.normal = hits.point = hits.origin = glint_out{};
            for (auto& one : *names) one.assign(list.size(), 77);
            hits.geometry = outOf((*names)[0]);
            hits.primitive = outOf((*names)[1]);
            hits.material = outOf((*names)[2]);
            ASSERT_OK(glint_query_closest(scene(), &rays, &hits, nullptr));
        }
        EXPECT_EQ(alone, with) << name;
        EXPECT_GT(std::set<uint32_t>(with[2].begin(), with[2].end()).size(), 1u) << name;  // GLINT_NONE too
    }
}

// More rays than a piece holds: each is answered as by itself, neighbours or not.
TEST_F(LibraryQueries, PiecesAndNeighboursChangeNothing) {
    load("knot.json");
    const RayList list = raysInto(scene(), kMany, 2);
    glint_rays rays = list.rays();
    const Found many = closest(rays);
    const std::vector<uint8_t> hit = any(rays);
    rays.flags = GLINT_RAYS_COHERENT;
    const Found coherent = closest(rays);
    EXPECT_EQ(many.t, coherent.t);
    EXPECT_EQ(many.geometry, coherent.geometry);
    EXPECT_EQ(many.primitive, coherent.primitive);
    size_t differ = 0;
    for (size_t i = 0; i < hit.size(); ++i) differ += (hit[i] == 1) != (many.geometry[i] != GLINT_NONE);
    EXPECT_EQ(differ, 0u);
    for (const size_t i : {size_t{0}, size_t{1023}, kMany * 7 / 8, kMany - 1}) {
        RayList alone;
        alone.add(list.origins[i], list.directions[i]);
        const Found one = closest(alone.rays());
        EXPECT_EQ(one.t[0], many.t[i]) << i;
        EXPECT_EQ(one.primitive[0], many.primitive[i]) << i;
    }
}

// A picture's rays in rows, or rays in no order, two of them of another scale.
RayList raysOf(const glint_scene* scene, bool picture) {
    constexpr int kWidth = 120, kHeight = 90;
    RayList rays = raysInto(scene, picture ? 1 : 12'000, 5);
    if (picture) {
        const D3 eye = rays.origins[0], ahead = rays.directions[0];
        rays = {};
        for (int y = 0; y < kHeight; ++y) {
            for (int x = 0; x < kWidth; ++x) {
                const double u = (x - kWidth / 2) / 300.0, v = (y - kHeight / 2) / 300.0;
                rays.add(eye, {ahead[0] + u * ahead[1] - v * ahead[2], ahead[1] - u * ahead[0],
                               ahead[2] + v * ahead[0]});
            }
        }
    }
    // What fp32 holds, so that arrays of either type are of the same rays.
    for (std::vector<D3>* all : {&rays.origins, &rays.directions})
        for (D3& three : *all) three = D3(glm::vec3(three));
    const size_t middle = rays.size() / 2;
    rays.directions[middle] *= 0x1p40;
    rays.directions[middle + 1] *= 0x1p-40;
    return rays;
}

// The device's order of rays depends on all rays of a call; calls of few rays keep the given order.
TEST_F(LibraryQueries, OrderChangesNothing) {
    for (const char* name : {"knot.json", "instances.json"}) {
        load(name);
        for (const bool picture : {true, false}) {
            SCOPED_TRACE(std::string(name) + (picture ? ", a picture" : ""));
            const RayList together = raysOf(scene(), picture);
            const Answers all = answers(together.rays());
            for (size_t first = 0; first < together.size(); first += 1000) {
                const auto fewOf = [&](const auto& values) {
                    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(first);
                    return std::vector(begin, begin + std::min<std::ptrdiff_t>(1000, values.end() - begin));
                };
                RayList few;
                few.origins = fewOf(together.origins);
                few.directions = fewOf(together.directions);
                const Answers some = answers(few.rays());
                EXPECT_EQ(some.closest.t, fewOf(all.closest.t));
                EXPECT_EQ(some.closest.primitive, fewOf(all.closest.primitive));
                EXPECT_EQ(some.closest.normal, fewOf(all.closest.normal));
                EXPECT_EQ(some.any, fewOf(all.any));
                EXPECT_EQ(some.crossings, fewOf(all.crossings));
            }
            EXPECT_GT(std::count(all.any.begin(), all.any.end(), 1), 1000);
        }
    }
}

TEST_F(LibraryQueries, BothTypesAreReadAlike) {
    load("knot.json");
    const RayList wide = raysOf(scene(), false);
    const std::vector<glm::vec3> origins(wide.origins.begin(), wide.origins.end());
    const std::vector<glm::vec3> directions(wide.directions.begin(), wide.directions.end());
    EXPECT_EQ(closest(raysFrom(origins, directions)).t, closest(wide.rays()).t);
}

TEST_F(LibraryQueries, CancelledAndReported) {
    load("spheres.json");
    const RayList list = raysInto(scene(), 2 * kMany, 4);
    const glint_rays rays = list.rays();
    Found found;
    const glint_hits hits = found.outputs(list.size());
    Watch watch;
    const glint_options options = watch.options();
    ASSERT_OK(glint_query_closest(scene(), &rays, &hits, &options));
    ASSERT_FALSE(watch.told.empty());
    EXPECT_EQ(watch.told.back(), 1);
    EXPECT_TRUE(std::is_sorted(watch.told.begin(), watch.told.end()));
    EXPECT_GT(watch.asked, 1);
    watch.cancelAt = watch.asked + 1;
    EXPECT_EQ(glint_query_closest(scene(), &rays, &hits, &options), GLINT_ERROR_CANCELLED);
}

TEST_F(LibraryQueries, PicturesAndTheirLayers) {
    load("spheres.json");
    constexpr uint32_t kWidth = 40, kHeight = 30;
    std::vector<std::array<float, 4>> color(kWidth * kHeight);
    std::vector<double> depth(kWidth * kHeight);
    std::vector<uint32_t> geometry(kWidth * kHeight);
    GLINT_INIT(glint_picture, picture);
    picture.width = kWidth;
    picture.height = kHeight;
    picture.samples = 1;
    picture.color = outOf(color);
    picture.depth = outOf(depth);
    picture.geometry = outOf(geometry);
    ASSERT_OK(glint_render(scene(), &picture, nullptr));
    size_t seen = 0;
    for (size_t i = 0; i < depth.size(); ++i) {
        EXPECT_EQ(std::isfinite(depth[i]), geometry[i] != GLINT_NONE);
        EXPECT_EQ(color[i][3], geometry[i] != GLINT_NONE ? 1.0f : 0.0f);
        seen += geometry[i] != GLINT_NONE;
    }
    EXPECT_GT(seen, depth.size() / 10);
    // From straight above, far away, everything is smaller.
    GLINT_INIT(glint_camera, camera);
    camera.eye[1] = 1000;
    camera.up[2] = 1;
    camera.fov_y = 40;
    picture.camera = &camera;
    picture.camera_name = "top";
    EXPECT_EQ(glint_render(scene(), &picture, nullptr), GLINT_ERROR_ARGUMENT) << "both";
    picture.camera_name = nullptr;
    const std::vector<double> before = depth;
    ASSERT_OK(glint_render(scene(), &picture, nullptr));
    EXPECT_NE(depth, before);
    EXPECT_GT(depth[kWidth * kHeight / 2 + kWidth / 2], 900);
    GLINT_INIT(glint_options, options);
    options.cancelled = [](void*) { return 1; };
    EXPECT_EQ(glint_render(scene(), &picture, &options), GLINT_ERROR_CANCELLED);
    picture.color.count = 3;
    EXPECT_EQ(glint_render(scene(), &picture, nullptr), GLINT_ERROR_ARGUMENT);
}

// All samples of a uniform sky are equal. Both samples of a pixel may have missed something, which with 95 %
// confidence comes to (1 - 0.05^(1/2)) / 16 of 256 pixels. Rounding to fp32 adds half an ulp.
TEST_F(LibraryQueries, BoundsHoldMoreThanSampling) {
    addJson(scene(), R"({"background": [0.3, 0.5, 0.7], "camera": {"eye": [0, 0, 5], "target": [0, 0, 9]},
        "objects": [{"type": "sphere", "center": [0, 0, 0], "radius": 1}]})");
    commit();
    std::vector<std::array<float, 4>> color(16 * 16);
    double bound = -1;
    GLINT_INIT(glint_picture, picture);
    picture.width = picture.height = 16;
    picture.color = outOf(color);
    picture.error = 0.01;
    picture.max_samples = 2;
    picture.bound = &bound;
    EXPECT_OK(glint_render(scene(), &picture, nullptr));
    EXPECT_EQ(color[0][1], 0.5f);
    const double unseen = (1 - std::sqrt(0.05)) / 16;
    EXPECT_GE(bound, unseen + 0x1p-24 - 1e-15);
    EXPECT_LT(bound, unseen + 1e-6);
}

TEST_F(LibraryQueries, PicturesToAnError) {
    load("lights.json");
    std::vector<std::array<float, 4>> color(24 * 16);
    double bound = -1;
    GLINT_INIT(glint_picture, picture);
    picture.width = 24;
    picture.height = 16;
    picture.color = outOf(color);
    picture.error = 0.02;
    picture.bound = &bound;
    ASSERT_OK(glint_render(scene(), &picture, nullptr));
    EXPECT_GT(bound, 0);
    EXPECT_LE(bound, 0.02);

    // The samples end, and the bound says so.
    picture.error = 1e-3;
    picture.max_samples = 2;
    ASSERT_OK(glint_render(scene(), &picture, nullptr));
    EXPECT_GT(bound, 1e-3);

    // A caller of the version before, whose struct ended with the layers.
    picture.size = offsetof(glint_picture, error);
    picture.samples = 4;
    ASSERT_OK(glint_render(scene(), &picture, nullptr));
    picture.size = sizeof(picture);
    EXPECT_EQ(glint_render(scene(), &picture, nullptr), GLINT_ERROR_ARGUMENT);  // samples and error
    picture.samples = 0;
    picture.confidence = 0.4;
    EXPECT_EQ(glint_render(scene(), &picture, nullptr), GLINT_ERROR_ARGUMENT);
}

}  // namespace
}  // namespace glint::library::test
