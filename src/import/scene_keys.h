// Every key of a scene file, by the object it stands in. The parser refuses what is not here;
// tests hold scenes/scene.schema.json to the same lists.
#pragma once

#include <array>
#include <string_view>

#include "import/json_cursor.h"
#include "scene/scene.h"

namespace glint::keys {

namespace detail {
template <typename... Names>
constexpr std::array<std::string_view, sizeof...(Names)> names(Names... list) {
    return {std::string_view(list)...};
}
inline constexpr auto kNothing = std::array<std::string_view, 0>{};
inline constexpr auto kScene =
    names("$schema", "image", "camera", "cameras", "background", "ambient", "maxDepth", "transmissiveShadows",
          "lights", "materials", "meshes", "objects", "animation");
inline constexpr auto kImage =
    names("width", "height", "samplesPerPixel", "sampler", "filter", "filterRadius", "seed", "adaptive");
inline constexpr auto kAdaptive = names("maxSamples", "threshold");
inline constexpr auto kPerspective = names("type", "eye", "target", "up", "planeNormal", "fovY", "window",
                                           "near", "far", "lensRadius", "focusDistance");
inline constexpr auto kOrthographic =
    names("type", "eye", "target", "up", "planeNormal", "height", "window", "near", "far");
inline constexpr auto kPoint = names("type", "position", "intensity", "falloff");
inline constexpr auto kDirectional = names("type", "direction", "intensity");
inline constexpr auto kSpot =
    names("type", "position", "direction", "angle", "penumbra", "intensity", "falloff");
inline constexpr auto kMaterial =
    names("ambient", "diffuse", "specular", "shininess", "mirror", "transmission", "ior", "attenuation",
          "attenuationColor", "attenuationDistance", "priority", "alphaCutoff");
inline constexpr auto kImageTexture = names("texture", "wrap", "filter", "scale", "offset", "color");
inline constexpr auto kCheckerTexture = names("checker", "scale", "offset", "solid", "corner", "color");
inline constexpr auto kEnvironmentMap = names("environment", "rotation", "intensity");
inline constexpr auto kMesh = names("file");
inline constexpr auto kSphere = names("type", "center", "radius", "material", "transform");
inline constexpr auto kPlane = names("type", "point", "normal", "material", "transform");
inline constexpr auto kDisc = names("type", "center", "normal", "radius", "material", "transform");
inline constexpr auto kBox = names("type", "min", "max", "material", "transform");
inline constexpr auto kTriangle = names("type", "vertices", "material", "transform");
inline constexpr auto kPolygon = names("type", "vertices", "material", "transform");
inline constexpr auto kQuadric = names("type", "coefficients", "bounds", "material", "transform");
inline constexpr auto kEllipsoid = names("type", "center", "radii", "material", "transform");
inline constexpr auto kCylinder = names("type", "base", "top", "radius", "capped", "material", "transform");
inline constexpr auto kCone =
    names("type", "base", "apex", "radius", "topRadius", "capped", "material", "transform");
inline constexpr auto kHyperboloid =
    names("type", "base", "top", "radius", "waist", "capped", "material", "transform");
inline constexpr auto kParaboloid =
    names("type", "vertex", "top", "radius", "capped", "material", "transform");
inline constexpr auto kMeshObject = names("type", "mesh", "material", "transform");
inline constexpr auto kGroup = names("type", "objects", "material", "transform");
inline constexpr auto kTransformStep = names("scale", "rotate", "quaternion", "translate");
inline constexpr auto kAnimation = names("framesPerSecond", "tracks");
inline constexpr auto kTrack = names("target", "interpolation", "times", "values");
}  // namespace detail

inline constexpr KeyTable kScene{"scene", detail::kScene, detail::kNothing};
inline constexpr KeyTable kImage{"image", detail::kImage, detail::kNothing};
inline constexpr KeyTable kAdaptive{"image/adaptive", detail::kAdaptive, detail::kNothing};
inline constexpr KeyTable kPerspective{"camera/perspective", detail::kPerspective, detail::kNothing};
inline constexpr KeyTable kOrthographic{"camera/orthographic", detail::kOrthographic, detail::kNothing};
inline constexpr KeyTable kPoint{"lights/point", detail::kPoint, detail::kNothing};
inline constexpr KeyTable kDirectional{"lights/directional", detail::kDirectional, detail::kNothing};
inline constexpr KeyTable kSpot{"lights/spot", detail::kSpot, detail::kNothing};
inline constexpr KeyTable kMaterial{"material", detail::kMaterial, detail::kNothing};
inline constexpr KeyTable kImageTexture{"imageTexture", detail::kImageTexture, detail::kNothing};
inline constexpr KeyTable kCheckerTexture{"checkerTexture", detail::kCheckerTexture, detail::kNothing};
inline constexpr KeyTable kEnvironmentMap{"environmentMap", detail::kEnvironmentMap, detail::kNothing};
inline constexpr KeyTable kMesh{"mesh", detail::kMesh, detail::kNothing};
inline constexpr KeyTable kSphere{"objects/sphere", detail::kSphere, detail::kNothing};
inline constexpr KeyTable kPlane{"objects/plane", detail::kPlane, detail::kNothing};
inline constexpr KeyTable kDisc{"objects/disc", detail::kDisc, detail::kNothing};
inline constexpr KeyTable kBox{"objects/box", detail::kBox, detail::kNothing};
inline constexpr KeyTable kTriangle{"objects/triangle", detail::kTriangle, detail::kNothing};
inline constexpr KeyTable kPolygon{"objects/polygon", detail::kPolygon, detail::kNothing};
inline constexpr KeyTable kQuadric{"objects/quadric", detail::kQuadric, detail::kNothing};
inline constexpr KeyTable kEllipsoid{"objects/ellipsoid", detail::kEllipsoid, detail::kNothing};
inline constexpr KeyTable kCylinder{"objects/cylinder", detail::kCylinder, detail::kNothing};
inline constexpr KeyTable kCone{"objects/cone", detail::kCone, detail::kNothing};
inline constexpr KeyTable kHyperboloid{"objects/hyperboloid", detail::kHyperboloid, detail::kNothing};
inline constexpr KeyTable kParaboloid{"objects/paraboloid", detail::kParaboloid, detail::kNothing};
inline constexpr KeyTable kMeshObject{"objects/mesh", detail::kMeshObject, detail::kNothing};
inline constexpr KeyTable kGroup{"objects/group", detail::kGroup, detail::kNothing};
inline constexpr KeyTable kTransformStep{"transformStep", detail::kTransformStep, detail::kNothing};

inline constexpr KeyTable kAnimation{"animation", detail::kAnimation, detail::kNothing};
inline constexpr KeyTable kTrack{"animation/track", detail::kTrack, detail::kNothing};

inline constexpr std::array kAllTables{
    kScene,          kImage,          kPerspective, kOrthographic, kPoint,         kDirectional,
    kSpot,           kMaterial,       kMesh,        kSphere,       kPlane,         kDisc,
    kTriangle,       kPolygon,        kMeshObject,  kGroup,        kTransformStep, kQuadric,
    kEllipsoid,      kCylinder,       kCone,        kHyperboloid,  kParaboloid,    kImageTexture,
    kCheckerTexture, kEnvironmentMap, kAdaptive,    kBox,          kAnimation,     kTrack};

// The values of "type". `later` is in the scene format, but not in this version.
struct TypeTable {
    std::string_view what;
    std::span<const std::string_view> types;
    std::span<const std::string_view> later;
};

namespace detail {
inline constexpr auto kLightTypes = names("point", "directional", "spot");
inline constexpr auto kObjectTypes =
    names("sphere", "plane", "disc", "box", "triangle", "polygon", "quadric", "ellipsoid", "cylinder", "cone",
          "hyperboloid", "paraboloid", "mesh", "group");
}  // namespace detail

inline constexpr TypeTable kCameraTypes{"camera", kEnumNames<Projection>, detail::kNothing};
inline constexpr TypeTable kLightTypes{"light", detail::kLightTypes, detail::kNothing};
inline constexpr TypeTable kObjectTypes{"object", detail::kObjectTypes, detail::kNothing};

}  // namespace glint::keys
