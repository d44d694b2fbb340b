// The animation of a glTF file: translations, rotations and scales of nodes over time.
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "import/gltf_file.h"
#include "scene/keyframes.h"
#include "scene/scene.h"

namespace glint {

// Animated transform of a node. A part that is absent keeps the value of the node's file.
struct GltfPlace {
    std::optional<std::vector<double>> translation, rotation, scale;  // 3, 4 (x y z w) and 3 numbers
    bool operator==(const GltfPlace&) const = default;
};
using GltfPlaces = std::map<size_t, GltfPlace>;  // by node

struct GltfChannel {
    size_t node = 0;
    std::optional<std::vector<double>> GltfPlace::*path = nullptr;
    Keyframes keyframes;
};

// The channels of the file's first animation; none if it has no animation. What is not read (other
// animations, weights of morph targets, channels that are at fault) is warned about.
std::vector<GltfChannel> readGltfChannels(GltfFile& file);

AnimationSpan spanOf(const std::vector<GltfChannel>& channels);

GltfPlaces placesAt(const std::vector<GltfChannel>& channels, double time);

}  // namespace glint
