// A scene as the user describes it: plain data in double precision, world space, right-handed, y up, linear
// RGB colours.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "core/enum_names.h"
#include "core/image.h"

namespace glint {

using Color = glm::dvec3;  // linear RGB radiance or reflectance

// Positions of a pixel's samples (docs/guide/sampling.md). Grid: one regular grid for all pixels. Jittered:
// one random point in each cell of a grid. LowDiscrepancy: a sequence, scrambled for each pixel. Auto: Grid
// or LowDiscrepancy by the number of samples, see samplerOf (scene/sampling.h).
enum class Sampler { Auto, Grid, Jittered, LowDiscrepancy };
constexpr auto entriesOf(Sampler) {
    return std::to_array<EnumEntry<Sampler>>({{Sampler::Auto, "auto"},
                                              {Sampler::Grid, "grid"},
                                              {Sampler::Jittered, "jittered"},
                                              {Sampler::LowDiscrepancy, "lowDiscrepancy"}});
}

// How samples are weighted into pixels, by their distance from the pixel's centre.
enum class Filter { Box, Tent, Gaussian, Mitchell };
constexpr auto entriesOf(Filter) {
    return std::to_array<EnumEntry<Filter>>({{Filter::Box, "box"},
                                             {Filter::Tent, "tent"},
                                             {Filter::Gaussian, "gaussian"},
                                             {Filter::Mitchell, "mitchell"}});
}

// More samples where a pixel's own samples differ: each round adds `samplesPerPixel`, until the standard
// error of their mean is within `threshold` or maxSamples are taken.
struct AdaptiveSampling {
    int maxSamples = 64;
    double threshold = 0.05;  // contrast, 0..1
    bool operator==(const AdaptiveSampling&) const = default;
};

struct ImageSettings {
    int width = 800;   // pixels, 1..65536
    int height = 600;  // pixels, 1..65536
    int samplesPerPixel = 1;
    Sampler sampler = Sampler::Auto;
    Filter filter = Filter::Box;
    double filterRadius = 0.5;  // pixels; 0.5 is the pixel itself
    uint32_t seed = 0;
    std::optional<AdaptiveSampling> adaptive = {};
    bool operator==(const ImageSettings&) const = default;
};

// The part of the image plane that the picture shows (Shirley & Marschner, Fundamentals of Computer Graphics,
// ch. 4): left, right along u, bottom, top along v, from where the view direction meets the plane. The plane
// of a perspective camera lies at unit distance along the view direction, that of an orthographic one holds
// the eye.
struct ViewWindow {
    double left = -1, right = 1, bottom = -1, top = 1;
    bool operator==(const ViewWindow&) const = default;
};

// Rays from the eye through the image plane, or parallel rays from the image plane.
enum class Projection { Perspective, Orthographic };
constexpr auto entriesOf(Projection) {
    return std::to_array<EnumEntry<Projection>>(
        {{Projection::Perspective, "perspective"}, {Projection::Orthographic, "orthographic"}});
}

struct Camera {
    Projection projection = Projection::Perspective;
    glm::dvec3 eye{0, 0, 5};
    glm::dvec3 target{0, 0, 0};
    glm::dvec3 up{0, 1, 0};
    // Normal of the image plane, either side. Absent: the view direction. Given: an oblique camera; not zero
    // and not perpendicular to the view direction.
    std::optional<glm::dvec3> planeNormal;
    double fovY = 40;                  // perspective: degrees, vertical, in (0, 180)
    double height = 4;                 // orthographic: of the window, > 0
    std::optional<ViewWindow> window;  // overrides fovY and height; its aspect need not be the picture's
    // Camera rays have unit directions, so these bound the distance from where a ray starts: the eye, or the
    // image plane of an orthographic camera. 0 <= near < far.
    double nearT = 0;
    double farT = std::numeric_limits<double>::infinity();
    // Thin lens (Cook, Porter, Carpenter 1984): rays start on a disc of this radius about the eye, in the
    // image plane's direction, and meet at focusDistance along the view direction. 0: a pinhole. Perspective
    // only.
    double lensRadius = 0;
    double focusDistance = 0;  // > 0 with a lens; 0: the distance to the target
    bool operator==(const Camera&) const = default;
};

// True if camera rays start on a disc; parallel rays never do.
inline bool hasLens(const Camera& camera) {
    return camera.lensRadius > 0 && camera.projection == Projection::Perspective;
}

// One of several cameras of a file, for --camera and the window to choose.
struct NamedCamera {
    std::string name;  // not empty
    Camera camera;
    double aspect = 0;  // width over height of its picture; 0: the image's
};

// How light fades with the distance: not at all, or as intensity / distance^2.
enum class Falloff { None, InverseSquare };
constexpr auto entriesOf(Falloff) {
    return std::to_array<EnumEntry<Falloff>>(
        {{Falloff::None, "none"}, {Falloff::InverseSquare, "inverseSquare"}});
}

struct PointLight {
    glm::dvec3 position{0};
    Color intensity{1};
    Falloff falloff = Falloff::None;
    bool operator==(const PointLight&) const = default;
};

struct DirectionalLight {
    glm::dvec3 direction{0, -1, 0};  // the way the light travels; need not be unit length, not zero
    Color intensity{1};
    bool operator==(const DirectionalLight&) const = default;
};

// A point light behind a round opening: full light up to `angle` from the axis, none from angle + penumbra
// on.
struct SpotLight {
    glm::dvec3 position{0};
    glm::dvec3 direction{0, -1, 0};  // the axis, the way the light travels; need not be unit length, not zero
    double angle = 30;               // degrees, >= 0
    double penumbra = 0;             // degrees, >= 0; angle + penumbra in [kMinSpotAngle, 180]
    Color intensity{1};
    Falloff falloff = Falloff::None;
    bool operator==(const SpotLight&) const = default;
};

using Light = std::variant<PointLight, DirectionalLight, SpotLight>;
// The names of these kinds in scene files.
inline constexpr std::array kLightTypes = {"point", "directional", "spot"};
static_assert(kLightTypes.size() == std::variant_size_v<Light>);

// Beyond the edge of an image.
enum class Wrap { Repeat, Clamp, Mirror };
constexpr auto entriesOf(Wrap) {
    return std::to_array<EnumEntry<Wrap>>(
        {{Wrap::Repeat, "repeat"}, {Wrap::Clamp, "clamp"}, {Wrap::Mirror, "mirror"}});
}

// Between the texels of an image.
enum class TexelFilter { Bilinear, Nearest };
constexpr auto entriesOf(TexelFilter) {
    return std::to_array<EnumEntry<TexelFilter>>(
        {{TexelFilter::Bilinear, "bilinear"}, {TexelFilter::Nearest, "nearest"}});
}

// An image on a surface, by its (u, v): u to the right, v upwards, (0, 0) the lower left corner of the image.
struct ImageTexture {
    std::string file;                    // for messages
    std::shared_ptr<const Image> image;  // linear
    Wrap wrapU = Wrap::Repeat, wrapV = Wrap::Repeat;
    TexelFilter filter = TexelFilter::Bilinear;
};

// Two colours in squares of the (u, v) plane, or, `solid`, in cubes of object space. Material colours are
// multiplied with them.
struct CheckerTexture {
    Color a{1}, b{0};
    bool solid = false;
    glm::dvec3 corner{0};  // solid: in object space, where eight cubes meet
};

// `scale` then `offset` turn the surface's (u, v) into the texture's; a solid checker has `scale.x` cubes to
// a length of 1 and a corner instead of the offset.
struct Texture {
    std::variant<ImageTexture, CheckerTexture> source;
    glm::dvec2 scale{1};
    glm::dvec2 offset{0};
};

// L = ambient Ia + sum Ii [diffuse max(0, n.l) + specular max(0, n.h)^shininess] + mirror L_reflected
// (Blinn 1977; Whitted 1980)
struct Material {
    std::string name;
    Color ambient{0.8};
    Color diffuse{0.8};
    Color specular{0};
    double shininess = 32;  // >= 0
    Color mirror{0};        // each channel in [0, 1]

