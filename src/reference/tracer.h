// The CPU reference: double precision, its own traversal and intersection code, written independently of the
// shaders from the same formulas. With the device's rounded inputs it differs by arithmetic alone; with the
// scene as it was read (truth/truth.h) it is the truth.
//
// In the order of an image: render.h calls sampling.h for camera rays and shade.cpp for the tree of rays
// below each; shade.cpp calls traversal.cpp (traverse.h, primitives/) for the closest hit, intersect.cpp for
// the surface there, material.h for its colours, and scatter.h for lights, reflection and refraction.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "core/enum_names.h"
#include "pack/packed_scene.h"
#include "pack/request_environment.h"
#include "reference/model.h"
#include "reference/rounding.h"
#include "trace/picture.h"

namespace glint::reference {

// Random error of what fp32 computes along a ray: the alpha of a hit (holeAt), the discriminant of quadrics
// that the ray misses and the open rims of others (primitives/quadric.cpp), the faces of boxes
// (primitives/cuboid.cpp), and with `formulas` a textbook sphere test (primitives/sphere.cpp); none
// for step 0.
struct RayNoise {
    uint64_t seed = 0;
    double step = 0;
    bool formulas = false;
    // If rounding decides whether a hit is a hole of a mask, it is one unless its primitive has this id;
    // kAll: no hit is one, kNone: each is. Without a value the seed decides.
    static constexpr uint32_t kAll = 0xfffffffe;
    std::optional<uint32_t> solid = std::nullopt;
    // The primitive with that id is solid for rays from its inner side alone, so that one that is hit twice
    // may be hit behind a hole of itself.
    bool solidInside = false;
};

// Points origin + t direction with tMin < t <= tMax (t = 0 is excluded). The direction need not be unit
// length. Local coordinates.
struct Ray {
    glm::dvec3 origin{0};
    glm::dvec3 direction{0, 0, -1};
    double tMin = 0;
    double tMax = std::numeric_limits<double>::infinity();
    // Camera ray: the greatest numbers that a coordinate of the origin, or of the unit direction, is a sum
    // of. They cancel if a ray starts near 0, or leaves far from an oblique camera's direction; rounding, and
    // hence Jitter, scales with them.
    double originScale = 0;
    double directionScale = 1;
    RayNoise noise = {};
    // True for rays of an image: among surfaces that coincide within fp32's error the lowest id is hit.
    bool ties = false;
    // Scale of the arithmetic part of that error, see slipOfFlat: 1 is the rule.
    double slips = 1;
};

struct Hit {
    double t = 0;
    double u = 0, v = 0;                 // triangles: P = (1-u-v)a + u b + v c; spheres and planes: 0
    uint32_t primitive = shared::kNone;  // kind and index in leaf order, as in shared/layout.h
    uint32_t id = 0;                     // global primitive number
    uint32_t instance = shared::kNone;   // that the primitive is one of, index in PackedScene::instances
    double slip = 0;                     // of t, for rays with Ray::ties
    bool operator==(const Hit&) const = default;

