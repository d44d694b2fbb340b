// The values of the command line's options, from text. All throw Error(Usage) with one line that names the
// option, says what it takes and shows what it was given.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/cli.h"
#include "core/enum_names.h"

namespace glint::app {

// A whole number from `least` to `greatest`.
int parseWhole(const std::string& option, const std::string& text, int least, int greatest);

Size parseSize(const std::string& text);                  // "640x480"
Region parseCrop(const std::string& text);                // "x0,y0,x1,y1", not empty
std::pair<int, int> parsePixel(const std::string& text);  // "x,y"
std::vector<Aov> parseAovs(const std::string& text);      // "color, depth": each once
// "depth,offset": words that names of the settings of `glint report` start with.
std::vector<std::string> parseFamilies(const std::string& text);
// By the names that `glint info` prints.
SceneFeatures parseFeatures(const std::string& text);
double parseTolerance(const std::string& text);        // >= 0, finite
double parseMinContribution(const std::string& text);  // the same

FilterChoice parseFilter(const std::string& text);        // "NAME" or "NAME,RADIUS"
AdaptiveSampling parseAdaptive(const std::string& text);  // "MAX" or "MAX,THRESHOLD"
uint32_t parseSeed(const std::string& text);

[[noreturn]] void refuse(const std::string& option, const std::string& wanted, const std::string& text);

// The value of an enumeration by its name.
template <NamedEnum E>
E parseNamed(const std::string& option, const std::string& text) {
    const std::optional<E> found = named<E>(text);
    if (!found) refuse(option, choices<E>(), text);
    return *found;
}

// User's text for a message: in quotes, on one line, not too long.
std::string quoted(const std::string& text);

}  // namespace glint::app
