// Turns images into pixels of the screen: tone maps, layers, stretching, comparison with another image.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/enum_names.h"
#include "core/image.h"
#include "core/image_diff.h"
#include "trace/picture.h"

namespace glint::view {

// Maps linear RGB to the screen, after the exposure and before the sRGB curve.
enum class ToneMap { Linear, Reinhard, Aces, False };
constexpr auto entriesOf(ToneMap) {
    return std::to_array<EnumEntry<ToneMap>>(
        {{ToneMap::Linear, "linear", "as it is, cut off at 1: the bytes of `glint render`"},
         {ToneMap::Reinhard, "reinhard", "luminance L becomes L / (1 + L): nothing is cut off"},
         {ToneMap::Aces, "aces", "a film's curve: dark shadows, soft highlights"},
         {ToneMap::False, "false", "false color: luminance in stops, with a legend; so too the depth"}});
}

// Exposure and tone map of colors; the tone map also chooses grey or heat colors for the depth.
struct Display {
    double exposure = 0;  // stops, of color alone
    ToneMap toneMap = ToneMap::Linear;
    bool operator==(const Display&) const = default;
};

inline constexpr double kMostExposure = 10;  // stops, either way: 2^10 is 1024 times as bright
// The stops that false color shows, about a luminance of 1: blue and darker to red and brighter.
inline constexpr double kFalseStops = 8;

// Rec. 709.
inline double luminance(const glm::dvec3& color) {
    return 0.2126 * color.x + 0.7152 * color.y + 0.0722 * color.z;
}

// Linear, for the sRGB curve. Reinhard: E. Reinhard, M. Stark, P. Shirley, J. Ferwerda, "Photographic Tone
// Reproduction for Digital Images", SIGGRAPH 2002, eq. 3, on the luminance. Aces: K. Narkowicz, "ACES Filmic
// Tone Mapping Curve", 2016, his fit of the ACES RRT and ODT, on each channel.
glm::dvec3 toneMapped(const glm::dvec3& color, ToneMap toneMap);

// Applies exposure and tone map to a linear image of 4 channels, which stays linear.
void applyDisplay(Image& color, const Display& display);

struct Canvas {
    int width = 0, height = 0;
    std::vector<uint32_t> pixels;

    Canvas() = default;
    Canvas(int w, int h, uint32_t color = 0xff000000u)
        : width(w), height(h), pixels(static_cast<size_t>(w) * static_cast<size_t>(h), color) {}
    uint32_t* row(int y) { return pixels.data() + static_cast<size_t>(y) * static_cast<size_t>(width); }
    const uint32_t* row(int y) const {
        return pixels.data() + static_cast<size_t>(y) * static_cast<size_t>(width);
    }
};

constexpr uint32_t packColor(uint32_t r, uint32_t g, uint32_t b) {
    return 0xff000000u | b << 16 | g << 8 | r;
}

// `source` at another size; smooth: bilinear, else each pixel takes the nearest. Black if `source` is empty.
Canvas stretched(Canvas source, int width, int height, bool smooth);

// The canvas as a linear image of 3 channels, so that writing it as PNG gives its bytes again.
Image toImage(const Canvas& canvas);

// In the order of the panel and of the key L.
enum class ViewLayer { Color, Depth, Normal, Uv, Object, Primitive, Material, Bounces, Cost };
// Named as by `glint render --aov`; the help states what their colors mean.
constexpr auto entriesOf(ViewLayer) {
    return std::to_array<EnumEntry<ViewLayer>>(
        {{ViewLayer::Color, "color", "radiance"},
         {ViewLayer::Depth, "depth",
          "distance from the eye: white is nearest, dark grey the farthest twentieth, black nothing"},
         {ViewLayer::Normal, "normal", "outward shading normal: x, y, z as red, green, blue"},
         {ViewLayer::Uv, "uv", "barycentric u, v of a triangle, or texture coordinates, as red, green"},
         {ViewLayer::Object, "object", "one color for each object"},
         {ViewLayer::Primitive, "primitive", "one color for each face"},
         {ViewLayer::Material, "material", "one color for each material"},
         {ViewLayer::Bounces, "bounces", "reflections followed: blue none, red the most in the image"},
         {ViewLayer::Cost, "cost", "boxes and primitives tested: blue few, red the most in the image"}});
}

// The value `step` places after `value` in an enumeration, cyclically.
template <NamedEnum E>
E nextOf(E value, int step = 1) {
    const int all = static_cast<int>(kEnumNames<E>.size());
    return static_cast<E>((static_cast<int>(value) + step + all) % all);
}

// Colour needs Picture::color alone; everything else comes from Picture::data.
inline bool needsData(ViewLayer layer) {
    return layer != ViewLayer::Color;
}

// Color of a layer of numbers, 0 to 1 in its range, as the screen's own numbers: grey for depth, else heat.
glm::dvec3 rangeColor(ViewLayer layer, ToneMap toneMap, double x);

// Range of values that a layer's colors span: one range for all parts of the image.
struct LayerRange {
    double lo = 0, hi = 1;
};

// Depth: from the nearest to the farthest but a twentieth; Bounces, Cost: from 0 to the most; else nothing.
LayerRange rangeOf(const Picture& picture, ViewLayer layer);

// With the default display, Color gives the bytes of a PNG of the image.
Canvas colorize(const Picture& picture, ViewLayer layer, const Display& display, const LayerRange& range);

// The canvas of an image with 1, 3 or 4 linear channels.
Canvas canvasOf(const Image& image, const Display& display);

enum class CompareMode { Off, Wipe, Difference, Flicker };
constexpr auto entriesOf(CompareMode) {
    return std::to_array<EnumEntry<CompareMode>>(
        {{CompareMode::Off, "off", "the other image is not shown"},
         {CompareMode::Wipe, "wipe", "the other one left of a line, which the mouse drags"},
         {CompareMode::Difference, "difference", "|A - B| of the linear colors, brightened"},
         {CompareMode::Flicker, "flicker", "one after the other, twice a second"}});
}

// The other image, and how it is shown.
struct Comparison {
    std::string name;             // "reference", "kept", or a file's name
    std::optional<Image> linear;  // its colors, 3 or 4 channels, linear
    Canvas canvas;                // the layer, if it was no color
    CompareMode mode = CompareMode::Off;
    double wipe = 0.5;  // the line's place, 0..1 of the width
    double gain = 16;   // of the difference
    std::optional<ImageDifference>
        figures;          // as `glint diff` prints them; empty if sizes differ or colors are missing
    std::string fault;    // the reason if `figures` is empty
    uint64_t number = 0;  // of the other image: grows with each new image

    bool any() const { return linear.has_value() || !canvas.pixels.empty(); }
};

// Compares `a` (linear colors; null: not there yet) with the other image, and fills figures or fault.
void measure(Comparison& comparison, const Image* a);

// Puts the other image, which must be there, into `shown`, the window's own. `flash`: of flicker, whether it
// is the other one's turn; `a`: as for measure.
void compose(const Comparison& comparison, const Image* a, const Display& display, bool flash, Canvas& shown);

}  // namespace glint::view
