#include "core/near_names.h"

#include <gtest/gtest.h>

#include <vector>

namespace glint::near_names_test {

TEST(NearNames, DistanceCountsEdits) {
    EXPECT_EQ(editDistance("radius", "radius"), 0u);
    EXPECT_EQ(editDistance("radius", "Radius"), 0u);   // case does not count
    EXPECT_EQ(editDistance("raduis", "radius"), 1u);   // a swap
    EXPECT_EQ(editDistance("radus", "radius"), 1u);    // an insertion
    EXPECT_EQ(editDistance("raddius", "radius"), 1u);  // a deletion
    EXPECT_EQ(editDistance("ratius", "radius"), 1u);   // a substitution
    EXPECT_EQ(editDistance("", "abc"), 3u);
    EXPECT_EQ(editDistance("kitten", "sitting"), 3u);  // Levenshtein's classic
}

TEST(NearNames, SuggestsTheNearestOrLists) {
    const std::vector<std::string_view> names = {"center", "radius", "material"};
    EXPECT_EQ(suggestion("raduis", names, "known"), "did you mean \"radius\"?");
    EXPECT_EQ(suggestion("centre", names, "known"), "did you mean \"center\"?");
    EXPECT_EQ(suggestion("zzzzzz", names, "known"), "known: center, radius, material");
    EXPECT_EQ(suggestion("x", {}, "known"), "");
    EXPECT_EQ(suggestion(std::string(100000, 'x'), names, "known"), "known: center, radius, material");
    // A short name is not "near" one that shares nothing with it.
    const std::vector<std::string_view> shortNames = {"a"};
    EXPECT_EQ(suggestion("b", shortNames, "defined"), "defined: a");
}

TEST(NearNames, LongListsAreCut) {
    const std::vector<std::string_view> names = {"aaaaaa", "bbbbbb", "cccccc", "dddddd", "eeeeee",
                                                 "ffffff", "gggggg", "hhhhhh", "iiiiii"};
    EXPECT_EQ(suggestion("zzzzzz", names, "defined"),
              "defined: aaaaaa, bbbbbb, cccccc, dddddd, eeeeee, ffffff, gggggg, hhhhhh, ...");
}

}  // namespace glint::near_names_test
