#include "farm/claims.h"

#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <set>
#include <thread>

#include "support/support.h"

namespace glint::farm::test::claims_test {
namespace {

using namespace std::chrono_literals;
const std::vector<std::string> kNames = {"a", "b", "c"};

class ClaimFolder : public glint::test::FolderTest {};

TEST_F(ClaimFolder, WorkIsSharedOut) {
    Claims one(folder_, 60), two(folder_, 60), three(folder_, 60), four(folder_, 60);
    EXPECT_EQ(one.claim(kNames), "a");
    EXPECT_EQ(two.claim(kNames), "b");
    EXPECT_EQ(three.claim({"b", "c"}), "c");
    EXPECT_EQ(four.claim(kNames), std::nullopt);
    two.release();
    EXPECT_EQ(four.claim(kNames), "b");
    EXPECT_EQ(two.claim(kNames), std::nullopt);
}

// However many try at once, one gets it; of one process too, whose files have names of their own.
TEST_F(ClaimFolder, OneOfManyWins) {
    for (int round = 0; round < 200; ++round) {
        const std::string name = "work" + std::to_string(round);
        std::atomic<int> won{0};
        std::vector<std::thread> threads;
        std::vector<std::unique_ptr<Claims>> claims;
        for (int i = 0; i < 6; ++i) claims.push_back(std::make_unique<Claims>(folder_, 60));
        for (auto& mine : claims)
            threads.emplace_back([&] { won += mine->claim({name}).has_value() ? 1 : 0; });
        for (std::thread& thread : threads) thread.join();
        EXPECT_EQ(won, 1);
    }
}

// A file that nobody changes is the claim of a process that died, wherever its clock stood.
TEST_F(ClaimFolder, LapsedClaimsAreTakenOver) {
    glint::test::writeText(file("a.claim-0"), "elsewhere 17 3\n");
    std::filesystem::last_write_time(file("a.claim-0"),
                                     std::filesystem::file_time_type::clock::now() + 1000h);
    Claims one(folder_, 0.3);
    const auto begin = Claims::Clock::now();
    EXPECT_EQ(one.claim({"a"}), std::nullopt);
    while (!one.claim({"a"}) && Claims::Clock::now() - begin < 20s) std::this_thread::sleep_for(10ms);
    EXPECT_GE(Claims::Clock::now() - begin, 300ms);
    EXPECT_TRUE(names().contains("a.claim-1"));
}

// Who works shows it, for as long as it takes.
TEST_F(ClaimFolder, ClaimsOfTheLivingStay) {
    Claims one(folder_, 2), two(folder_, 2);
    ASSERT_EQ(one.claim({"a"}), "a");
    const auto begin = Claims::Clock::now();
    while (Claims::Clock::now() - begin < 5s) {
        EXPECT_EQ(two.claim({"a"}), std::nullopt);
        std::this_thread::sleep_for(50ms);
    }
}

TEST_F(ClaimFolder, NamesMayBeginAlike) {
    Claims one(folder_, 60), two(folder_, 60);
    EXPECT_EQ(one.claim({"unit-1"}), "unit-1");
    EXPECT_EQ(two.claim({"unit-1", "unit-10"}), "unit-10");
}

TEST_F(ClaimFolder, AFolderThatIsGoneIsAnError) {
    Claims one(folder_ / "no", 60);
    EXPECT_NE(
        glint::test::errorOf(ErrorKind::Failed, [&] { one.claim({"a"}); }).find("cannot read: No such file"),
        std::string::npos);
}

}  // namespace
}  // namespace glint::farm::test::claims_test