    // Transmitted light, each channel in [0, 1]. If not black, the material is a dielectric whose Fresnel
    // reflectance splits light into a reflected and a refracted part (docs/reference/shading.md).
    Color transmission{0};
    double ior = 1.5;      // index of refraction, inside over outside; > 0
    Color attenuation{0};  // Beer: light falls by exp(-attenuation * length) inside; per unit length, >= 0
    int priority = 0;      // of overlapping dielectrics the greatest counts; equal: the one entered last

    // Multiplied with the colours above; indices into Scene::textures or kNoTexture.
    static constexpr uint32_t kNoTexture = 0xffffffffu;
    uint32_t ambientTexture = kNoTexture;
    uint32_t diffuseTexture = kNoTexture;
    uint32_t specularTexture = kNoTexture;
    uint32_t mirrorTexture = kNoTexture;
    uint32_t transmissionTexture = kNoTexture;
    // Alpha of the diffuse texture below which the surface is cut out; 0 ignores alpha.
    double alphaCutoff = 0;
    bool operator==(const Material&) const = default;
};
// Their keys in scene files. Ambient follows diffuse, of which it is often a copy.
inline constexpr std::pair<const char*, uint32_t Material::*> kMaterialTextures[] = {
    {"diffuse", &Material::diffuseTexture},
    {"ambient", &Material::ambientTexture},
    {"specular", &Material::specularTexture},
    {"mirror", &Material::mirrorTexture},
    {"transmission", &Material::transmissionTexture}};
inline bool hasTexture(const Material& m) {
    return std::ranges::any_of(kMaterialTextures,
                               [&](const auto& named) { return m.*named.second != Material::kNoTexture; });
}

// Polygons already split into triangles. `corners` index `positions`; `normalCorners` index `normals` and is
// either empty (no vertex normals at all) or as long as `corners`, with kNoIndex thrice for a triangle
// without normals.
struct Mesh {
    static constexpr uint32_t kNoIndex = 0xffffffffu;
    std::vector<glm::dvec3> positions;
    std::vector<glm::dvec3> normals;  // need not be unit length
    std::vector<glm::uvec3> corners;  // one per triangle
    std::vector<glm::uvec3> normalCorners;
    std::vector<glm::dvec2> uvs;
    std::vector<glm::uvec3> uvCorners;     // as normalCorners, into uvs
    std::vector<Color> colors;             // linear; multiplied with diffuse and ambient colour
    std::vector<glm::uvec3> colorCorners;  // as normalCorners, into colors
    std::vector<uint32_t> faces;      // per triangle: its polygon's index in the file; empty: the identity
    std::vector<uint32_t> materials;  // per triangle, into Scene::materials; empty: the object's material
};

struct SphereShape {
    glm::dvec3 center{0};
    double radius = 1;  // > 0
    bool operator==(const SphereShape&) const = default;
};
struct PlaneShape {
    glm::dvec3 point{0};
    glm::dvec3 normal{0, 1, 0};  // need not be unit length, not zero
    bool operator==(const PlaneShape&) const = default;
};
struct DiscShape {
    glm::dvec3 center{0};
    glm::dvec3 normal{0, 1, 0};  // need not be unit length, not zero
    double radius = 1;           // > 0
    bool operator==(const DiscShape&) const = default;
};
// The solid between two opposite corners; axis-aligned, of any kind under a transform.
struct BoxShape {
    glm::dvec3 min{-1}, max{1};  // min < max, each component
    bool operator==(const BoxShape&) const = default;
};
struct TriangleShape {
    glm::dvec3 vertices[3];
    bool operator==(const TriangleShape&) const = default;
};
// Planar, concave or not. If the outline crosses itself, a point is inside if the outline winds around it an
// odd number of times.
struct PolygonShape {
    std::vector<glm::dvec3> vertices;  // counter-clockwise seen from outside, see scene/polygon_plane.h
    bool operator==(const PolygonShape&) const = default;
};
// A x^2 + B y^2 + C z^2 + D xy + E yz + F xz + G x + H y + I z + J = 0, the part within the box [lo, hi].
struct QuadricShape {
    double coefficients[10] = {};
    glm::dvec3 lo{-1}, hi{1};
    bool operator==(const QuadricShape&) const = default;
};
struct EllipsoidShape {
    glm::dvec3 center{0};
    glm::dvec3 radii{1};  // > 0
    bool operator==(const EllipsoidShape&) const = default;
};
struct CylinderShape {
    glm::dvec3 base{0}, top{0, 1, 0};
    double radius = 1;  // > 0
    bool capped = false;
    bool operator==(const CylinderShape&) const = default;
};
// Tapers from `radius` at the base to `topRadius` at the apex, which is 0 for a whole cone.
struct ConeShape {
    glm::dvec3 base{0}, apex{0, 1, 0};
    double radius = 1;     // > 0
    double topRadius = 0;  // >= 0, not equal to radius
    bool capped = false;
    bool operator==(const ConeShape&) const = default;
};
// One sheet about the axis from base to top: `waist` the radius half way, `radius` that of both ends.
struct HyperboloidShape {
    glm::dvec3 base{0}, top{0, 1, 0};
    double radius = 1;   // > waist
    double waist = 0.5;  // > 0
    bool capped = false;
    bool operator==(const HyperboloidShape&) const = default;
};
// From the vertex to the rim, whose radius is given.
struct ParaboloidShape {
    glm::dvec3 vertex{0}, top{0, 1, 0};
    double radius = 1;  // > 0
    bool capped = false;
    bool operator==(const ParaboloidShape&) const = default;
};
struct MeshShape {
    std::shared_ptr<const Mesh> mesh;
    bool operator==(const MeshShape&) const = default;
};
using Shape =
    std::variant<SphereShape, PlaneShape, DiscShape, BoxShape, TriangleShape, PolygonShape, QuadricShape,
                 EllipsoidShape, CylinderShape, ConeShape, HyperboloidShape, ParaboloidShape, MeshShape>;

// x -> linear x + offset
struct Affine {
    glm::dmat3 linear{1};
    glm::dvec3 offset{0};
    bool operator==(const Affine&) const = default;
};

// `name` is where the object stands in its file ("/objects/3"), for messages.
struct Object {
    std::string name;
    Shape shape;
    uint32_t material = 0;  // index into Scene::materials
    // From the shape's coordinates to the world's, regular, of any kind. Meshes that several objects share
    // are stored once.
    std::optional<Affine> transform = {};
    // Transform from the object's own coordinates that the reader has already applied to the shape. Textures
    // are fixed in object coordinates.
    Affine applied = {};
    bool operator==(const Object&) const = default;
};

// Radiance from infinitely far away, in latitude and longitude: row 0 is straight up, the middle column is
// seen along -z, +x to its right. `rotation` turns it about y, degrees, counter-clockwise from above.
struct EnvironmentMap {
    std::string file;  // for messages
    std::shared_ptr<const Image> image;
    double rotation = 0;
    Color intensity{1};
};

// Effect of dielectrics on shadow rays: block them, or pass them straight on, coloured by transmission and
// attenuation (docs/reference/shading.md).
enum class TransmissiveShadows { Colored, Full };
constexpr auto entriesOf(TransmissiveShadows) {
    return std::to_array<EnumEntry<TransmissiveShadows>>(
        {{TransmissiveShadows::Colored, "colored"}, {TransmissiveShadows::Full, "full"}});
}

// A file that a scene was read from: its name relative to the scene's folder, and its content's hash
// (core/content_hash.h); of pictures that of the samples that were read.
struct SourceFile {
    std::string name;
    uint64_t hash = 0;
    auto operator<=>(const SourceFile&) const = default;
};

// When the file's animation moves something, in seconds (docs/reference/scene-format.md).
struct AnimationSpan {
    double framesPerSecond = 24;
    size_t tracks = 0;
    double start = 0, end = 0;  // of the first keyframe and the last one
};

struct Scene {
    ImageSettings image;
    Camera camera;
    std::vector<NamedCamera> cameras;  // further named cameras, `camera` possibly among them; each name once
    Color background{0};
    std::optional<EnvironmentMap> environment;  // instead of the background
    Color ambient{0};                           // Ia
    int maxDepth = 5;  // greatest number of reflections followed from a camera ray, 0..1000
    TransmissiveShadows transmissiveShadows = TransmissiveShadows::Colored;
    std::vector<Light> lights;
    std::vector<Texture> textures;
    std::vector<Material> materials;
    std::vector<Object> objects;
    std::vector<std::string> warnings;  // one line each: ignored or repaired parts of the files
    std::optional<AnimationSpan> animation;
    std::vector<SourceFile> sources;  // by name, each once; empty for a scene that came from no file
};

}  // namespace glint
