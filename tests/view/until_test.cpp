// A window that takes samples until its error is small enough.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/image_diff.h"
#include "core/image_io.h"
#include "support.h"

namespace glint::view::test::until_test {
class Until : public FolderTest {
  protected:
    const std::vector<std::string> asked_ = {"--error", "0.01", "--within-depth"};
};

// Sums of floats are rounded in another order: a few units of 2^-24.
TEST_F(Until, StopsWhereRenderStops) {
    const Ran ran = view("settle\nprint error\nprint samples\nsave seen.exr\nidle 1\n", asked_);
    std::vector<std::string> options = {"render",   "scene.json", "--size",  size_, "-o",
                                        "like.exr", "-q",         "--stats", "json"};
    options.insert(options.end(), asked_.begin(), asked_.end());
    const Ran like = runGlint(options);
    ASSERT_EQ(like.code, 0) << like.err;
    const std::string samples =
        std::to_string(nlohmann::json::parse(like.out).at("error").at("samplesPerPixel").get<int>());
    EXPECT_EQ(printed(ran, "samples").at(0), samples);
    EXPECT_EQ(printed(ran, "error").at(0).rfind("error <= 0.0", 0), 0u) << ran.out;
    EXPECT_NE(printed(ran, "error").at(0).find(samples + " samples"), std::string::npos) << ran.out;
    EXPECT_LT(compareImages(readImage("seen.exr"), readImage("like.exr"), 0).max, 2e-6);
}

TEST_F(Until, IsSetInThePanelAndBeginsAnew) {
    size_ = "400x800";
    const Ran ran = view(
        "set samples 1\nset depth 0\nwait 3\npress lights\nwait 2\npress materials\nwait 2\npress "
        "tracing\nwait "
        "2\nsettle\nexpect error none\npress until_error\nsettle\nprint "
        "error\nprint "
        "samples\n"
        "press within_depth\nsettle\nprint error\nkey H\norbit 30 0\nkey H\nwait 3\nsettle\nprint error\n"
        "press until_error\nsettle\nexpect error none\nexpect samples 1\n");
    const std::vector<std::string> errors = printed(ran, "error");
    EXPECT_EQ(errors.at(0).rfind("out of reach: with depth 0 ", 0), 0u) << errors[0];
    for (const size_t i : {1u, 2u}) EXPECT_EQ(errors.at(i).rfind("error <= 0.0", 0), 0u) << errors[i];
    // After a movement all begins anew, as if the window had been opened there.
    const Ran there = view("set depth 0\nkey H\norbit 30 0\nsettle\nprint error\n", asked_);
    EXPECT_EQ(printed(there, "error").at(0), errors.at(2));
}

// The same samples, of both replicates.
TEST_F(Until, TheReferenceDrawsTheSameSamples) {
    size_ = "400x800";
    const Ran ran =
        view("settle\npress compare\nwait 3\npress reference\nsettle\nwait 5\nprint figures\n", asked_);
    EXPECT_LT(std::stod(printed(ran, "figures").at(0)), 2e-3);
}

TEST_F(Until, WhatSaysNothingWithoutItIsRefused) {
    for (const std::vector<std::string>& more :
         {std::vector<std::string>{"--confidence", "0.9"}, {"--within-depth"}}) {
        std::vector<std::string> options = {"view", "scene.json"};
        options.insert(options.end(), more.begin(), more.end());
        const Ran ran = runGlint(options);
        EXPECT_EQ(ran.code, 2);
        EXPECT_NE(ran.err.find(more[0] + " requires --error"), std::string::npos) << ran.err;
    }
}

}  // namespace glint::view::test::until_test
