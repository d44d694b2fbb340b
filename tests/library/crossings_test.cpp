// Counts, lists and insides, where rounding decides: rays aimed at the corners and edges of closed meshes,
// and along their planes.
#include <cmath>
#include <iostream>
#include <set>

#include "closed_meshes.h"
#include "oracle.h"
#include "support.h"

namespace glint::library::test {
namespace {

const size_t kCountedRays =
    kOnDevice ? 30'000 : 400;  // rays of each aim at each mesh: 10^6 in all on the device

class LibraryCrossings : public LibraryTest {
  protected:
    // How many of the rays are counted wrong: even from outside, odd from inside.
    size_t wrongCounts(const Closed& mesh, double offset, Aim aim, uint64_t seed) {
        Random random(seed);
        const size_t count = aimedRays(kCountedRays);
        RayList rays;
        std::vector<uint8_t> inside(count);
        for (size_t i = 0; i < count; ++i) {
            inside[i] = i % 2;
            const auto [from, to] = random.aimed(mesh, aim, inside[i] != 0);
            rays.add(from + offset, to - from);
        }
        const std::vector<uint32_t> crossings = counts(rays.rays());
        size_t wrong = 0, some = 0;
        for (size_t i = 0; i < count; ++i) {
            wrong += crossings[i] % 2 != inside[i];
            some += crossings[i] > 0;
        }
        EXPECT_GT(some, count / 2);
        return wrong;
    }

    uint32_t addClosed(const Closed& mesh, double offset) {
        return addMesh<D3>(mesh.movedBy(offset), mesh.corners);
    }

