// One list for each enumeration whose values have names: parsing, help, messages and files all go by it.
//
// The list stands beside the enumeration, where argument-dependent lookup finds it, in the order of the
// values:
//
//     enum class Wrap { Repeat, Clamp };
//     constexpr auto entriesOf(Wrap) {
//         return std::to_array<EnumEntry<Wrap>>({{Wrap::Repeat, "repeat"}, {Wrap::Clamp, "clamp"}});
//     }
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>

namespace glint {

template <typename E>
struct EnumEntry {
    E value;
    std::string_view name;       // on the command line, in scene files, in JSON
    std::string_view help = {};  // a phrase for people; may be empty
};

template <typename E>
concept NamedEnum = std::is_enum_v<E> && requires(E value) {
    entriesOf(value);
};

namespace detail {

// Compilers write `Wrap::Clamp` for a value that has a name in the source, and a cast, `(Wrap)7`, for one
// that has none (D. Goriachev, magic_enum).
template <auto Value>
constexpr bool isEnumerator() {
    constexpr std::string_view kText = __PRETTY_FUNCTION__;
    constexpr std::string_view kBefore = "Value = ";
    return kText[kText.rfind(kBefore) + kBefore.size()] != '(';
}

// Every value has its entry, at its own place.
template <typename E>
constexpr bool isComplete() {
    constexpr auto kEntries = entriesOf(E{});
    for (size_t i = 0; i < kEntries.size(); ++i)
        if (static_cast<size_t>(kEntries[i].value) != i) return false;
    return !isEnumerator<static_cast<E>(kEntries.size())>();
}

}  // namespace detail

template <NamedEnum E>
inline constexpr auto kEnumEntries = [] {
    static_assert(detail::isComplete<E>(), "the list must have every value of the enumeration, in order");
    return entriesOf(E{});
}();

template <NamedEnum E>
inline constexpr auto kEnumNames = [] {
    std::array<std::string_view, kEnumEntries<E>.size()> names;
    for (size_t i = 0; i < names.size(); ++i) names[i] = kEnumEntries<E>[i].name;
    return names;
}();

template <NamedEnum E>
constexpr std::string_view nameOf(E value) {
    return kEnumEntries<E>[static_cast<size_t>(value)].name;
}

template <NamedEnum E>
constexpr std::string_view helpOf(E value) {
    return kEnumEntries<E>[static_cast<size_t>(value)].help;
}

// The value of this name, upper and lower case being different.
template <NamedEnum E>
constexpr std::optional<E> named(std::string_view name) {
    for (const EnumEntry<E>& entry : kEnumEntries<E>)
        if (entry.name == name) return entry.value;
    return std::nullopt;
}

// The texts, with `between` between them.
template <typename Texts>
std::string joined(const Texts& texts, std::string_view between = ", ") {
    std::string all;
    for (const auto& text : texts) all.append(all.empty() ? "" : between).append(text);
    return all;
}

// "auto, bar or none"; with `quote` around each name.
std::string oneOf(std::span<const std::string_view> names, std::string_view quote = "");

template <NamedEnum E>
std::string choices() {
    return oneOf(kEnumNames<E>);
}

template <NamedEnum E>
std::string quotedChoices() {
    return oneOf(kEnumNames<E>, "\"");
}

// "auto|bar|none"
template <NamedEnum E>
std::string alternatives() {
    return joined(kEnumNames<E>, "|");
}

// "auto (a bar on a terminal), bar, none": the names, each with its help.
template <NamedEnum E>
std::string explainedChoices() {
    std::string text;
    for (const EnumEntry<E>& entry : kEnumEntries<E>) {
        text.append(text.empty() ? "" : ", ").append(entry.name);
        if (!entry.help.empty()) text.append(" (").append(entry.help).append(")");
    }
    return text;
}

// ---- names that were mistyped ----

// Insertions, deletions, substitutions and swaps of neighbours that lead from a to b, upper and lower case
// being equal: the optimal string alignment distance (Damerau, CACM 7(3), 1964).
size_t editDistance(std::string_view a, std::string_view b);

// The one of `names` that `name` may mean: it has one typing error, and one more for every four letters.
// Returns an empty name if no name is that near.
std::string_view nearest(std::string_view name, std::span<const std::string_view> names);

// `did you mean "radius"?` for nearest(), else `WORD: a, b, c` (at most 16, then "..."), else empty if there
// are no names.
std::string suggestion(std::string_view name, std::span<const std::string_view> names, std::string_view word);

}  // namespace glint
