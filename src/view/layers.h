// What the window shows of a picture, as colours for the screen.
#pragma once

#include <optional>
#include <string>

#include "core/enum_names.h"
#include "trace/picture.h"
#include "view/canvas.h"

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

// exposure: in stops, of Color alone; 0 gives the bytes that a PNG of the picture holds.
Canvas colorize(const Picture& picture, ViewLayer layer, double exposure);

}  // namespace glint::view
