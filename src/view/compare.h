// The picture in the window beside another one: kept earlier, traced by the reference, or read from a file.
#pragma once

#include <optional>
#include <string>

#include "core/enum_names.h"
#include "core/image_diff.h"
#include "view/canvas.h"
#include "view/layers.h"

namespace glint::view {

enum class CompareMode { Off, Wipe, Difference, Flicker };
constexpr auto entriesOf(CompareMode) {
    return std::to_array<EnumEntry<CompareMode>>(
        {{CompareMode::Off, "off", "the other picture is not shown"},
         {CompareMode::Wipe, "wipe", "the other one left of a line, which the mouse drags"},
         {CompareMode::Difference, "difference", "|A - B| of the linear colours, brightened"},
         {CompareMode::Flicker, "flicker", "one after the other, twice a second"}});
}

// Of `B`, the other picture.
struct Comparison {
    std::string name;             // what it is: "reference", "kept", a file's name
    std::optional<Image> linear;  // its colours, 3 or 4 channels, linear
    Canvas canvas;                // what was seen, if it was no colour
    CompareMode mode = CompareMode::Off;
    double wipe = 0.5;  // the line's place, 0..1 of the width
    double gain = 16;   // of the difference
    std::optional<ImageDifference>
        figures;        // as `glint diff` prints them; without: not of one size, or no colours
    std::string fault;  // why there are none

    bool any() const { return linear.has_value() || !canvas.pixels.empty(); }
    int width() const { return linear ? linear->width : canvas.width; }
    int height() const { return linear ? linear->height : canvas.height; }
};

// Compares `a` (linear colours; null: not there yet) with the other picture, and fills figures or fault.
void measure(Comparison& comparison, const Image* a);

// Puts the other picture into `shown`, the window's own. `flash`: of flicker, whether it is the other one's
// turn; `a`: as for measure.
void compose(const Comparison& comparison, const Image* a, const Display& display, bool flash, Canvas& shown);

}  // namespace glint::view
