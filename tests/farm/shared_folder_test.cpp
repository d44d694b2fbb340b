#include "farm/shared_folder.h"

#include <filesystem>
#include <set>
#include <thread>

#include "support.h"

namespace glint::farm::test::shared_folder_test {
namespace {

constexpr int kUnits = 1300;  // in six folders
const UnitHeader kHeader = {{{{"size", "1300x1"}}}, {0, 0, kUnits, 1}, {Aov::Radiance}, kUnits};

// A unit of one pixel.
UnitResult resultOf(int part) {
    UnitResult made;
    made.unit = {0, part, kUnits};
    Block block;
    block.region = {part - 1, 0, part, 1};
    block.color = Image(1, 1, 4, static_cast<float>(part));
    made.blocks.push_back(block);
    return made;
}

class SharedFolders : public glint::test::FolderTest {
  protected:
    // As if others had drawn them; without waiting for the disk each time.
    void place(int first, int last) const {
        for (int part = first; part <= last; ++part) {
            const int group = (part - 1) / SharedFolder::kGroup * SharedFolder::kGroup + 1;
            const std::string name = "units-" + std::to_string(group) + "/unit-" + std::to_string(part);
            std::filesystem::create_directories((folder_ / name).parent_path());
            glint::test::writeBytes(folder_ / (name + ".part"), encodePart(kHeader, resultOf(part)));
        }
    }
    bool there(const char* name) const { return std::filesystem::exists(folder_ / name); }
};

TEST_F(SharedFolders, ManyUnitsAreDrawnOnceAndFoundInOrder) {
    constexpr int kPlaced = 1200;
    place(1, kPlaced);
    std::vector<std::thread> threads;
    std::array<int, 3> drawn{};
    for (int& mine : drawn) {
        threads.emplace_back([&] {
            SharedFolder folder(folder_, kHeader, 60);
            while (true) {
                const auto part = folder.next();
                if (folder.complete()) break;
                if (!part) continue;
                folder.put(resultOf(*part));
                ++mine;
            }
        });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(drawn[0] + drawn[1] + drawn[2], kUnits - kPlaced);
    SharedFolder folder(folder_, kHeader, 60);
    int next = 1;
    folder.forEach([&](const UnitResult& result) { EXPECT_EQ(result.unit.part, next++); });
    EXPECT_EQ(next, kUnits + 1);
}

// So that a look costs no more where there are more units.
TEST_F(SharedFolders, WhatIsDoneOrNotBegunIsNotLookedAt) {
    place(1, SharedFolder::kGroup);
    SharedFolder folder(folder_, kHeader, 60);
    EXPECT_EQ(folder.next(), SharedFolder::kGroup + 1);
    EXPECT_EQ(folder.done(), SharedFolder::kGroup);
    EXPECT_FALSE(there("units-513"));
    std::filesystem::remove_all(folder_ / "units-1");
    place(SharedFolder::kGroup + 1, 2 * SharedFolder::kGroup);
    EXPECT_EQ(folder.next(), 2 * SharedFolder::kGroup + 1);
    EXPECT_EQ(folder.done(), 2 * SharedFolder::kGroup);
    EXPECT_TRUE(there("units-513"));
    EXPECT_FALSE(there("units-769"));
    EXPECT_FALSE(there("units-1"));
}

// What somebody gave up in a folder that the others have left is found at the end.
TEST_F(SharedFolders, NothingIsLeftBehind) {
    SharedFolder folder(folder_, kHeader, 60);
    {
        SharedFolder other(folder_, kHeader, 60);
        ASSERT_EQ(other.next(), 1);
        place(2, kUnits);
        EXPECT_EQ(folder.next(), std::nullopt);
    }
    EXPECT_FALSE(folder.complete());
    EXPECT_EQ(folder.next(), 1);
    folder.put(resultOf(1));
    EXPECT_TRUE(folder.complete());
}

TEST_F(SharedFolders, AThousandUnitsLieInOneFolder) {
    UnitHeader header = kHeader;
    header.parts = SharedFolder::kMostFlat;
    SharedFolder folder(folder_, header, 60);
    UnitResult result = resultOf(1);
    result.unit.parts = header.parts;
    ASSERT_EQ(folder.next(), 1);
    folder.put(result);
    EXPECT_TRUE(there("unit-1.part"));
}

}  // namespace
}  // namespace glint::farm::test::shared_folder_test
