// Arrays in and out: types, strides, what is not wanted, what is refused.
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "support.h"

namespace glint::library::test {
namespace {

class LibraryArrays : public LibraryTest {
  protected:
    // The square [0, 1]^2 at z = 0, seen from above along -z.
    void addSquare() {
        addMesh<F3>({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 2}, {0, 2, 3}});
        commit();
    }
};

TEST_F(LibraryArrays, EveryOutputOfAKnownHit) {
    addSquare();
    const std::vector<D3> origins = {{0.75, 0.25, 2}, {5, 5, 2}}, directions = {{0, 0, -4}};
    glint_rays rays = raysFrom(origins, directions);
    Found found;
    std::vector<uint32_t> material(2);
    std::vector<std::array<float, 2>> uv(2);
    std::vector<F3> normal(2);
    glint_hits hits = found.outputs(2);
    hits.material = outOf(material);
    hits.uv = outOf(uv);
    hits.normal = outOf(normal);
    ASSERT_OK(glint_query_closest(scene(), &rays, &hits, nullptr));
    EXPECT_EQ(found.hit, (std::vector<uint8_t>{1, 0}));
    EXPECT_EQ(found.t[0], 0.5);  // in units of the direction
    EXPECT_EQ(found.geometry[0], 0u);
    EXPECT_EQ(found.primitive[0], 0u);
    EXPECT_EQ(material[0], 0u);
    EXPECT_EQ(uv[0], (std::array<float, 2>{0.5f, 0.25f}));  // 1/4 a + 1/2 b + 1/4 c
    EXPECT_EQ(found.point[0], (D3{0.75, 0.25, 0}));
    EXPECT_EQ(normal[0], (F3{0, 0, 1}));
    EXPECT_TRUE(std::isinf(found.t[1]));
    EXPECT_EQ(found.geometry[1], GLINT_NONE);
    EXPECT_EQ(found.primitive[1], GLINT_NONE);
    EXPECT_EQ(material[1], GLINT_NONE);
    EXPECT_EQ(uv[1], (std::array<float, 2>{0, 0}));
    EXPECT_EQ(found.point[1], (D3{0, 0, 0}));
}

// A caller's structs: strided inputs and outputs, unaligned ones, and an array read backwards.
TEST_F(LibraryArrays, StridesOfAnySign) {
    addSquare();
    struct [[gnu::packed]] Row {
        char tag;
        float origin[3];
        double way[3];
        double t;
        char end;
    };
    std::vector<Row> rows;
    for (int i = 0; i < 5; ++i)
        rows.push_back({'a', {0.5f, 0.25f, 1.0f + static_cast<float>(i)}, {0, 0, -1}, -7, 'z'});
    const auto* base = reinterpret_cast<const char*>(rows.data());
    const int64_t stride = sizeof(Row);
    GLINT_INIT(glint_rays, rays);
    rays.origins = {base + offsetof(Row, origin) + 4 * stride, 5, -stride, GLINT_F32, 0};
    rays.directions = {base + offsetof(Row, way), 5, stride, GLINT_F64, 0};
    GLINT_INIT(glint_hits, hits);
    hits.t = {reinterpret_cast<char*>(rows.data()) + offsetof(Row, t), 5, stride, GLINT_F64, 0};
    ASSERT_OK(glint_query_closest(scene(), &rays, &hits, nullptr));
    for (int i = 0; i < 5; ++i) {
        double t = 0;
        std::memcpy(&t, reinterpret_cast<char*>(&rows[i]) + offsetof(Row, t), sizeof(t));
        EXPECT_EQ(t, 5.0 - i);
        EXPECT_EQ(rows[i].tag, 'a');
        EXPECT_EQ(rows[i].end, 'z');
    }
}

TEST_F(LibraryArrays, IntervalsAndBroadcasts) {
    addSquare();
    const std::vector<F3> origin = {{0.5f, 0.25f, 2}}, directions(4, F3{0, 0, -1});
    const std::vector<double> tMin = {0, 2, 1.5, 0},
                              tMax = {1, 9, 2, std::numeric_limits<double>::infinity()};
    glint_rays rays = raysFrom(origin, directions);
    rays.t_min = viewOf(tMin);
    rays.t_max = viewOf(tMax);
    EXPECT_EQ(any(rays), (std::vector<uint8_t>{0, 0, 1, 1}));  // tMin < t <= tMax
    // Behind the origin, or nowhere: the square is at t = -2 of the ray that turns its back on it.
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<F3> away = {{0, 0, 1}, {0, 0, -1}, {0, 0, -1}, {0, 0, -1}};
    const std::vector<double> from = {-9, nan, -9, 3}, to = {9, 9, -1, 1};
    rays.directions = viewOf(away);
    rays.t_min = viewOf(from);
    rays.t_max = viewOf(to);
    EXPECT_EQ(any(rays), std::vector<uint8_t>(4, 0));
}

// Of every kind, whatever t_min: rays that turn their backs on it, and from inside only what lies ahead.
TEST_F(LibraryArrays, NothingIsMetBehindTheOrigin) {
    for (const char* object :
         {R"("type": "sphere", "center": [0, 0, -2], "radius": 1)",
          R"("type": "box", "min": [-1, -1, -3], "max": [1, 1, -1])",
          R"("type": "disc", "center": [0, 0, -2], "normal": [0, 0, 1], "radius": 1)",
          R"("type": "plane", "point": [0, 0, -2], "normal": [0, 0, 1])",
          R"("type": "cylinder", "base": [0, 0, -3], "top": [0, 0, -1], "radius": 1, "capped": true)",
          R"("type": "cone", "base": [0, 0, -3], "apex": [0, 0, -1], "radius": 1)",
          R"("type": "polygon", "vertices": [[-1, -1, -2], [1, -1, -2], [0, 1, -2]])"}) {
        useScene(nullptr);
        const std::string text =
            R"({"materials": {"m": {}}, "objects": [{"material": "m", )" + std::string(object) + "}]}";
        addJson(scene(), text);
        commit();
        const std::vector<D3> origins(2, D3{0.125, 0.0625, 0}), directions = {{0, 0, 1}, {0, 0, -1}};
        const std::vector<double> from(2, -9);
        glint_rays rays = raysFrom(origins, directions);
        rays.t_min = viewOf(from);
        const std::vector<uint32_t> crossed = counts(rays);
        EXPECT_EQ(any(rays), (std::vector<uint8_t>{0, 1})) << object;
        EXPECT_EQ(closest(rays).hit, (std::vector<uint8_t>{0, 1})) << object;
        EXPECT_EQ(crossed[0], 0u) << object;
        EXPECT_GT(crossed[1], 0u) << object;
    }
}

TEST_F(LibraryArrays, RaysThatAreNoneHitNothing) {
    addSquare();
    const float nan = std::numeric_limits<float>::quiet_NaN(),
                infinite = std::numeric_limits<float>::infinity();
    const std::vector<F3> origins = {
        {nan, 0.25f, 2}, {0.5f, 0.25f, 2}, {0.5f, 0.25f, 2}, {0.5f, 0.25f, infinite}};
    const std::vector<F3> directions = {{0, 0, -1}, {0, 0, 0}, {0, nan, -1}, {0, 0, -1}};
    glint_rays rays = raysFrom(origins, directions);
    EXPECT_EQ(any(rays), std::vector<uint8_t>(4, 0));
}

TEST_F(LibraryArrays, NothingWantedIsNothingDone) {
    addSquare();
    const std::vector<F3> origins = {{0.5f, 0.25f, 2}}, directions = {{0, 0, -1}};
    glint_rays rays = raysFrom(origins, directions);
    GLINT_INIT(glint_hits, hits);
    Watch watch;
    const glint_options options = watch.options();
    EXPECT_OK(glint_query_closest(scene(), &rays, &hits, &options));
    EXPECT_EQ(watch.asked, 0);
}

TEST_F(LibraryArrays, WhatIsRefusedIsNamed) {
    const std::vector<F3> three(3), two(2);
    std::vector<uint8_t> hit(3);
    std::vector<float> real(3);
    glint_rays rays = raysFrom(three, three);
    glint_out out = outOf(hit);
    refused(glint_query_any(scene(), &rays, &out, nullptr), "has not been committed");
    addSquare();
    EXPECT_OK(glint_query_any(scene(), &rays, &out, nullptr));
    rays.directions = viewOf(two);
    refused(glint_query_any(scene(), &rays, &out, nullptr), "rays.directions has 2 elements, and 3");
    rays.directions = viewOf(three);
    rays.directions.type = GLINT_U32;
    refused(glint_query_any(scene(), &rays, &out, nullptr), "rays.directions is neither");
    rays.directions = {nullptr, 3, 0, GLINT_F32, 0};
    refused(glint_query_any(scene(), &rays, &out, nullptr), "rays.directions has no data");
    rays.directions = viewOf(three);
    rays.flags = 64;
    refused(glint_query_any(scene(), &rays, &out, nullptr), "rays.flags");
    rays.flags = 0;
    out.count = 2;
    refused(glint_query_any(scene(), &rays, &out, nullptr), "hit has 2 elements, and 3");
    out = outOf(real);
    refused(glint_query_any(scene(), &rays, &out, nullptr), "hit is not GLINT_U8");
    rays.size = 0;
    refused(glint_query_any(scene(), &rays, &out, nullptr), "rays.size is not set");
    refused(glint_query_any(scene(), nullptr, &out, nullptr), "rays is NULL");
    refused(glint_query_any(nullptr, &rays, &out, nullptr), "scene is NULL");
}

// A stride in elements instead of bytes, mostly: numbers would lie in each other, or what is written.
TEST_F(LibraryArrays, StridesThatOverlapAreRefused) {
    const std::vector<F3> three = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const std::vector<std::array<uint32_t, 3>> two = {{0, 1, 2}, {0, 2, 1}};
    GLINT_INIT(glint_triangles, mesh);
    mesh.vertices = {three.data(), 3, 3, GLINT_F32, 0};
    refused(glint_scene_add_triangles(scene(), &mesh, nullptr),
            "vertices has a stride of 3 bytes, and a number takes 4");
    mesh.vertices.stride = 0;
    mesh.indices = {two.data(), 2, -3, GLINT_U32, 0};
    refused(glint_scene_add_triangles(scene(), &mesh, nullptr), "indices has a stride of -3 bytes");
    addSquare();
    GLINT_INIT(glint_rays, rays);
    rays.origins = {three.data(), 3, 3, GLINT_F32, 0};
    rays.directions = {three.data(), 1, 3, GLINT_F32, 0};  // of one element a stride says nothing
    std::vector<F3> normals(3);
    GLINT_INIT(glint_hits, hits);
    hits.normal = {normals.data(), 3, 3, GLINT_F32, 0};
    refused(glint_query_closest(scene(), &rays, &hits, nullptr), "rays.origins has a stride of 3 bytes");
    rays.origins.stride = 4;  // windows that slide
    rays.origins.count = 2;
    refused(glint_query_closest(scene(), &rays, &hits, nullptr),
            "hits.normal has a stride of 3 bytes, and an element takes 12");
    hits.normal.stride = -8;
    refused(glint_query_closest(scene(), &rays, &hits, nullptr), "hits.normal has a stride of -8 bytes");
    hits.normal.stride = 0;
    EXPECT_OK(glint_query_closest(scene(), &rays, &hits, nullptr));
}

// An empty batch may come with anything: a loop over lists, one of which is empty.
TEST_F(LibraryArrays, NoRaysAreAskedNothing) {
    addSquare();
    const std::vector<F3> some(4);
    const std::vector<double> ends(4, 1.0);
    std::vector<uint8_t> hit(1, 9);
    const glint_out out = outOf(hit);
    for (const uint64_t bounds : {0, 1, 4}) {
        GLINT_INIT(glint_rays, rays);
        rays.origins = {some.data(), 0, 0, GLINT_F32, 0};
        rays.directions = viewOf(some);
        rays.t_min = {ends.data(), bounds, 0, GLINT_F64, 0};
        rays.t_max = rays.t_min;
        EXPECT_OK(glint_query_any(scene(), &rays, &out, nullptr));
    }
    EXPECT_EQ(hit[0], 9);
}

// Also where there is nothing to do, so that it is found where it is written.
TEST_F(LibraryArrays, OptionsWithoutASizeAreRefused) {
    addSquare();
    GLINT_INIT(glint_rays, rays);
    GLINT_INIT(glint_hits, hits);
    const glint_options options = {};
    EXPECT_EQ(glint_query_closest(scene(), &rays, &hits, &options), GLINT_ERROR_ARGUMENT);
    EXPECT_STREQ(glint_last_error(), "options.size is not set: GLINT_INIT does it");
}

// Counts and strides that no memory has, as a caller's own arithmetic may make them: nothing is read or
// taken.
TEST_F(LibraryArrays, WhatReachesBeyondAllMemoryIsRefused) {
    const std::vector<F3> three = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    const std::vector<std::array<uint32_t, 3>> one = {{0, 1, 2}};
    GLINT_INIT(glint_triangles, mesh);
    const auto add = [&] { return glint_scene_add_triangles(scene(), &mesh, nullptr); };
    for (const uint64_t count : {uint64_t{1} << 63, ~uint64_t{0}}) {
        mesh.vertices = {three.data(), count, 0, GLINT_F32, 0};
        refused(add(), "vertices would reach beyond all memory");
    }
    for (const int64_t stride : {std::numeric_limits<int64_t>::min(), std::numeric_limits<int64_t>::max()}) {
        mesh.vertices = {three.data(), 3, stride, GLINT_F32, 0};
        refused(add(), "vertices would reach beyond all memory");
    }
    mesh.vertices = {three.data(), 3 * (uint64_t{1} << 40), 0, GLINT_F32, 0};  // would be numbered by U32
    refused(add(), "3298534883328 vertices, the limit is 4294967294");
    mesh.vertices = viewOf(three);
    mesh.indices = {one.data(), uint64_t{1} << 62, 0, GLINT_U32, 0};
    refused(add(), "4611686018427387904 triangles, the limit is 4294967294");
    addSquare();
    GLINT_INIT(glint_rays, rays);
    rays.origins = {three.data(), uint64_t{1} << 61, 0, GLINT_F32, 0};
    rays.directions = {three.data(), 1, 0, GLINT_F32, 0};
    std::vector<uint8_t> hit(1);
    glint_out out = outOf(hit);
    refused(glint_query_any(scene(), &rays, &out, nullptr), "rays.origins would reach beyond all memory");
    // Room that is not touched may be of any size.
    rays.origins.count = 1;
    out.count = ~uint64_t{0};
    EXPECT_OK(glint_query_any(scene(), &rays, &out, nullptr));
}

TEST_F(LibraryArrays, PicturesThatNobodyCanDrawAreTheCallersFault) {
    addSquare();
    GLINT_INIT(glint_picture, picture);
    const auto refuse = [&](const std::string& part) {
        refused(glint_render(scene(), &picture, nullptr), part);
    };
    picture.width = 0xffffffffu;
    refuse("picture.width must be at most 65536, but is 4294967295");
    picture.width = 8;
    picture.samples = 65537;
    refuse("picture.samples must be at most 65536, but is 65537");
    picture.samples = 0;
    GLINT_INIT(glint_camera, camera);
    camera.eye[0] = std::numeric_limits<double>::quiet_NaN();
    picture.camera = &camera;
    refuse("camera/eye: must be finite");
    picture.camera = nullptr;
    picture.camera_name = "\x1b[31m";
    refuse("no camera \"?[31m\"");
    glint_device* none = nullptr;
    EXPECT_NE(glint_device_open("\x1b[31m", &none), GLINT_OK);
    EXPECT_EQ(std::string(glint_last_error()).find('\x1b'), std::string::npos);
}

// A struct of an older version is shorter: what it lacks counts as zero.
TEST_F(LibraryArrays, ShorterStructs) {
    addSquare();
    const std::vector<F3> origins = {{0.5f, 0.25f, 2}}, directions = {{0, 0, -1}};
    glint_rays rays = raysFrom(origins, directions);
    rays.size = offsetof(glint_rays, t_min);
    std::memset(static_cast<void*>(&rays.t_min), 0x5a, sizeof(rays) - offsetof(glint_rays, t_min));
    EXPECT_EQ(any(rays)[0], 1);
}

}  // namespace
}  // namespace glint::library::test
