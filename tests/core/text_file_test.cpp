#include "core/text_file.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/room.h"

namespace glint::text_file_test {

TEST(Printable, LettersOfAllAlphabetsStay) {
    const std::string names = "a\u00e4\u03b1\u4e2d\U0001f600 ~\u00a0";
    EXPECT_EQ(printable(names), names);
}

TEST(Printable, WhatSteersTerminalsDoesNot) {
    EXPECT_EQ(printable("a\nb\x1b[31m\x7f" + std::string(1, '\0')), "a?b?[31m??");
    EXPECT_EQ(printable("\u0080\u009b31m\u009f"), "??31m?");  // U+009B is escape and [ in one
    EXPECT_EQ(printable("\u2028\u202ejpg.obj\u2066\u200f"), "??jpg.obj??");
}

TEST(Printable, WhatIsNotUtf8DoesNot) {
    EXPECT_EQ(printable("\x9b\xff\xc3"), "???");
    EXPECT_EQ(printable("\xe4sch\xe4r"), "?sch?r");
    EXPECT_EQ(printable("\xc0\x8a\xe0\x80\x8a\xf5\x80\x80\x80"), "?????????");  // line ends in more bytes
    EXPECT_EQ(printable("\xe2\x80"), "??");
}

TEST(Printable, LongTextsAreCutInTheMiddle) {
    EXPECT_EQ(printable(std::string(4096, 'x')).size(), 4096u);
    const std::string cut = printable("begin" + std::string(20'000'000, 'x') + "end");
    EXPECT_LT(cut.size(), 5000u);
    EXPECT_TRUE(cut.starts_with("beginx") && cut.ends_with("xend"));
}

TEST(Room, ManySmallPiecesAreNotCopiedForEach) {
    std::vector<int> values;
    int moves = 0;
    for (int i = 0; i < 10'000; ++i) {
        const int* const before = values.data();
        reserveMore(values, 3);
        EXPECT_GE(values.capacity(), values.size() + 3);
        moves += values.data() != before ? 1 : 0;
        values.insert(values.end(), 3, i);
    }
    EXPECT_LT(moves, 40);  // the logarithm of 30,000 to the base 1.5 is 25
}

}  // namespace glint::text_file_test
