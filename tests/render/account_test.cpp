// The account of lost branches, by itself: how far it may be off.
#include "verify/account.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace glint::verify {
namespace {

reference::Losses lossesOf(uint32_t cut, uint32_t depth, uint32_t room, uint32_t crowded) {
    return {.cut = {cut, 0.1 * cut},
            .depth = {depth, 0.2 * depth},
            .room = {room, 0.3 * room},
            .crowdedMedia = crowded};
}

TreeLosses deviceOf(const reference::Losses& lost) {
    TreeLosses device;
    device.cut.add(lost.cut.count, lost.cut.bound);
    device.depth.add(lost.depth.count, lost.depth.bound);
    device.room.add(lost.room.count, lost.room.bound);
    device.crowdedMedia = lost.crowdedMedia;
    return device;
}

TEST(AccountTest, CountsOfPixelsAlikeAreExact) {
    const reference::Losses lost = lossesOf(40, 50, 60, 7);
    Account account(1);
    account.addAlike(lost, 1);
    EXPECT_TRUE(account.agrees(deviceOf(lost), 0));
    const std::function<uint64_t&(TreeLosses&)> counts[] = {
        [](TreeLosses& l) -> uint64_t& { return l.cut.count; },
        [](TreeLosses& l) -> uint64_t& { return l.depth.count; },
        [](TreeLosses& l) -> uint64_t& { return l.room.count; },
        [](TreeLosses& l) -> uint64_t& { return l.crowdedMedia; }};
    for (const auto& count : counts) {
        for (const int step : {-1, 1}) {
            TreeLosses device = deviceOf(lost);
            count(device) += static_cast<uint64_t>(step);
            EXPECT_FALSE(account.agrees(device, 0));
            EXPECT_TRUE(account.agrees(device, 1));
        }
    }
    TreeLosses device = deviceOf(lost);
    device.cut.count -= 3;
    EXPECT_FALSE(account.agrees(device, 1));
}

TEST(AccountTest, BoundsAreRightToA256th) {
    const reference::Losses lost = lossesOf(40, 0, 0, 0);
    Account account(1);
    account.addAlike(lost, 0.5);  // by the sample's weight
    TreeLosses device;
    device.cut.count = 40;
    for (const double sign : {-1.0, 1.0}) {
        device.cut.sum = 2 * (1 + sign * 0x1p-8);
        EXPECT_TRUE(account.agrees(device, 0));
        device.cut.sum = 2 * (1 + sign * 0x1p-7);
        EXPECT_FALSE(account.agrees(device, 0));
    }
}

// None can bring more than the brightest light there is.
TEST(AccountTest, WhatNoBranchLosesIsNothing) {
    Account account(1);
    account.addAlike(lossesOf(0, 9, 0, 0), 1);
    TreeLosses device = deviceOf(lossesOf(0, 9, 0, 0));
    EXPECT_TRUE(account.agrees(device, 5));
    device.room.sum = 0.1;
    EXPECT_FALSE(account.agrees(device, 5));
}

// Of a path of two bounces that met other things, three hits, up to six branches.
TEST(AccountTest, PixelsOfOtherPathsMayLoseWhatTheirHitsCan) {
    Account row(1), account(1);
    row.addOther(2, 1);
    account.add(row);
    TreeLosses device;
    EXPECT_TRUE(account.agrees(device, 0));
    device.depth.add(6, 6);
    device.crowdedMedia = 3;
    EXPECT_TRUE(account.agrees(device, 0));
    device.crowdedMedia = 4;
    EXPECT_FALSE(account.agrees(device, 0));
    device.crowdedMedia = 0;
    device.depth.add(1, 0);
    EXPECT_FALSE(account.agrees(device, 0));
}

// Near the greatest floats the device says infinity, and so do scenes of which no bound is known.
TEST(AccountTest, EndlessBoundsAreNotJudged) {
    Account account(1e38);
    account.addAlike(lossesOf(4, 0, 0, 0), 1);
    TreeLosses device;
    device.cut.count = 4;
    device.cut.sum = std::numeric_limits<double>::infinity();
    EXPECT_TRUE(account.agrees(device, 0));
    device.cut.count = 5;
    EXPECT_FALSE(account.agrees(device, 0));
}

}  // namespace
}  // namespace glint::verify
