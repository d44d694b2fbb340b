#include "app/option_values.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string_view>

#include "core/enum_names.h"
#include "core/error.h"
#include "core/text_file.h"
#include "farm/unit.h"
#include "report/plan.h"
#include "scene/limits.h"
#include "scene/sampling.h"
#include "shared/dispatch.h"

namespace glint::app {

namespace {

// Numbers too large for 64 bits become the largest one, so that range checks see them.
std::optional<int64_t> wholeNumber(std::string_view text) {
    int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || end != text.data() + text.size()) return std::nullopt;
    if (error == std::errc::result_out_of_range) {
        value =
            text.front() == '-' ? std::numeric_limits<int64_t>::min() : std::numeric_limits<int64_t>::max();
    } else if (error != std::errc()) {
        return std::nullopt;
    }
    return value;
}

std::optional<double> number(const std::string& text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (text.empty() || error != std::errc() || end != text.data() + text.size() || !std::isfinite(value))
        return std::nullopt;
    return value;
}

// Exactly `count` whole numbers, clamped to the range of int; nothing if the text has another form.
std::vector<int> wholeNumbers(const std::string& text, char separator, size_t count) {
    std::vector<int> values;
    for (const std::string& part : split(text, separator)) {
        const auto value = wholeNumber(part);
        if (!value) return {};
        values.push_back(static_cast<int>(
            std::clamp<int64_t>(*value, std::numeric_limits<int>::min(), std::numeric_limits<int>::max())));
    }
    return values.size() == count ? values : std::vector<int>{};
}

// The parts of "a, b", each of which must be one of `known`; messages show lists of up to kShown in full.
constexpr size_t kShown = 16;
std::vector<std::string> namesIn(const std::string& text, const std::string& what,
                                 std::span<const std::string_view> known) {
    std::vector<std::string> names;
    for (const std::string& part : split(text, ',')) {
        const std::string name = trimmed(part);
        if (std::find(known.begin(), known.end(), name) == known.end()) {
            std::string hint = suggestion(name, known, "known");
            if (!hint.starts_with("did") && known.size() <= kShown) hint = "known: " + joinNames(known);
            throw Error(ErrorKind::Argument, "unknown " + what + " " + quoted(name) + " (" + hint + ")");
        }
        names.push_back(name);
    }
    return names;
}

}  // namespace

void refuse(const std::string& wanted, const std::string& text) {
    throw Error(ErrorKind::Argument, "expected " + wanted + ", got " + quoted(text));
}

int parseWhole(const std::string& text, int least, int greatest) {
    const auto value = wholeNumber(text);
    if (!value || *value < least || *value > greatest) {
        refuse("a whole number from " + std::to_string(least) + " to " + std::to_string(greatest), text);
    }
    return static_cast<int>(*value);
}

Size parseSize(const std::string& text) {
    const auto v = wholeNumbers(text, 'x', 2);
    if (v.empty()) refuse("WxH such as 640x480", text);
    if (std::min(v[0], v[1]) < 1 || std::max(v[0], v[1]) > kMaxImageSize) {
        refuse("a width and a height from 1 to " + std::to_string(kMaxImageSize), text);
    }
    return {v[0], v[1]};
}

PartChoice parsePart(const std::string& text) {
    const auto v = wholeNumbers(text, '/', 2);
    if (v.empty() || v[1] < 1 || v[1] > farm::kMostParts || v[0] < 1 || v[0] > v[1])
        refuse("K/N with 1 <= K <= N, such as 3/8", text);
    return {v[0], v[1]};
}

FrameRange parseFrames(const std::string& text) {
    constexpr int kMostFrames = 10'000'000;
    auto v = wholeNumbers(text, ':', 2);
    if (v.empty()) v = wholeNumbers(text, ':', 1);
    if (v.empty() || v.front() < 0 || v.back() < v.front() || v.back() > kMostFrames)
        refuse("A:B with 0 <= A <= B, such as 0:240, or one number", text);
    return {v.front(), v.back()};
}

Region parseCrop(const std::string& text) {
    const auto v = wholeNumbers(text, ',', 4);
    if (v.empty()) refuse("x0,y0,x1,y1 such as 0,0,64,64", text);
    if (v[0] < 0 || v[1] < 0 || v[2] <= v[0] || v[3] <= v[1]) {
        refuse("x0,y0,x1,y1 with 0 <= x0 < x1 and 0 <= y0 < y1", text);
    }
    return {v[0], v[1], v[2], v[3]};
}

