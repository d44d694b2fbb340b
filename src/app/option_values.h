// The values of options, from text. All throw Error(Argument) with one line that says what is taken and shows
// what was given; OptionTable puts the option's name in front.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/enum_names.h"
#include "pack/packed_scene.h"
#include "scene/scene.h"
#include "trace/picture.h"

namespace glint::app {

struct Size {
    int width = 0, height = 0;
};

// One of several parts of a picture, 1 <= number <= of.
struct PartChoice {
    int number = 1, of = 1;
};

// Frames of an animation, both ends among them: 0 <= first <= last.
struct FrameRange {
    int first = 0, last = 0;
};

struct FilterChoice {
    Filter filter = Filter::Box;
    std::optional<double> radius;  // pixels; empty: the filter's own
};

// A number from `least` to `greatest`.
int parseWhole(const std::string& text, int least, int greatest);
double parseReal(const std::string& text, double least, double greatest);

double parsePositive(const std::string& text);            // finite
double parseNotNegative(const std::string& text);         // finite
Size parseSize(const std::string& text);                  // "640x480"
PartChoice parsePart(const std::string& text);            // "3/8"
FrameRange parseFrames(const std::string& text);          // "0:240" or "17"
Region parseCrop(const std::string& text);                // "x0,y0,x1,y1", not empty
std::pair<int, int> parsePixel(const std::string& text);  // "x,y"
std::vector<Aov> parseAovs(const std::string& text);      // "color, depth": each once
// "depth,offset": words that names of the settings of `glint report` start with.
std::vector<std::string> parseFamilies(const std::string& text);
// By the names that `glint info` prints.
SceneFeatures parseFeatures(const std::string& text);

FilterChoice parseFilter(const std::string& text);        // "NAME" or "NAME,RADIUS"
AdaptiveSampling parseAdaptive(const std::string& text);  // "MAX" or "MAX,THRESHOLD"
uint32_t parseSeed(const std::string& text);

// The text itself, if it is not empty.
const std::string& parseName(const std::string& text);

[[noreturn]] void refuse(const std::string& wanted, const std::string& text);

// The value of an enumeration by its name.
template <NamedEnum E>
E parseNamed(const std::string& text) {
    const std::optional<E> found = named<E>(text);
    if (!found) refuse(choices<E>(), text);
    return *found;
}

}  // namespace glint::app
