// Scenes that change: after the commit they answer as a new scene does.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <random>
#include <thread>

#include "closed_meshes.h"

namespace glint::library::test {
namespace {

constexpr uint32_t kSide = 48;  // squares along a side of the sheet

class LibraryChanges : public LibraryTest {
  protected:
    // A sheet in waves.
    static std::vector<D3> sheet(double phase, double height = 0.3) {
        std::vector<D3> vertices;
        for (uint32_t y = 0; y <= kSide; ++y)
            for (uint32_t x = 0; x <= kSide; ++x) {
                const double u = x / double(kSide), v = y / double(kSide);
                vertices.push_back(
                    {4 * u, 4 * v, height * std::sin(7 * u + phase) * std::cos(5 * v - 2 * phase)});
            }
        return vertices;
    }
    static std::array<double, 12> placed(double x, double y, double z, double turn = 0) {
        return {std::cos(turn), -std::sin(turn), 0, x, std::sin(turn), std::cos(turn), 0, y, 0, 0, 1, z};
    }

    // Rays from above a sheet, moved by `by`.
    Answers ask(const D3& by = {0, 0, 0}) {
        constexpr size_t kRays = 3000;
        static const auto rays = [] {
            Random random(3);
            RayList made;
            for (size_t i = 0; i < kRays; ++i) {
                const D3 from = {8 * random.uniform() - 2, 8 * random.uniform() - 2, 6};
                const D3 to = {9 * random.uniform() - 2, 5 * random.uniform(), random.uniform() - 0.5};
                made.add(from, to - from);
            }
            return made;
        }();
        RayList moved = rays;
        for (D3& origin : moved.origins) origin += by;
        return answers(moved.rays());
    }
    void setVertices(uint32_t mesh, const std::vector<D3>& vertices) {
        const glint_view view = viewOf(vertices);
        ASSERT_OK(glint_scene_set_vertices(scene(), mesh, &view));
    }

    const std::vector<U3> corners_ = gridCorners(kSide);

    // fill(scene) makes the scene from nothing, as it is now.
    template <class Fill>
    void expectAsAnew(const Fill& fill, uint32_t expectedRefits, const D3& by = {0, 0, 0}) {
        EXPECT_EQ(info().refits, expectedRefits);
        const Answers found = ask(by);
        glint_scene* const changed = scene();
        glint_scene_retain(changed);
        useScene(nullptr);
        fill(scene());
        commit();
        const Answers expected = ask(by);
        useScene(changed);
        size_t hits = 0;
        for (const uint8_t one : expected.any) hits += one;
        EXPECT_GT(hits, 500u);
        EXPECT_EQ(found.closest.t, expected.closest.t);
        EXPECT_TRUE(found == expected);
    }
};

TEST_F(LibraryChanges, VerticesAreFollowedBitForBit) {
    addMesh(sheet(0), corners_);
    commit();
    for (uint32_t step = 1; step <= 5; ++step) {
        const std::vector<D3> vertices = sheet(0.2 * step);
        setVertices(0, vertices);
        commit();
        expectAsAnew([&](glint_scene* to) { test::addMesh(to, vertices, corners_); }, step);
    }
}

// A BVH that no longer fits is rebuilt, and refitted from then on: the triangles change places.
TEST_F(LibraryChanges, ATreeThatFitsNoMoreIsBuiltAnew) {
    std::vector<D3> vertices, torn;
    const std::vector<D3> places = sheet(0);
    std::vector<U3> corners = corners_;
    for (const U3& c : corners) vertices.insert(vertices.end(), {places[c.x], places[c.y], places[c.z]});
    std::shuffle(corners.begin(), corners.end(), std::mt19937(1));
    for (const U3& c : corners) torn.insert(torn.end(), {places[c.x], places[c.y], places[c.z]});
    for (uint32_t i = 0; i < corners.size(); ++i) corners[i] = {3 * i, 3 * i + 1, 3 * i + 2};
    addMesh(vertices, corners);
    commit();
    setVertices(0, vertices);
    commit();
    EXPECT_EQ(info().refits, 1u);
    setVertices(0, torn);
    commit();
    expectAsAnew([&](glint_scene* to) { test::addMesh(to, torn, corners); }, 0);
    for (uint32_t step = 1; step <= 3; ++step) {
        for (D3& vertex : torn) vertex[2] += 0.01;
        setVertices(0, torn);
        commit();
        expectAsAnew([&](glint_scene* to) { test::addMesh(to, torn, corners); }, step);
    }
}

// Two instances of 4,608 triangles share them; a third object is too small for that and is baked. A plane and
// a sphere stand by.
TEST_F(LibraryChanges, InstancesAreFollowedBitForBit) {
    const std::vector<D3> small = {{0, 0, 1}, {1, 0, 1}, {0, 1, 1.2}};
    const auto fill = [&](glint_scene* to, double at) {
        test::addMesh(to, sheet(0), corners_);
        ASSERT_OK(glint_scene_add_instance(to, 0, placed(1, 0.5 * at, 1 + at, 0.3).data(), nullptr));
        test::addMesh(to, small, {{0, 1, 2}});
        ASSERT_OK(glint_scene_set_transform(to, 2, placed(at, 0, 0, at).data()));
        addJson(to, R"({"materials": {"m": {}}, "camera": {"eye": [0, 0, 20],
            "target": [0, 0, 0]}, "objects": [
            {"type": "plane", "point": [0, 0, -1], "normal": [0, 0, 1], "material": "m"},
            {"type": "sphere", "center": [4, 4, 1], "radius": 0.5, "material": "m"}]})");
    };
    fill(scene(), 0);
    commit();
    ASSERT_EQ(info().triangles, 2 * corners_.size() + 1);
    for (uint32_t step = 1; step <= 4; ++step) {
        const double at = 0.1 * step;
        ASSERT_OK(glint_scene_set_transform(scene(), 1, placed(1, 0.5 * at, 1 + at, 0.3).data()));
        ASSERT_OK(glint_scene_set_transform(scene(), 2, placed(at, 0, 0, at).data()));
        commit();
        expectAsAnew([&](glint_scene* to) { fill(to, at); }, step);
    }
}

