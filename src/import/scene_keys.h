// The keys of each object of a scene file. The parser refuses all others; tests compare
// scenes/scene.schema.json with this list.
#pragma once

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <vector>

#include "import/json_document.h"

namespace glint::keys {

inline constexpr auto kAllTables = std::to_array<KeyTable>({
    {"scene",
     {"$schema", "image", "camera", "cameras", "background", "ambient", "maxDepth", "transmissiveShadows",
      "lights", "materials", "meshes", "objects", "animation"}},
    {"image",
     {"width", "height", "samplesPerPixel", "sampler", "filter", "filterRadius", "seed", "adaptive"}},
    {"image/adaptive", {"maxSamples", "threshold"}},
    {"camera/perspective",
     {"type", "eye", "target", "up", "planeNormal", "fovY", "window", "near", "far", "lensRadius",
      "focusDistance"}},
    {"camera/orthographic",
     {"type", "eye", "target", "up", "planeNormal", "height", "window", "near", "far"}},
    {"light/point", {"type", "position", "intensity", "falloff"}},
    {"light/directional", {"type", "direction", "intensity"}},
    {"light/spot", {"type", "position", "direction", "angle", "penumbra", "intensity", "falloff"}},
    {"material",
     {"ambient", "diffuse", "specular", "shininess", "mirror", "transmission", "ior", "attenuation",
      "attenuationColor", "attenuationDistance", "priority", "alphaCutoff"}},
    {"imageTexture", {"texture", "wrap", "filter", "scale", "offset", "color"}},
    {"checkerTexture", {"checker", "scale", "offset", "solid", "corner", "color"}},
    {"environmentMap", {"environment", "rotation", "intensity"}},
    {"mesh", {"file"}},
    {"object/sphere", {"type", "center", "radius", "material", "transform"}},
    {"object/plane", {"type", "point", "normal", "material", "transform"}},
    {"object/disc", {"type", "center", "normal", "radius", "material", "transform"}},
    {"object/box", {"type", "min", "max", "material", "transform"}},
    {"object/triangle", {"type", "vertices", "material", "transform"}},
    {"object/polygon", {"type", "vertices", "material", "transform"}},
    {"object/quadric", {"type", "coefficients", "bounds", "material", "transform"}},
    {"object/ellipsoid", {"type", "center", "radii", "material", "transform"}},
    {"object/cylinder", {"type", "base", "top", "radius", "capped", "material", "transform"}},
    {"object/cone", {"type", "base", "apex", "radius", "topRadius", "capped", "material", "transform"}},
    {"object/hyperboloid", {"type", "base", "top", "radius", "waist", "capped", "material", "transform"}},
    {"object/paraboloid", {"type", "vertex", "top", "radius", "capped", "material", "transform"}},
    {"object/mesh", {"type", "mesh", "material", "transform"}},
    {"object/group", {"type", "objects", "material", "transform"}},
    {"transformStep", {"scale", "rotate", "quaternion", "translate"}},
    {"animation", {"framesPerSecond", "tracks"}},
    {"animation/track", {"target", "interpolation", "times", "values"}},
});

constexpr const KeyTable& of(std::string_view what) {
    const auto found = std::ranges::find(kAllTables, what, &KeyTable::what);
    return found != kAllTables.end() ? *found : throw std::logic_error("no such key table");
}

// The values of "type" of an "object", "light" or "camera".
inline std::vector<std::string_view> typesOf(std::string_view kind) {
    std::vector<std::string_view> types;
    for (const KeyTable& table : kAllTables)
        if (table.what.starts_with(std::string(kind) + '/'))
            types.push_back(table.what.substr(kind.size() + 1));
    return types;
}

}  // namespace glint::keys
