// From radiance to what a screen can show.
#pragma once

#include <glm/glm.hpp>

#include "core/enum_names.h"

namespace glint::view {

// What happens to linear RGB, after the exposure and before the sRGB curve.
enum class ToneMap { Linear, Reinhard, Aces, False };
constexpr auto entriesOf(ToneMap) {
    return std::to_array<EnumEntry<ToneMap>>(
        {{ToneMap::Linear, "linear", "as it is, cut off at 1: the bytes of `glint render`"},
         {ToneMap::Reinhard, "reinhard", "luminance L becomes L / (1 + L): nothing is cut off"},
         {ToneMap::Aces, "aces", "a film's curve: dark shadows, soft highlights"},
         {ToneMap::False, "false", "false colour: luminance in stops, with a legend; so too the depth"}});
}

// Of a picture's colours, or of data that is shown as grey or heat.
struct Display {
    double exposure = 0;  // stops, of colour alone
    ToneMap toneMap = ToneMap::Linear;
    bool operator==(const Display&) const = default;
};

inline constexpr double kMostExposure = 10;  // stops, either way: 2^10 is 1024 times as bright
// The stops that false colour shows, about a luminance of 1: blue and darker to red and brighter.
inline constexpr double kFalseStops = 8;

// Rec. 709.
inline double luminance(const glm::dvec3& color) {
    return 0.2126 * color.x + 0.7152 * color.y + 0.0722 * color.z;
}

// Linear, for the sRGB curve. Reinhard: E. Reinhard, M. Stark, P. Shirley, J. Ferwerda, "Photographic Tone
// Reproduction for Digital Images", SIGGRAPH 2002, eq. 3, on the luminance. Aces: K. Narkowicz, "ACES Filmic
// Tone Mapping Curve", 2016, his fit of the ACES RRT and ODT, on each channel.
glm::dvec3 toneMapped(const glm::dvec3& color, ToneMap toneMap);

// Where false colour puts a luminance, 0 blue to 1 red.
double falseColorOf(double luminance);

// Blue, cyan, green, yellow, red for 0 to 1, as the screen's own numbers, 0..1.
glm::dvec3 heatOf(double x);
// The same as linear numbers, before the sRGB curve.
glm::dvec3 heatLinear(double x);

}  // namespace glint::view
