#include "farm/unit.h"

#include "support.h"

namespace glint::farm::test::identity_test {
const Identity kHere = {{{"glint", "1"}, {"file a.obj", "12"}, {"size", "4x3"}}};

TEST(Identity, NamesTheFirstFactThatDiffers) {
    Identity there = kHere;
    EXPECT_EQ(difference(there, kHere), "");
    there.facts[0].second = "2";
    EXPECT_EQ(difference(there, kHere), "glint is 2 there and 1 here");
    there = kHere;
    there.facts[2].second = "8x6";
    EXPECT_EQ(difference(there, kHere), "size is 8x6 there and 4x3 here");
    there.facts[1].second = "13";
    EXPECT_EQ(difference(there, kHere), "file a.obj has other contents there");
    there = kHere;
    there.facts.erase(there.facts.begin() + 1);
    EXPECT_EQ(difference(there, kHere), "file a.obj is used here alone");
    EXPECT_EQ(difference(kHere, there), "file a.obj is used there alone");
    there = kHere;
    there.facts.emplace_back("cut", "1");
    EXPECT_EQ(difference(there, kHere), "cut is used there alone");
    std::swap(there.facts[0], there.facts[3]);
    there.facts.pop_back();
    EXPECT_NE(difference(there, kHere), "");
}

}  // namespace glint::farm::test::identity_test