// Changes that no refit can follow rebuild the BVH: a sphere moves, a mesh changes that instances share.
TEST_F(LibraryChanges, WhateverElseChangesIsBuiltAnew) {
    const auto fill = [&](glint_scene* to, double at) {
        test::addMesh(to, sheet(at), corners_);
        ASSERT_OK(glint_scene_add_instance(to, 0, placed(1, 0, 1).data(), nullptr));
        addSpheres(to, {{2, 2, 2}}, {0.5});
        ASSERT_OK(glint_scene_set_transform(to, 2, placed(at, at, 0).data()));
    };
    fill(scene(), 0);
    commit();
    setVertices(0, sheet(0.2));
    ASSERT_OK(glint_scene_set_transform(scene(), 2, placed(0.2, 0.2, 0).data()));
    commit();
    expectAsAnew([&](glint_scene* to) { fill(to, 0.2); }, 0);
}

TEST_F(LibraryChanges, TrianglesWithoutAreaComeAndGo) {
    addMesh(sheet(0), corners_);
    commit();
    std::vector<D3> pinched = sheet(0.1);
    pinched[20] = pinched[21];
    for (const auto& [vertices, warnings] : {std::pair(pinched, 1u), std::pair(sheet(0.2), 0u)}) {
        setVertices(0, vertices);
        commit();
        expectAsAnew([&, &given = vertices](glint_scene* to) { test::addMesh(to, given, corners_); }, 0);
        EXPECT_EQ(info().warnings, warnings);
    }
}

// Triangles without area stay left out while the others move.
TEST_F(LibraryChanges, TrianglesLeftOutAreNoHindrance) {
    std::vector<D3> pinched = sheet(0);
    pinched[20] = pinched[21];
    addMesh(pinched, corners_);
    commit();
    for (D3& vertex : pinched) vertex[2] *= 1.25;
    setVertices(0, pinched);
    commit();
    expectAsAnew([&](glint_scene* to) { test::addMesh(to, pinched, corners_); }, 1);
}

TEST_F(LibraryChanges, BadVerticesAreRefusedAndTheSceneStays) {
    addMesh(sheet(0), corners_);
    commit();
    const Answers before = ask();
    std::vector<D3> vertices = sheet(1);
    vertices[7][1] = std::numeric_limits<double>::quiet_NaN();
    glint_view view = viewOf(vertices);
    EXPECT_EQ(glint_scene_set_vertices(scene(), 0, &view), GLINT_ERROR_ARGUMENT);
    EXPECT_STREQ(glint_last_error(), "glint_scene_set_vertices: vertex 7 is not finite");
    vertices[7][1] = std::numeric_limits<double>::infinity();
    EXPECT_EQ(glint_scene_set_vertices(scene(), 0, &view), GLINT_ERROR_ARGUMENT);
    vertices.pop_back();
    view = viewOf(vertices);
    EXPECT_EQ(glint_scene_set_vertices(scene(), 0, &view), GLINT_ERROR_ARGUMENT);
    EXPECT_STREQ(glint_last_error(),
                 "glint_scene_set_vertices: the mesh has 2401 vertices, but 2400 were given");
    EXPECT_TRUE(ask() == before);
    commit();
    EXPECT_TRUE(ask() == before);
    // Beyond what a scene may have: found by the commit, which leaves what queries see.
    vertices = sheet(1);
    vertices[7][1] = 1e300;
    setVertices(0, vertices);
    EXPECT_EQ(glint_scene_commit(scene()), GLINT_ERROR_SCENE);
    EXPECT_TRUE(ask() == before);
}

