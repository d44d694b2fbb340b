// The lists of names, and that the compiler sees what is missing in one.
#include "core/enum_names.h"

#include <gtest/gtest.h>

namespace glint::test {
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
}  // namespace glint::test