    bool isTriangle() const { return primitive >> shared::kPrimitiveKindShift == shared::kKindTriangle; }
};

// Start of a ray: a primitive in the world or of an instance. For a hit: sourceOf.
struct Source {
    Source(uint32_t p = shared::kNone, uint32_t i = shared::kNone) : primitive(p), instance(i) {}
    uint32_t primitive;  // kind and index
    uint32_t instance;
};
// An unknown primitive. (kElsewhere in shaders/traversal/ray.glsl)
inline constexpr uint32_t kElsewhere = 0xfffffffe;
inline Source sourceOf(const Hit& hit) {
    return {hit.primitive, hit.instance};
}

// A hit for the user.
struct Surface {
    uint32_t object = 0;     // index in the scene's object list
    uint32_t primitive = 0;  // face index in the file's order
    uint32_t material = 0;
    glm::dvec3 position{0};         // local
    glm::dvec3 geometricNormal{0};  // outward, unit: winding order for triangles
    glm::dvec3 shadingNormal{0};    // interpolated vertex normal, or the geometric one; outward, unit
    glm::dvec2 uv{0};               // texture coordinates (docs/reference/shading.md)
    glm::dvec3 color{1};            // of the vertices, interpolated
    double scale = 0;               // the greatest coordinate of the position and of its inputs
    glm::dvec2 uvScale{0};          // the same of u and v, in units of theirs
    double bend = 0;                // of quadrics: bound on the turn of the normal per unit of distance
    glm::dvec3 error{0};            // fp32's error of the position on each axis (rounding.h)
    uint64_t lookup = 0;            // Jitter::lookup
};

// Moves rays by the size of rounding, to find the decisions that depend on it. It moves, for every camera
// ray, reflected ray and shadow ray of a path:
// - each component of the origin, by up to `ulps` * 2^-24 * scale (scale: the greatest magnitude among the
//   coordinates of the origin, the hit point that it came from, and the geometry involved);
// - each component of the unit direction, by up to `ulps` * 2^-24, of a camera ray times Ray::directionScale.
// It also moves
// - the unit direction to a spot light before it is compared with the cone, and each contribution before it
//   is compared with the least that is followed;
// - texture coordinates, by up to `ulps` * 2^-24 * max(1, Surface::uvScale), and points of a solid checker as
//   origins are;
// - the alpha of masks, by the rounding of its lookup (holeAt), and the sine of a refracted angle, by `ulps`
//   times the rounding of Snell's law (scatteringAt);
// - limbs and open rims of quadrics, and heights over the faces of boxes, within fp32's bounds (tangentError,
//   swayAt, Seen).
// seed 0 and ulps 0: no jitter. Deterministic for a seed.
// `formulas`: also, a textbook's tests of spheres lose up to `ulps` units of what they sum, and no more than
// fp32 does (RayNoise).
// `clears`: also, rays begin `ulps` times as far from the surface that they leave as the device's do
// (rounding.h). This distance is the sum of the bounds on the point's errors, which rounding seldom reaches.
// `slips`: no movement, but fp32's own errors in the rule for surfaces in one place, as parts of their bound.
// With 0 as few surfaces as possible coincide with the closest one, or with the one that a ray leaves; with
// kMostSlips as many as possible. kMostSlips also starts rays as far from their surface as the device may.
// `hit`: id that the first ray hits if the rule lets fp32 hit it (Tracer::possibleHit), else kNone.
// `t`: the first hit's t, if not 0, for all that follows from the hit. The ray then moves everything except
// the texture coordinates: they are those of the unmoved ray at t, within kUvRoundings. `lookup`: with t, the
// seed of these coordinates. Even: textures round as IEEE 754 demands; odd: by any error within fp32's bound.
// If rounding of these lookups decides whether masks hide a light, its colour is a range; from the first hit
// it then counts as hidden if it has a bit in `hidden`.
struct Jitter {
    uint64_t seed = 0;
    double ulps = 0;
    bool formulas = false;
    bool clears = false;
    double slips = 1;
    uint32_t hit = shared::kNone;
    double t = 0;
    uint64_t lookup = 0;
    uint32_t hidden = 0;
};
inline constexpr double kMostSlips = 2;

// From the eye, to a light, or reflected and refracted by a surface.
enum class RayClass { Primary, Shadow, Mirrored, Refracted };
constexpr auto entriesOf(RayClass) {
    return std::to_array<EnumEntry<RayClass>>({{RayClass::Primary, "primary"},
                                               {RayClass::Shadow, "shadow"},
                                               {RayClass::Mirrored, "mirrored"},
                                               {RayClass::Refracted, "refracted"}});
}
constexpr size_t kRayClasses = kEnumNames<RayClass>.size();

// One ray of a path's tree, in the order they are followed, for `verify` and for picking.
struct Bounce {
    Ray ray;
    std::optional<Hit> hit;
    std::optional<Surface> surface;
    std::vector<uint8_t> occluded;  // per light: 1 if it faces the surface and its shadow ray is blocked
    RayClass kind = RayClass::Primary;
    uint32_t depth = 0;        // rays before it; it comes from the last one listed of a depth one less
    glm::dvec3 light{0};       // its own addition to the pixel's colour, without the rays that follow
    glm::dvec3 throughput{1};  // before the ray
};

// Rays of one class, and the boxes and primitives that they tested.
struct RayTally {
    uint64_t rays = 0, tests = 0;

    RayTally& operator+=(const RayTally& other) {
        rays += other.rays;
        tests += other.tests;
        return *this;
    }
};

struct PixelRecord {
    glm::dvec3 color{0};
    std::optional<Hit> hit;          // of the camera ray
    std::optional<Surface> surface;  // at that hit
    double alpha = 0;                // 1 if the camera ray hits anything
    uint32_t bounces = 0;            // rays after the camera ray, of all branches
    uint32_t pathHash = 0;           // FNV-1a over the hit ids, see docs/reference/shading.md
    uint32_t shadowBits = 0;         // bit i: light i (i < 32) is occluded at the first hit
    // Absolute, by channel: what fp32 may add to `color` where all rays and hits are given, by the arithmetic
    // of shading alone (rounding.h).
    glm::dvec3 rounding{0};
    // A hash of the path's decisions: primitives hit and from which side, lights faced and hidden, cells of
    // checkers, kinds of further rays. The colour of paths with equal decisions changes continuously with the
    // rays. A path's hash is addDecisions() over the decisions of its steps.
    uint32_t decisions = 0;
    // True if a ray of the path, or under jitter a blocked shadow ray, hit an instance.
    bool meetsInstance = false;
    std::array<RayTally, kRayClasses> tally;  // by RayClass
    TreeLosses lost;
    std::vector<Bounce> path;