// Coordinates start from elsewhere now and then: the trees stay, and no digits are lost.
TEST_F(LibraryChanges, AMeshThatMovesFarIsNeverBuiltAnew) {
    const std::vector<D3> first = sheet(0);
    addMesh(first, corners_);
    commit();
    D3 by = {0, 0, 0};
    for (uint32_t step = 1; step <= 60; ++step) {
        // At a run; then a thousand times as far at once; and back.
        by = step < 40 ? D3{1.5 * step, -0.7 * step, 0.3 * step}
                       : (step < 50 ? D3{1e6, 1e3 * step, 0} : D3{double(60 - step), 0, 0});
        std::vector<D3> vertices = first;
        for (D3& vertex : vertices) vertex += by;
        setVertices(0, vertices);
        commit();
        if (step % 6 == 0 || step == 40 || step == 50)
            expectAsAnew([&](glint_scene* to) { test::addMesh(to, vertices, corners_); }, step, by);
    }
}

// Instances, planes, lights and triangles without area follow a moved origin, too; a sphere does not. (They
// are so far away that the text's camera, which stays, sees none of them.)
TEST_F(LibraryChanges, WhateverFollowsTheOriginStays) {
    constexpr double kFar = 1e5;
    const std::string beside = R"({"lights": [{"type": "point", "position": [1, 2, 9]}],
        "objects": [{"type": "plane", "point": [0, 0, -3], "normal": [0, 0, 1]}]})";
    const auto place = [&](glint_scene* to, double at) {
        ASSERT_OK(glint_scene_set_transform(to, 0, placed(at, 0, 0).data()));
        ASSERT_OK(glint_scene_set_transform(to, 1, placed(at + 0.5, 0, 1).data()));
    };
    const auto fill = [&](glint_scene* to, double at, bool ball) {
        std::vector<D3> vertices = sheet(0);
        vertices[20] = vertices[21];
        test::addMesh(to, vertices, corners_);
        ASSERT_OK(glint_scene_add_instance(to, 0, placed(0, 0, 0).data(), nullptr));
        place(to, at);
        addJson(to, beside);
        if (!ball) return;
        addSpheres(to, {{kFar + 2, 2, 2}}, {0.5});
    };
    for (const bool ball : {false, true}) {
        useScene(nullptr);
        fill(scene(), kFar, ball);
        commit();
        for (uint32_t step = 1; step <= 3; ++step) {
            const double at = kFar * (1 + step);
            place(scene(), at);
            commit();
            expectAsAnew([&](glint_scene* to) { fill(to, at, ball); }, ball ? 0 : step, {at, 0, 0});
        }
    }
}

// Each call has its answers from one version, and never from one before that of the thread's last call.
TEST_F(LibraryChanges, EightThreadsAskWhileOneChanges) {
    constexpr uint32_t kVersions = 60;
    constexpr double kStep = 1;
    const auto flat = [](uint32_t version) {
        std::vector<D3> vertices = sheet(0, 0);
        for (D3& vertex : vertices) vertex[2] = kStep * version;
        return vertices;
    };
    addMesh(flat(0), corners_);
    commit();
    const glint_scene* const asked = scene();
    std::atomic<bool> done = false;
    std::vector<std::string> wrong(8);
    std::atomic<uint32_t> calls = 0;
    {
        std::vector<std::jthread> threads;
        for (size_t thread = 0; thread < wrong.size(); ++thread) {
            threads.emplace_back([&, thread] {
                std::vector<D3> origins, down = {{0, 0, -1}};
                for (int i = 0; i < 200; ++i)
                    origins.push_back({0.01 + 0.019 * i, 0.5 + 0.4 * double(thread), 100});
                std::vector<double> t(origins.size());
                glint_rays rays = raysFrom(origins, down);
                GLINT_INIT(glint_hits, hits);
                hits.t = outOf(t);
                double last = 100 / kStep;
                while (!done) {
                    if (glint_query_closest(asked, &rays, &hits, nullptr) != GLINT_OK)
                        wrong[thread] = glint_last_error();
                    const double steps = std::round(t[0] / kStep);
                    for (const double one : t)
                        if (!(std::abs(one - kStep * steps) < 1e-3))
                            wrong[thread] = "answers of two versions in one call";
                    if (!(steps <= last)) wrong[thread] = "an older version than before";
                    last = steps;
                    ++calls;
                    calls.notify_one();
                }
            });
        }
        for (uint32_t version = 1; version <= kVersions; ++version) {
            const std::vector<D3> vertices = flat(version);
            const glint_view view = viewOf(vertices);
            EXPECT_OK(glint_scene_set_vertices(scene(), 0, &view));
            EXPECT_OK(glint_scene_commit(scene()));
            for (const uint32_t before = calls; calls < before + 2;) calls.wait(calls);
        }
        done = true;
    }
    for (const std::string& what : wrong) EXPECT_EQ(what, "");
    EXPECT_EQ(info().refits, kVersions);
}

}  // namespace
}  // namespace glint::library::test