    std::vector<uint8_t> insides(const std::vector<D3>& points) {
        std::vector<uint8_t> where(points.size(), 9);
        const glint_view view = viewOf(points);
        const glint_out out = outOf(where);
        EXPECT_OK(glint_query_inside(scene(), &view, &out, nullptr));
        return where;
    }
};

class LibraryCrossingsFar : public LibraryCrossings, public testing::WithParamInterface<double> {};
INSTANTIATE_TEST_SUITE_P(Offsets, LibraryCrossingsFar, testing::Values(0.0, 1e3, 1e6));

TEST_P(LibraryCrossingsFar, AimedRaysAreCountedRight) {
    size_t rays = 0;
    for (const Closed& mesh : {bumpy(), gridCube(16)}) {
        useScene(nullptr);
        addClosed(mesh, GetParam());
        commit();
        for (const Aim aim : {Aim::Corners, Aim::Edges, Aim::Planes}) {
            for (uint64_t seed = 0; seed < 2; ++seed) {
                EXPECT_EQ(wrongCounts(mesh, GetParam(), aim, seed), 0u) << static_cast<int>(aim);
                rays += aimedRays(kCountedRays);
            }
        }
    }
    std::cout << rays << " rays, offset " << GetParam() << '\n';
}

// Turned, stretched, mirrored, and many of them: each is closed by itself.
TEST_F(LibraryCrossings, Instances) {
    const Closed mesh = gridCube(64);  // 49,152 triangles, enough to be stored once
    const uint32_t first = addClosed(mesh, 0);
    const double turned[12] = {0.6, 0.8, 0, 0, -0.8, 0.6, 0, 0, 0, 0, -1, 0};
    const double around[12] = {9, 1, 0, 0, 0, 9, 2, 0, 1, 0, 9, 0};
    ASSERT_OK(glint_scene_add_instance(scene(), first, turned, nullptr));
    ASSERT_OK(glint_scene_add_instance(scene(), first, around, nullptr));
    commit();
    // Inside all three from the middle: three crossings more or less than a multiple of two.
    EXPECT_EQ(wrongCounts({mesh.vertices, mesh.corners, 0.4, 30}, 0, Aim::Corners, 5), 0u);
    EXPECT_EQ(wrongCounts({mesh.vertices, mesh.corners, 0.4, 30}, 0, Aim::Edges, 6), 0u);
}

// The truth by rationals: crossings of a ray in general position, each decided exactly.
bool trulyInside(const Closed& mesh, const D3& point, Random& random) {
    for (;;) {
        const oracle::Ray ray{point, random.direction()};
        size_t crossings = 0;
        bool general = true;
        for (const U3& c : mesh.corners) {
            const oracle::Truth truth =
                oracle::triangle(mesh.vertices[c[0]], mesh.vertices[c[1]], mesh.vertices[c[2]], ray);
            crossings += truth.hit;
            general = general && truth.margin != 0;
        }
        if (general) return crossings % 2 == 1;
    }
}

TEST_F(LibraryCrossings, InsidesByTheOracle) {
    const Closed mesh = bumpy();
    addClosed(mesh, 0);
    commit();
    Random random(11);
    std::vector<D3> points;
    for (int i = 0; i < 60; ++i) {
        const D3 out = random.direction();
        points.push_back(7 * random.uniform() * out);
    }
    // Next to the surface, above corners and edges, down to what fp32 can tell.
    for (const Aim aim : {Aim::Corners, Aim::Edges}) {
        for (int i = 0; i < 60; ++i) {
            const D3 at = targetOf(mesh, aim, random);
            const double scale = 1 + (i % 2 ? 1 : -1) * std::pow(10, -2 - 0.1 * i);
            points.push_back(at * scale);
        }
    }
    const std::vector<uint8_t> where = insides(points);
    size_t told = 0, on = 0;
    for (size_t i = 0; i < points.size(); ++i) {
        if (where[i] == GLINT_ON_SURFACE) {
            ++on;
            continue;
        }
        ++told;
        EXPECT_EQ(where[i] == GLINT_INSIDE, trulyInside(mesh, points[i], random)) << i;
    }
    EXPECT_GT(told, points.size() * 3 / 4);
    EXPECT_GT(on, 0u);
}

TEST_F(LibraryCrossings, PointsOfTheSurfaceAreOnIt) {
    const Closed mesh = bumpy();
    addClosed(mesh, 1e6);
    commit();
    Random random(12);
    std::vector<D3> on;
    for (int i = 0; i < 300; ++i)
        on.push_back(targetOf(mesh, i % 2 ? Aim::Corners : Aim::Edges, random) + 1e6);
    for (const uint8_t where : insides(on)) EXPECT_EQ(where, GLINT_ON_SURFACE);
    const double nan = std::nan("");
    EXPECT_EQ(insides({{1e6, 1e6, 1e6}, {0, 0, 0}, {nan, 1e6, 1e6}, {1e300, 0, 0}}),
              (std::vector<uint8_t>{GLINT_INSIDE, GLINT_OUTSIDE, GLINT_OUTSIDE, GLINT_OUTSIDE}));
}

TEST_F(LibraryCrossings, InsidesOfOtherShapes) {
    addJson(scene(), R"({"materials": {"m": {}}, "objects": [
        {"type": "sphere", "center": [0, 0, 0], "radius": 1, "material": "m"},
        {"type": "box", "min": [10, -1, -1], "max": [12, 1, 1], "material": "m"},
        {"type": "sphere", "center": [11, 0, 0], "radius": 0.5, "material": "m"}]})");
    commit();
    EXPECT_EQ(insides({{0, 0, 0},
                       {0.9, 0, 0},
                       {1.1, 0, 0},
                       {1, 0, 0},
                       {10.2, 0, 0},
                       {11, 0, 0},
                       {10, 0.5, 0.5},
                       {11, 0, 2}}),
              (std::vector<uint8_t>{GLINT_INSIDE, GLINT_INSIDE, GLINT_OUTSIDE, GLINT_ON_SURFACE, GLINT_INSIDE,
                                    GLINT_OUTSIDE, GLINT_ON_SURFACE, GLINT_OUTSIDE}));
}

// Lists: as many as are counted, nearest first, in and out in turns.
TEST_F(LibraryCrossings, ListsGoInAndOut) {
    const Closed mesh = bumpy();
    addClosed(mesh, 0);
    commit();
    Random random(21);
    RayList through;
    for (int i = 0; i < 3000; ++i) {
        const D3 from = 8.0 * random.direction(), to = random.direction();
        through.add(from, to - from);
    }
    const glint_rays rays = through.rays();
    const std::vector<uint32_t> crossings = counts(rays);
    Listed all = list(rays);
    ASSERT_GT(all.t.size(), 5000u);
    size_t turns = 0;
    for (size_t i = 0; i < crossings.size(); ++i) {
        ASSERT_EQ(all.offsets[i + 1] - all.offsets[i], crossings[i]);
        for (uint64_t k = all.offsets[i]; k < all.offsets[i + 1]; ++k) {
            if (k > all.offsets[i]) {
                EXPECT_LE(all.t[k - 1], all.t[k]);
            }
            const double side = glm::dot(all.normal[k], through.directions[i]);
            turns += (side > 0) != ((k - all.offsets[i]) % 2 == 1);
        }
    }
    EXPECT_EQ(turns, 0u);
    GLINT_INIT(glint_hits, hits);
    hits.t = outOf(all.t);
    hits.t.count = 7;
    uint64_t total = 0;
    EXPECT_EQ(glint_query_all(scene(), &rays, nullptr, &hits, &total, nullptr), GLINT_ERROR_CAPACITY);
    EXPECT_EQ(total, all.t.size());
}

