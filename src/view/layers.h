// What the window shows of a picture, as colours for the screen.
#pragma once

#include <optional>
#include <string>

#include "trace/picture.h"
#include "view/canvas.h"

namespace glint::view {

// In the order of the panel and of the key L.
enum class ViewLayer { Color, Depth, Normal, Uv, Object, Primitive, Material, Bounces, Cost };
inline constexpr int kViewLayers = 9;

const char* layerName(ViewLayer layer);  // as `glint render --aov` calls it
const char* layerHelp(ViewLayer layer);  // what its colours mean
std::optional<ViewLayer> layerNamed(const std::string& name);

// Colour needs Picture::color alone; everything else comes from Picture::data.
inline bool needsData(ViewLayer layer) {
    return layer != ViewLayer::Color;
}

// exposure: in stops, of Color alone; 0 gives the bytes that a PNG of the picture holds.
Canvas colorize(const Picture& picture, ViewLayer layer, double exposure);

}  // namespace glint::view
