// Suggestions for names that were mistyped.
#pragma once

#include <span>
#include <string>
#include <string_view>

namespace glint {

// Insertions, deletions, substitutions and swaps of neighbours that lead from a to b, upper and lower case
// being equal: the optimal string alignment distance (Damerau, CACM 7(3), 1964).
size_t editDistance(std::string_view a, std::string_view b);

// `did you mean "radius"?` if one of `names` is near `name`, else `WORD: a, b, c` (at most eight, then
// "..."), else empty if there are no names.
std::string suggestion(std::string_view name, std::span<const std::string_view> names, std::string_view word);

// "a, b, c"
std::string joinNames(std::span<const std::string_view> names);

}  // namespace glint
