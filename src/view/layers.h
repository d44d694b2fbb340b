// What the window shows of a picture, as colours for the screen.
#pragma once

#include <optional>
#include <string>

#include "core/enum_names.h"
#include "trace/picture.h"
#include "view/canvas.h"
#include "view/tone.h"

namespace glint::view {

// In the order of the panel and of the key L.
enum class ViewLayer { Color, Depth, Normal, Uv, Object, Primitive, Material, Bounces, Cost };
// Named as `glint render --aov` names them; the help says what their colours mean.
constexpr auto entriesOf(ViewLayer) {
    return std::to_array<EnumEntry<ViewLayer>>(
        {{ViewLayer::Color, "color", "radiance"},
         {ViewLayer::Depth, "depth",
          "distance from the eye: white is nearest, dark grey the farthest twentieth, black nothing"},
         {ViewLayer::Normal, "normal", "outward shading normal: x, y, z as red, green, blue"},
         {ViewLayer::Uv, "uv", "barycentric u, v of a triangle, or texture coordinates, as red, green"},
         {ViewLayer::Object, "object", "one colour for each object"},
         {ViewLayer::Primitive, "primitive", "one colour for each face"},
         {ViewLayer::Material, "material", "one colour for each material"},
         {ViewLayer::Bounces, "bounces", "reflections followed: blue none, red the most in the picture"},
         {ViewLayer::Cost, "cost", "boxes and primitives tested: blue few, red the most in the picture"}});
}
inline constexpr int kViewLayers = static_cast<int>(kEnumNames<ViewLayer>.size());

// Colour needs Picture::color alone; everything else comes from Picture::data.
inline bool needsData(ViewLayer layer) {
    return layer != ViewLayer::Color;
}

// What a layer's colours span: one range for all of a picture, whatever parts it is shown in.
struct LayerRange {
    double lo = 0, hi = 1;
};

// Depth: from the nearest to the farthest but a twentieth; Bounces, Cost: from 0 to the most; else nothing.
LayerRange rangeOf(const Picture& picture, ViewLayer layer);

// Whether colours stand for numbers of a range, which a legend should show.
inline bool hasLegend(ViewLayer layer, const Display& display) {
    return layer == ViewLayer::Bounces || layer == ViewLayer::Cost || layer == ViewLayer::Depth ||
           (layer == ViewLayer::Color && display.toneMap == ToneMap::False);
}

// By default Color gives the bytes that a PNG of the picture holds.
Canvas colorize(const Picture& picture, ViewLayer layer, const Display& display, const LayerRange& range);

}  // namespace glint::view
