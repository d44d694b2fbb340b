// The flat arrays that both tracers read: fp32, in leaf order, relative to a local origin.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "bvh/bvh.h"
#include "core/context.h"
#include "core/device_layout.h"
#include "core/vectors.h"
#include "scene/scene.h"

namespace glint {

// Features of a scene. The device pipeline leaves out those that are false.
struct SceneFeatures {
#define GLINT_FEATURE_FIELD(ID, NAME, field) bool field = false;
    GLINT_FEATURES(GLINT_FEATURE_FIELD)
#undef GLINT_FEATURE_FIELD
    bool operator==(const SceneFeatures&) const = default;
};

// Every feature on: the pipeline that leaves nothing out.
SceneFeatures allFeatures();

struct PackStatistics {
    double buildSeconds = 0;  // of the BVH alone
    uint32_t leaves = 0;
    uint32_t depth = 0;
    uint32_t splitTriangles = 0;  // further entries of triangles that were split for the BVH
    // Expected cost of a random ray in primitive tests; a node costs BvhOptions::traversalCost.
    double sahCost = 0;
    uint32_t prototypes = 0;
    uint64_t prototypeTriangles = 0;  // stored once each
    uint64_t instancedTriangles = 0;  // that these stand for
    uint32_t droppedZeroArea = 0;     // triangles and polygons without area after rounding to fp32
    uint32_t droppedNotFinite =
        0;  // triangles and polygons with a vertex that is not finite, or overflows fp32
};

// A box in world coordinates.
struct Extent : BoundingBox {
    // Takes in a point that is finite and within the range of fp32; leaves out others.
    void include(const glm::dvec3& p) {
        if (greatestMagnitude(p) <= std::numeric_limits<float>::max()) BoundingBox::include(p);
    }
    void include(const Extent& other) {
        lo = glm::min(lo, other.lo);
        hi = glm::max(hi, other.hi);
    }
    glm::dvec3 center() const { return 0.5 * lo + 0.5 * hi; }
    double halfSize() const { return greatestMagnitude(0.5 * hi - 0.5 * lo); }  // along the longest edge
};

// Bounds of the finite geometry, and of most of it.
struct Geometry {
    Extent extent;
    glm::dvec3 middle{0};  // the median, axis by axis, of the centres of the nearer half of the objects
    double reach = 0;      // half of all objects lie no farther from there in any axis, with all their parts
};

// MovingScene alone changes a packed scene. Settings of an image are in a Request (trace/request.h).
struct PackedScene {
    glm::dvec3 origin{0};  // world = origin + local; every position below is local; see originOf
    std::vector<shared::Node> nodes;
// triangles, spheres, ...: of each kind those that are in leaves in leaf order
#define GLINT_KIND_ARRAY(number, Kind, KINDS, kinds, one, many) std::vector<shared::Kind> kinds;
    GLINT_PRIMITIVES(GLINT_KIND_ARRAY, GLINT_KIND_ARRAY)
#undef GLINT_KIND_ARRAY
    std::vector<shared::TriangleSurface> triangleSurfaces;  // parallel to triangles
    std::vector<shared::VertexNormals> vertexNormals;
    std::vector<shared::PolygonVertex> polygonVertices;
    // How many times instances make rounding worse at most: the greatest row sum of |A| |A^-1|; 0 without.
    double instanceGain = 0;
    uint32_t polygonTripsPerLeaf = 0;  // loop trips on the device at most that a leaf of polygons takes
    std::vector<shared::Material> materials;
    std::vector<shared::Optics> optics;  // of the materials that let light through
    std::vector<shared::Light> lights;
    shared::Environment environment;        // with the media around `eye`
    glm::vec3 eye{0};                       // of the camera that the scene was packed for, local
    std::vector<shared::Texture> textures;  // those that a primitive's material, or the background, uses
    std::vector<shared::Texel> texels;      // each image once
    std::vector<shared::VertexAttribute> vertexAttributes;
    std::vector<shared::ObjectFrame>
        objectFrames;  // of every object, if a material has a texture; else empty
    SceneFeatures features;
    PackStatistics statistics;
    std::vector<std::string> warnings;
    Geometry geometry;                   // world space, without coordinates beyond fp32
    glm::vec3 boundsLo{0}, boundsHi{0};  // of everything in the BVH, local; equal if there is nothing
};

class TreeMemory;

// How to build the trees of a scene.
struct PackOptions {
    BuildQuality quality = BuildQuality::Default;
    // Triangles may stand in the tree more than once, where that makes it cheaper; false for a caller that
    // counts them.
    bool split = true;
    TreeMemory* memory = nullptr;  // trees of the scene before, see pack/build_tree.h
};

// Flattens a valid scene: places its objects (scene/placement.h), rounds to fp32 relative to the origin,
// drops degenerate triangles, builds the BVH, puts primitives in leaf order. Each prototype of instances is
// packed once, after the geometry of the world. The origin is 0 unless the geometry lies far from it compared
// with its size, see originOf. Throws Error(Scene) if an array would exceed a limit of shared/layout.h, with
// the array, its size and the limit.
PackedScene packScene(const Scene& scene, const PackOptions& options = {}, const Context& context = {});

// True if packScene would make the same arrays for `camera` as it made in `packed` for `scene`, which is
// placed (scene/placement.h): the camera determines the local origin and the anchors of planes and of huge
// spheres and quadrics next to the eye. May be false for equal arrays.
bool keepsArrays(const PackedScene& packed, const Scene& scene, const Camera& camera);
// Sets the media around a camera's local eye.
void setEye(const PackedScene& scene, const glm::vec3& eye, shared::Environment& environment);

// The rows of valid lights, rounded, relative to `origin`. A hit traces a shadow ray for each row.
std::vector<shared::Light> packLights(std::span<const Light> lights, const glm::dvec3& origin);

// The media that contain `point` (local): each dielectric material as often as its surfaces wind round the
// point, by their solid angle (A. van Oosterom, J. Strackee, "The Solid Angle of a Plane Triangle", IEEE
// Trans. Biomed. Eng. 30(2), 1983). Surfaces must therefore be closed and wound outwards; a plane has its
// inside below. Numbers as in shared::Material::medium, ordered from the material of the largest box to that
// of the smallest, those of planes first, and cut off at kMaxMedia.
glm::uvec4 mediaAt(const PackedScene& scene, const glm::dvec3& point);

// The camera of an image of width x height pixels, relative to `origin`; frame, tangent and steps are
// computed in double.
shared::Camera packCamera(const Camera& camera, int width, int height, const glm::dvec3& origin);

}  // namespace glint
