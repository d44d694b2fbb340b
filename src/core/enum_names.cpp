#include "core/enum_names.h"

#include <algorithm>
#include <cctype>
#include <vector>

namespace glint {

std::string oneOf(std::span<const std::string_view> names, std::string_view quote) {
    std::string text;
    for (size_t i = 0; i < names.size(); ++i) {
        if (i > 0) text += i + 1 < names.size() ? ", " : " or ";
        text.append(quote).append(names[i]).append(quote);
    }
    return text;
}

size_t editDistance(std::string_view a, std::string_view b) {
    const auto same = [](char x, char y) {
        return std::tolower(static_cast<unsigned char>(x)) == std::tolower(static_cast<unsigned char>(y));
    };
    std::vector<std::vector<size_t>> rows(a.size() + 1, std::vector<size_t>(b.size() + 1));
    for (size_t i = 0; i <= a.size(); i++) rows[i][0] = i;
    for (size_t j = 0; j <= b.size(); j++) rows[0][j] = j;
    for (size_t i = 1; i <= a.size(); i++) {
        for (size_t j = 1; j <= b.size(); j++) {
            const size_t substituted = rows[i - 1][j - 1] + (same(a[i - 1], b[j - 1]) ? 0 : 1);
            rows[i][j] = std::min({rows[i - 1][j] + 1, rows[i][j - 1] + 1, substituted});
            if (i > 1 && j > 1 && same(a[i - 1], b[j - 2]) && same(a[i - 2], b[j - 1]))
                rows[i][j] = std::min(rows[i][j], rows[i - 2][j - 2] + 1);
        }
    }
    return rows[a.size()][b.size()];
}

std::string_view nearest(std::string_view name, std::span<const std::string_view> names) {
    constexpr size_t kLongest = 64;  // longer names are not worth the quadratic time
    std::string_view found;
    size_t best = name.size() / 4 + 2;
    for (const std::string_view candidate : names) {
        if (name.size() > kLongest || candidate.size() > kLongest) continue;
        const size_t distance = editDistance(name, candidate);
        if (distance >= std::min(best, candidate.size())) continue;
        best = distance;
        found = candidate;
    }
    return found;
}

std::string suggestion(std::string_view name, std::span<const std::string_view> names,
                       std::string_view word) {
    const std::string_view meant = nearest(name, names);
    if (!meant.empty()) return "did you mean \"" + std::string(meant) + "\"?";
    if (names.empty()) return {};
    constexpr size_t kShown = 16;
    const std::string list = joined(names.first(std::min(names.size(), kShown)));
    return std::string(word) + ": " + list + (names.size() > kShown ? ", ..." : "");
}

}  // namespace glint
