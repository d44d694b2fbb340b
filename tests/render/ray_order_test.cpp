// In which order rays go to the device.
#include "render/ray_order.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "support/packed_scene_maker.h"

namespace glint::render {
namespace {

const Space kSpace = {glm::vec3(-1), glm::vec3(1)};

std::vector<RayInput> picture(size_t width, size_t height, float angle) {
    std::vector<RayInput> rays;
    for (size_t y = 0; y < height; ++y)
        for (size_t x = 0; x < width; ++x)
            rays.push_back(
                {.origin = {0, 0, 5},
                 .direction = {angle * (static_cast<float>(x) / static_cast<float>(width) - 0.5f),
                               angle * (0.5f - static_cast<float>(y) / static_cast<float>(width)), -1}});
    return rays;
}

std::vector<RayInput> anyhow(size_t count) {
    glint::test::Random random(3);
    std::vector<RayInput> rays(count);
    for (RayInput& ray : rays) {
        ray.origin = glm::vec3(3.0 * random.direction());
        ray.direction = glm::vec3(random.box(1)) - ray.origin;
    }
    return rays;
}

RayOrder orderOf(const std::vector<RayInput>& rays, bool told = false) {
    RayOrder order = orderRays(
        [&](const RayNumbers& numbers, std::span<RayInput> out) {
            for (size_t i = 0; i < out.size(); ++i) out[i] = rays.at(numbers[i]);
        },
        0, rays.size(), kSpace, told);
    if (order.data() != nullptr) {
        std::vector<uint32_t> sorted(order.data(), order.data() + order.count), all(order.count);
        std::sort(sorted.begin(), sorted.end());
        std::iota(all.begin(), all.end(), 0u);
        EXPECT_EQ(sorted, all);
    }
    return order;
}

// How far rays are from those before them, in the mean.
double step(const std::vector<RayInput>& rays, const RayOrder& order) {
    double sum = 0;
    for (size_t i = 1; i < order.count; ++i) {
        const RayInput &a = rays[order.data() == nullptr ? i - 1 : order.numbers[i - 1]],
                       &b = rays[order.data() == nullptr ? i : order.numbers[i]];
        sum += static_cast<double>(glm::length(glm::normalize(a.direction) - glm::normalize(b.direction)) +
                                   glm::length(a.origin - b.origin));
    }
    return sum / static_cast<double>(order.count);
}

TEST(RayOrder, RowsOfAPictureBecomeBlocks) {
    const RayOrder order = orderOf(picture(100, 83, 0.1f));
    EXPECT_TRUE(order.coherent);
    EXPECT_EQ(order.count, 8000u);  // three rows are left for the next time
    ASSERT_NE(order.data(), nullptr);
    for (uint32_t i = 0; i < 32; ++i) {
        EXPECT_EQ(order.numbers[i], i / 8 * 100 + i % 8);
        EXPECT_EQ(order.numbers[400 + i], 400 + i / 8 * 100 + i % 8);
    }
    EXPECT_EQ(order.numbers[384], 96u);  // the last block of a strip is narrower
    EXPECT_EQ(order.numbers[388], 196u);
}

// Where eight that lie side by side in a block are always eight of a row.
TEST(RayOrder, RowsOfWholeBlocksComeInRuns) {
    EXPECT_EQ(orderOf(picture(100, 83, 0.1f)).run, 1u);
    const RayOrder order = orderOf(picture(104, 83, 0.1f));
    ASSERT_EQ(order.run, 8u);
    for (size_t i = 0; i < order.count; ++i) EXPECT_EQ(order.numbers[i], order.numbers[i / 8 * 8] + i % 8);
    EXPECT_EQ(order.from(3).from(16).run, 8u);
    EXPECT_EQ(order.from(3).from(16)[1], 3u + order.numbers[17]);
    EXPECT_EQ(order.from(3).from(17).run, 1u);
}

TEST(RayOrder, WideStepsAreNoPicturesForPackets) {
    EXPECT_FALSE(orderOf(picture(100, 83, 20)).coherent);
    EXPECT_TRUE(orderOf(picture(100, 83, 20), true).coherent);
}

TEST(RayOrder, CoherentRaysWithoutRowsAndFewRaysStayAsTheyAre) {
    const RayOrder order = orderOf(picture(9000, 1, 0.5f)), few = orderOf(anyhow(1000));
    EXPECT_TRUE(order.coherent);
    EXPECT_EQ(order.data(), nullptr);
    EXPECT_EQ(order.count, 9000u);
    EXPECT_FALSE(few.coherent);
    EXPECT_EQ(few.data(), nullptr);
    EXPECT_EQ(few.count, 1000u);
}

TEST(RayOrder, OthersAreSorted) {
    const std::vector<RayInput> rays = anyhow(20'000);
    const RayOrder order = orderOf(rays);
    EXPECT_FALSE(order.coherent);
    ASSERT_NE(order.data(), nullptr);
    ASSERT_EQ(order.count, rays.size());
    EXPECT_LT(step(rays, order), 0.3 * step(rays, {rays.size(), false, {}}));
    EXPECT_EQ(orderOf(rays, true).data(), nullptr);
}

// All have one origin, and many have the same high digit.
TEST(RayOrder, RaysFromOnePointAreSorted) {
    std::vector<RayInput> rays = anyhow(20'000);
    for (RayInput& ray : rays) {
        ray.direction += ray.origin;
        ray.origin = {0.1f, 0.2f, 0.3f};
    }
    const RayOrder order = orderOf(rays);
    EXPECT_EQ(order.run, 1u);
    ASSERT_NE(order.data(), nullptr);
    EXPECT_LT(step(rays, order), 0.3 * step(rays, {rays.size(), false, {}}));
}

// Not finite, without direction, all alike: any order will do.
TEST(RayOrder, OddRays) {
    std::vector<RayInput> rays = anyhow(5000);
    for (size_t i = 0; i < rays.size(); i += 3) rays[i].direction = glm::vec3(0);
    for (size_t i = 1; i < rays.size(); i += 7) rays[i].origin.x = std::numeric_limits<float>::quiet_NaN();
    for (size_t i = 2; i < rays.size(); i += 5) rays[i].direction.y = std::numeric_limits<float>::infinity();
    EXPECT_EQ(orderOf(rays).count, rays.size());
    EXPECT_EQ(orderOf(std::vector<RayInput>(5000)).count, 5000u);
}

}  // namespace
}  // namespace glint::render