std::pair<int, int> parsePixel(const std::string& text) {
    const auto v = wholeNumbers(text, ',', 2);
    if (v.empty()) refuse("x,y such as 320,240", text);
    // So that the message about the picture's size has the numbers that were given.
    if (std::max(std::abs(int64_t{v[0]}), std::abs(int64_t{v[1]})) > kMaxImageSize)
        refuse("x,y below " + std::to_string(kMaxImageSize), text);
    return {v[0], v[1]};
}

std::vector<Aov> parseAovs(const std::string& text) {
    std::vector<Aov> aovs;
    for (const std::string& name : namesIn(text, "layer", kEnumNames<Aov>)) {
        const Aov aov = named<Aov>(name).value();
        if (std::find(aovs.begin(), aovs.end(), aov) != aovs.end())
            throw Error(ErrorKind::Argument, "the layer " + quoted(name) + " is given twice");
        aovs.push_back(aov);
    }
    return aovs;
}

std::vector<std::string> parseFamilies(const std::string& text) {
    const std::vector<std::string>& starts = report::familyStarts();
    return namesIn(text, "setting", std::vector<std::string_view>(starts.begin(), starts.end()));
}

SceneFeatures parseFeatures(const std::string& text) {
    static const std::vector<std::string_view> known = {
#define GLINT_NAME(ID, NAME, field) #field,
        GLINT_FEATURES(GLINT_NAME)
#undef GLINT_NAME
    };
    SceneFeatures features;
    for (const std::string& name : namesIn(text, "feature", known)) {
#define GLINT_SET(ID, NAME, field) \
    if (name == #field) features.field = true;
        GLINT_FEATURES(GLINT_SET)
#undef GLINT_SET
    }
    return features;
}

double parseNotNegative(const std::string& text) {
    const auto value = number(text);
    if (!value || *value < 0) refuse("a number from 0 up", text);
    return *value;
}

double parseReal(const std::string& text, double least, double greatest) {
    const auto value = number(text);
    if (!value || *value < least || *value > greatest)
        refuse("a number from " + describe(least) + " to " + describe(greatest), text);
    return *value;
}

double parsePositive(const std::string& text) {
    const auto value = number(text);
    if (!value || !(*value > 0)) refuse("a number above 0", text);
    return *value;
}

const std::string& parseName(const std::string& text) {
    if (text.empty()) throw Error(ErrorKind::Argument, "the name is empty");
    return text;
}

FilterChoice parseFilter(const std::string& text) {
    const std::vector<std::string> parts = split(text, ',');
    const auto filter = named<Filter>(parts[0]);
    FilterChoice choice;
    if (filter) choice.filter = *filter;
    if (parts.size() == 2) choice.radius = number(parts[1]);
    const bool badRadius = parts.size() == 2 && !(choice.radius && *choice.radius >= kMinFilterRadius &&
                                                  *choice.radius <= kMaxFilterRadius);
    if (!filter || parts.size() > 2 || badRadius)
        refuse(choices<Filter>() + ", and perhaps a radius from 0.01 to 8 pixels as in tent,1.5", text);
    return choice;
}

AdaptiveSampling parseAdaptive(const std::string& text) {
    const std::vector<std::string> parts = split(text, ',');
    AdaptiveSampling adaptive;
    const auto most = wholeNumber(parts[0]);
    const std::optional<double> threshold =
        parts.size() == 2 ? number(parts[1]) : std::optional(adaptive.threshold);
    if (!most || *most < 1 || *most > kMaxSamplesPerPixel || parts.size() > 2 || !threshold ||
        !(*threshold > 0 && *threshold <= 1))
        refuse("the most samples of a pixel, from 1 to " + std::to_string(kMaxSamplesPerPixel) +
                   ", and perhaps a threshold above 0, at most 1, as in 64,0.05",
               text);
    adaptive.maxSamples = static_cast<int>(*most);
    adaptive.threshold = *threshold;
    return adaptive;
}

uint32_t parseSeed(const std::string& text) {
    const auto value = wholeNumber(text);
    if (!value || *value < 0 || *value > std::numeric_limits<uint32_t>::max())
        refuse("a whole number from 0 to 4294967295", text);
    return static_cast<uint32_t>(*value);
}

}  // namespace glint::app