// Rays that end at corners of triangles: rounding decides whether they are met, and lists are as long as they
// were counted. A certain crossing whose t was rounded to more than the ray's end was missing from its list,
// and what stood in its place was memory that nobody had written.
TEST_F(LibraryCrossings, ListsEndAtCorners) {
    Random random(31);
    std::vector<D3> vertices(3 * 60);
    for (D3& vertex : vertices) vertex = random.direction();
    addMesh<D3>(vertices);
    commit();
    RayList towards;
    for (size_t i = 0; i < (kOnDevice ? 20'000 : 500); ++i) {
        const D3 from = 3.0 * random.direction();
        towards.add(from, vertices[i % vertices.size()] - from);
    }
    glint_rays rays = towards.rays();
    const std::vector<double> ends(towards.size(), 1);
    rays.t_max = viewOf(ends);
    const Listed all = list(rays);
    ASSERT_GT(all.t.size(), towards.size());
    size_t wrong = 0;
    for (size_t i = 0; i < towards.size(); ++i) {
        std::set<uint32_t> met;
        for (uint64_t k = all.offsets[i]; k < all.offsets[i + 1]; ++k)
            wrong += !(all.t[k] > 0 && all.t[k] <= 1) || all.geometry[k] != 0 ||
                     all.primitive[k] >= vertices.size() / 3 || !met.insert(all.primitive[k]).second;
    }
    EXPECT_EQ(wrong, 0u);
}

// Square sheets of random sizes over each other: a ray along z crosses those that reach as far as it passes
// beside their common corner, each once, along their diagonals too, where every triangle is looked at
// closely. More leaves than a ray has room for wait, and with thousands of them it runs out of trips.
TEST_F(LibraryCrossings, ManySheets) {
    for (const uint32_t sheets : {3u, 40u, 300u, kOnDevice ? 9000u : 1000u}) {
        useScene(nullptr);
        Random random(sheets);
        std::vector<double> sizes(sheets);
        std::vector<D3> vertices;
        std::vector<U3> corners;
        for (uint32_t k = 0; k < sheets; ++k) {
            const double size = sizes[k] = 0.1 + random.uniform(), z = k;
            for (const D3& v : {D3{0, 0, z}, D3{size, 0, z}, D3{size, size, z}, D3{0, size, z}})
                vertices.push_back(v);
            corners.push_back({4 * k, 4 * k + 1, 4 * k + 2});
            corners.push_back({4 * k, 4 * k + 2, 4 * k + 3});
        }
        addMesh<D3>(vertices, corners);
        commit();
        RayList along;
        std::vector<double> ends;
        std::vector<uint32_t> expected;
        for (size_t i = 0; i < 400; ++i) {
            const double x = 1e-3 + random.uniform(), y = i % 3 == 0 ? x : 1e-3 + random.uniform();
            const double end = (i % 2 == 0 ? 1.0 : random.uniform()) * sheets + 0.75;
            along.add({x, y, -1}, {0, 0, 1});
            ends.push_back(end);
            expected.push_back(0);
            for (uint32_t k = 0; k < sheets; ++k)
                expected.back() += sizes[k] > std::max(x, y) && k + 1 <= end;
        }
        glint_rays rays = along.rays();
        rays.t_max = viewOf(ends);
        EXPECT_EQ(counts(rays), expected) << sheets;
    }
}

// Triangles that stand in the tree more than once are counted once.
TEST_F(LibraryCrossings, SplitTrianglesCountOnce) {
    load("arcade.json");
    const RayList rays = raysInto(scene(), 1000, 31);
    const Listed all = list(rays.rays());
    size_t twice = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
        std::set<std::pair<uint32_t, uint32_t>> seen;
        for (uint64_t k = all.offsets[i]; k < all.offsets[i + 1]; ++k)
            twice += !seen.emplace(all.geometry[k], all.primitive[k]).second;
    }
    EXPECT_GT(all.t.size(), 1000u);
    EXPECT_EQ(twice, 0u);
}

}  // namespace
}  // namespace glint::library::test
