// Names, texts and files of text.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "core/enum_names.h"
#include "core/room.h"
#include "core/text_file.h"

namespace glint::test {

// The lists of names; the compiler must report a value that is missing in one.

namespace {

enum class Metal { Gold, Silver, Copper };
constexpr auto entriesOf(Metal) {
    return std::to_array<EnumEntry<Metal>>(
        {{Metal::Gold, "gold", "soft"}, {Metal::Silver, "silver"}, {Metal::Copper, "copper", "red"}});
}

enum class Short { A, B, C };
constexpr auto entriesOf(Short) {
    return std::to_array<EnumEntry<Short>>({{Short::A, "a"}, {Short::B, "b"}});
}

enum class Swapped : uint8_t { A, B };
constexpr auto entriesOf(Swapped) {
    return std::to_array<EnumEntry<Swapped>>({{Swapped::B, "b"}, {Swapped::A, "a"}});
}

static_assert(detail::isComplete<Metal>());
static_assert(!detail::isComplete<Short>(), "C has no name");
static_assert(!detail::isComplete<Swapped>(), "a name would be taken by its place");
static_assert(NamedEnum<Metal> && !NamedEnum<int>);

TEST(EnumNames, ThereAndBack) {
    for (const EnumEntry<Metal>& entry : kEnumEntries<Metal>) {
        EXPECT_EQ(named<Metal>(entry.name), entry.value);
        EXPECT_EQ(nameOf(entry.value), entry.name);
        EXPECT_EQ(helpOf(entry.value), entry.help);
    }
    EXPECT_EQ(named<Metal>("Gold"), std::nullopt);
    EXPECT_EQ(named<Metal>(""), std::nullopt);
}

TEST(EnumNames, InSentences) {
    EXPECT_EQ(choices<Metal>(), "gold, silver or copper");
    EXPECT_EQ(quotedChoices<Metal>(), "\"gold\", \"silver\" or \"copper\"");
    EXPECT_EQ(alternatives<Metal>(), "gold|silver|copper");
    EXPECT_EQ(explainedChoices<Metal>(), "gold (soft), silver, copper (red)");
    const std::string_view two[] = {"a", "b"};
    EXPECT_EQ(oneOf(two), "a or b");
    EXPECT_EQ(oneOf(std::span(two).first(1)), "a");
    EXPECT_EQ(oneOf({}), "");
}

}  // namespace

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
    const std::vector<std::string_view> names(17, "aaaaaa");
    EXPECT_EQ(suggestion("zzzzzz", names, "defined"),
              "defined: " + joined(std::span(names).first(16)) + ", ...");
}

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
    EXPECT_EQ(printable("\ud7ff\xed\xa0\x80"), "\ud7ff???");               // U+D800, a surrogate
    EXPECT_EQ(printable("\U0010ffff\xf4\x90\x80\x80"), "\U0010ffff????");  // U+110000
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

}  // namespace glint::test