    // Boxes and primitives tested by all rays of the path.
    uint64_t cost() const {
        RayTally all;
        for (const RayTally& one : tally) all += one;
        return all.tests;
    }
};

// Adds the decisions of a step to those of the path so far.
constexpr uint32_t addDecisions(uint32_t path, uint32_t step) {
    return (path ^ step) * shared::kHashPrime;
}

// The media that a ray is inside of, oldest first; numbers as in rows::Material::medium.
using Media = std::vector<uint32_t>;

// A ray of the tree, and what the path so far determines.
struct Branch {
    Ray ray;
    Source source;
    RoundedColor throughput{glm::dvec3(1)};
    RayClass kind = RayClass::Primary;
    uint32_t depth = 0;    // rays before it
    uint32_t waiting = 0;  // branches that are followed only after all that comes of this one
    Media media;
    // Start on a surface: the point, the unit normal on the ray's side (0 for camera rays), the distance from
    // the point at which the device's ray begins, and the greatest number that a coordinate of the point is a
    // sum of.
    glm::dvec3 start{0}, out{0};
    double clearance = 0, scale = 0;
};

// `record` describes the branch's ray as if it were a camera ray; its color is the light that the hit adds.
struct Step {
    PixelRecord record;
    std::vector<Branch> next;
    // The ray's own hit, which Jitter::t replaces: its t, and true if the ray comes from the outer side.
    double t = 0;
    bool enters = false;
};

class Tracer {
  public:
    // Traces the rounded scene, whose arrays are widened here; use one tracer for many rays. The scene must
    // outlive the tracer. Methods choose the device's tests. The reference has tests of its own, and needs
    // the choice for the errors of textbook tests (Jitter::formulas) and for how these count crossings.
    explicit Tracer(const PackedScene& scene, const Tracing& tracing = {});
    // Camera rays start in the media around the request's eye; without a request, in those around the eye
    // that the scene was packed for.
    Tracer(const PackedScene& scene, const Request& request);
    // Traces any model. radianceBound: cuts branches (radianceBoundOf).
    Tracer(std::shared_ptr<const Model> model, const Tracing& tracing, double radianceBound);

    const Model& model() const { return scene_; }

    const Methods& methods() const { return tracing_.methods; }
    bool shadows() const { return tracing_.shadows; }
    const std::vector<rows::Light>& lights() const { return lights_; }
    const rows::Environment& environment() const { return environment_; }

    // The closest hit; equal t goes to the lowest id. A ray that is not finite, or has no direction, misses.
    // `source`: the primitive that the ray starts on (kind|index), or none; a plane or triangle never hits
    // itself, a sphere only at its far side.
    std::optional<Hit> closest(const Ray& ray, const Source& source = {}, uint64_t* cost = nullptr) const;
    // True if anything is hit.
    bool occluded(const Ray& ray, const Source& source = {}, uint64_t* cost = nullptr) const;
    // Every hit, nearest first; of triangles that share the edge or corner that is hit, all.
    std::vector<Hit> allHits(const Ray& ray, const Source& source = {}, uint64_t* cost = nullptr) const;
    // The hit of primitive `id` if fp32 may take it for the closest of an image's ray
    // (docs/design/numerics.md).
    std::optional<Hit> possibleHit(const Ray& ray, const Source& source, uint32_t id) const;

    // False for a hit in a triangle's edge or corner that counts as another triangle's, where a ray goes
    // through: crossesTriangle. The textbooks' triangle tests do not agree about edges; with them each counts
    // for itself.
    bool crosses(const Ray& ray, const Hit& hit) const;

    Surface surfaceAt(const Ray& ray, const Hit& hit) const;
    // Its object, primitive and material alone.
    Surface namesAt(const Hit& hit) const;

    // The camera ray through film point (x, y), in pixels from the top left corner (a pixel's centre is at
    // +0.5), and, of a camera with a lens, point `lens` of the unit disc.
    Ray cameraRay(const rows::Camera& camera, double x, double y, const glm::dvec2& lens = {0, 0}) const;

    // Follows a camera ray through at most the environment's depth of reflections and refractions in a row.
    // keepPath fills PixelRecord::path.
    PixelRecord trace(const Ray& cameraRay, const Jitter& jitter = {}, bool keepPath = false) const;
    // Follows one ray without the rays that leave its hit. A moved ray stays on its side of the surface that
    // it leaves.
    Step step(const Branch& branch, const Jitter& jitter = {}) const;
    Branch firstBranch(const Ray& cameraRay) const;

  private:
    std::shared_ptr<const Model> model_;
    const Model& scene_;  // *model_
    Tracing tracing_;
    rows::Environment environment_;
    std::vector<rows::Light> lights_;
};

}  // namespace glint::reference
