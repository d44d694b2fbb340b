// Batches of rays: the order of answers, and counts.
#include "render/ray_queries.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <tuple>

#include "support.h"

namespace glint::render::test::ray_queries_test {
using glm::dvec3;

constexpr uint32_t kCells = 64;

using Answer = std::tuple<uint32_t, float, float, float>;  // primitive, t, u, v; or crossings

Answer answerOf(const FoundHits& found, size_t i) {
    const bool hit = found.primitive(i) != shared::kNone;
    return hit ? Answer{found.primitive(i), found.t(i), found.u(i), found.v(i)} : Answer{0, 0, 0, 0};
}

// A sheet in waves over [0, kCells] x [0, kCells].
Scene sheet() {
    Scene scene = emptyScene();
    std::vector<dvec3> positions = glint::test::gridMesh(kCells)->positions;
    for (dvec3& p : positions) p.z = 2 * std::sin(0.7 * p.x) * std::cos(0.5 * p.y);
    addMesh(scene, std::move(positions), glint::test::gridMesh(kCells)->corners);
    return scene;
}

// Rays in no order: neighbours have nothing in common.
std::vector<RayInput> raysThrough(size_t count) {
    Random random(5);
    std::vector<RayInput> rays;
    const auto at = [&] {
        return dvec3(0.5 * kCells, 0.5 * kCells, 0) + random.box(1) * dvec3(0.6 * kCells, 0.6 * kCells, 4);
    };
    while (rays.size() < count) rays.push_back(rayTowards(at(), at()));
    return rays;
}

ReadRays readerOf(const std::vector<RayInput>& rays) {
    return [&rays](const RayNumbers& numbers, std::span<RayInput> out) {
        for (size_t i = 0; i < out.size(); ++i) out[i] = rays.at(numbers[i]);
    };
}

class RayQueriesTest : public RenderTest {
  protected:
    static void countSheets(uint32_t sheets);
    static std::vector<Answer> answersOf(RayQueries& queries, RayTask::Query query,
                                         const std::vector<RayInput>& rays) {
        std::vector<Answer> answers(rays.size());
        RayTask task;
        task.query = query;
        task.count = rays.size();
        task.fill = readerOf(rays);
        task.take = [&](const RayNumbers& numbers, const FoundHits& found) {
            for (size_t i = 0; i < found.size(); ++i) {
                const bool isCount = query == RayTask::Query::Count;
                answers.at(numbers[i]) = isCount ? Answer{found[i].crossings, 0, 0, 0} : answerOf(found, i);
            }
        };
        EXPECT_TRUE(queries.run(task));
        return answers;
    }
};

// Sorted rays of more than one window of 2^20, and finished answers after cancellation.
TEST_F(RayQueriesTest, SortedRaysKeepTheirNumbers) {
    const PackedScene scene = packScene(sheet());
    RayQueries queries(device(), scene);
    const std::vector<RayInput> rays = raysThrough(1'100'000);
    const std::vector<Answer> expected = answersOf(queries, RayTask::Query::Closest, rays);
    std::atomic<size_t> given = 0, wrong = 0;
    RayTask task;
    task.count = rays.size();
    task.fill = readerOf(rays);
    task.take = [&](const RayNumbers& numbers, const FoundHits& found) {
        for (size_t i = 0; i < found.size(); ++i)
            wrong += answerOf(found, i) == expected.at(numbers[i]) ? 0 : 1;
        given += found.size();
    };
    EXPECT_TRUE(queries.run(task));
    EXPECT_EQ(given, rays.size());
    EXPECT_EQ(wrong, 0u);
    given = 0;
    double done = 0;
    task.progress = [&](double part) { done = part; };
    task.cancelled = [&] { return done > 0.3; };
    EXPECT_FALSE(queries.run(task));
    EXPECT_GT(given, 0u);
    EXPECT_LT(given, rays.size());
    EXPECT_EQ(static_cast<double>(given) / static_cast<double>(rays.size()), done);
    EXPECT_EQ(wrong, 0u);
}

// Square sheets over each other, as in LibraryCrossings.ManySheets: rays hit edges and run out of trips.
void RayQueriesTest::countSheets(uint32_t sheets) {
    Random random(7);
    Scene scene = emptyScene();
    std::vector<dvec3> positions;
    std::vector<glm::uvec3> corners;
    std::vector<double> sizes;
    for (uint32_t k = 0; k < sheets; ++k) {
        const double size = sizes.emplace_back(0.1 + random.uniform(0, 1)), z = k;
        for (const dvec3& p : {dvec3(0, 0, z), dvec3(size, 0, z), dvec3(size, size, z), dvec3(0, size, z)})
            positions.push_back(p);
        corners.emplace_back(4 * k, 4 * k + 1, 4 * k + 2);
        corners.emplace_back(4 * k, 4 * k + 2, 4 * k + 3);
    }
    addMesh(scene, std::move(positions), std::move(corners));
    const PackedScene packed = packScene(scene);
    std::vector<RayInput> rays;
    std::vector<Answer> expected;
    for (uint32_t i = 0; i < 400; ++i) {
        const double x = 1e-3 + random.uniform(0, 1), y = i % 3 == 0 ? x : 1e-3 + random.uniform(0, 1);
        const double end = (i % 2 == 0 ? 1.0 : random.uniform(0, 1)) * sheets + 0.75;
        const LocalRay ray = localRay({dvec3(x, y, -1), dvec3(0, 0, 1), 0, end}, packed.origin);
        rays.push_back(roundedRay(ray));
        uint32_t crossed = 0;
        for (uint32_t k = 0; k < sheets; ++k) crossed += sizes[k] > std::max(x, y) && k + 1 <= end;
        expected.emplace_back(crossed, 0.0f, 0.0f, 0.0f);
    }
    for (const Traversal traversal : traversals()) {
        SCOPED_TRACE(traversal == Traversal::Lane ? "lane" : "packet");
        RayQueries queries(device(), packed, traversal);
        EXPECT_TRUE(answersOf(queries, RayTask::Query::Count, rays) == expected);
    }
}

TEST_F(RayQueriesTest, CountsManySheets) {
    countSheets(40);    // packets finish
    countSheets(9000);  // and are counted again, ray by ray
}

}  // namespace glint::render::test::ray_queries_test
