// The primitives of a scene, numbered and rounded to fp32; internal to the packing.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <cstring>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "bvh/bvh.h"
#include "core/device_layout.h"
#include "pack/packed_scene.h"
#include "scene/scene.h"

namespace glint {

// Ids are consecutive over objects and, within a mesh, over its triangles; every primitive has one, packed or
// not. Items are the entries of the tree: the primitives, and each instance as a whole.
class PrimitiveNumbers {
  public:
    static constexpr uint32_t kChunk = 32768;  // items that one thread treats at a time

    explicit PrimitiveNumbers(const Scene& scene);

    uint32_t firstId(uint32_t object) const { return ids_[object]; }
    uint32_t firstItem(uint32_t object) const { return first_[object]; }
    uint32_t facesOf(uint32_t object) const { return first_[object + 1] - first_[object]; }
    uint32_t total() const { return first_.back(); }
    size_t chunks() const { return (total() + size_t{kChunk} - 1) / kChunk; }

    // Calls visit(object, firstFace, endFace) for each object that has items in the chunk; an instance
    // has the single face 0.
    template <class Visit>
    void visitChunk(size_t chunk, Visit&& visit) const {
        const uint32_t begin = static_cast<uint32_t>(chunk * kChunk);
        const uint32_t end = std::min<uint32_t>(total() - begin, kChunk) + begin;
        auto next = std::upper_bound(first_.begin(), first_.end(), begin);
        for (uint32_t id = begin; id < end; ++next) {
            const uint32_t objectEnd = std::min(*next, end);
            if (objectEnd == id) continue;  // a mesh without triangles
            const auto object = static_cast<uint32_t>(next - first_.begin() - 1);
            visit(object, id - first_[object], objectEnd - first_[object]);
            id = objectEnd;
        }
    }

  private:
    std::vector<uint32_t> first_;  // item, per object, and one past the last
    std::vector<uint32_t> ids_;    // per object
};

// The triangles of an object, or none.
class TriangleSource {
  public:
    explicit TriangleSource(const Object& object) : triangle_(std::get_if<TriangleShape>(&object.shape)) {
        if (const auto* shape = std::get_if<MeshShape>(&object.shape)) mesh_ = shape->mesh.get();
    }
    const Mesh* mesh() const { return mesh_; }
    std::array<glm::dvec3, 3> vertices(uint32_t face) const {
        if (mesh_ == nullptr) return {triangle_->vertices[0], triangle_->vertices[1], triangle_->vertices[2]};
        const glm::uvec3 c = mesh_->corners[face];
        return {mesh_->positions[c.x], mesh_->positions[c.y], mesh_->positions[c.z]};
    }

  private:
    const TriangleShape* triangle_ = nullptr;
    const Mesh* mesh_ = nullptr;
};

// Outcome for a primitive: absent without a warning, kept, or dropped with a warning.
enum class PrimitiveStatus : uint8_t { Absent, Kept, NoArea, NotFinite };

// An instance in the world, relative to the origin of the packed scene.
struct PlacedInstance {
    PrimitiveStatus status = PrimitiveStatus::Absent;  // never NoArea
    shared::Instance row;  // `root` is the number of its prototype until Instances::append is called
    Box box;               // empty unless it is kept
    double gain = 0;       // of rounding errors, see Instances::placedAt
    double reach = 0;      // greatest coordinate of the box and the place
};
struct PlacedInstances {
    std::vector<uint32_t> slot;  // of each object among the instances
    std::vector<PlacedInstance> instances;
    const PlacedInstance& of(uint32_t object) const { return instances[slot[object]]; }
};

// Viewpoint of the packed scene, for bounds on rounding errors.
struct Frame {
    glm::dvec3 origin{0};
    glm::dvec3 eye{0};  // world
    const PlacedInstances* instances = nullptr;
};

using Corners = std::array<glm::vec3, 3>;

// How far a hit that the device finds may lie off a triangle or polygon with this tight box, on any axis, by
// that part of the rounding which does not shrink with the ray's way to it: so far their boxes reach beyond.
//
// The edge test (Woop, Benthin, Wald, JCGT 2(1), 2013) decides by corners X = x - o, sheared to X - S Z with
// S = dx/dz, |S| <= 1. With u = 2^-24: X, Z, the product and the difference are rounded, S is a product with
// a reciprocal good to 2.5 ulp, 6 u. So a sheared corner errs by 2 u |X| + 9 u |S Z| at most, alike for all
// triangles that share it; the sign of an edge function then is right or 0, as rounding is monotone. A ray
// that is accepted therefore passes the point P = sum w_k x_k, w_k >= 0, at a distance along x of no more
// than sum w_k (2 u |X_k| + 9 u |S Z_k|). X_k is P's own X but for the triangle's extent e, and |S| P's Z the
// ray's t |d_x|: so 11 u t |d_x| + 2 u e_x + 9 u e_z. The first part is in the pad of the slab test (kFarPad,
// shaders/traversal/ray.glsl), the second is this: 16 u of the largest extent, which leaves room for the
// weights' own errors in t. Tight boxes lose hits where a triangle is far longer than the ray's way to it,
// and with them the ray leaves a closed mesh (tests/render/tree_leaks_test.cpp).
inline float edgeMargin(const Box& tight) {
    const glm::dvec3 extent = glm::dvec3(tight.hi) - glm::dvec3(tight.lo);
    return static_cast<float>(16 * 0x1p-24 * std::max({extent.x, extent.y, extent.z}));
}

template <typename Row>
bool sameBits(const Row& a, const Row& b) {
    return std::memcmp(&a, &b, sizeof(Row)) == 0;
}

// Rounds to fp32; nothing if a component is not finite or beyond fp32.
std::optional<glm::vec3> roundPoint(const glm::dvec3& point);
// Sets one axis of a box, outwards by one float.
void setRounded(Box& box, int axis, double lo, double hi);
inline Box withEdgeMargin(Box tight) {
    const float margin = edgeMargin(tight);
    tight.lo -= margin;
    tight.hi += margin;
    return tight;
}

// Rounds world - origin to fp32; nothing if a component is not finite or beyond fp32.
std::optional<Corners> roundTriangle(const std::array<glm::dvec3, 3>& world, const glm::dvec3& origin);

// The three unit vertex normals of a triangle; false if any of them is missing, zero or not finite.
bool vertexNormals(const Mesh* mesh, uint32_t face, shared::VertexNormals& out);

// Point, radius and anchor normal; anchored as shared/primitives.h describes it if the eye is nearer to the
// surface than radius / 64: then centre and radius would cancel 6 and more of fp32's 24 bits.
shared::Sphere roundSphere(const SphereShape& sphere, const Frame& frame);
// Encloses the rounded sphere, anchored or not.
Box sphereBox(const shared::Sphere& sphere);

shared::Disc roundDisc(const DiscShape& disc, const Frame& frame);
Box discBox(const shared::Disc& disc);
// How far a disc reaches from its centre along each axis. normal: any length but zero.
glm::dvec3 discExtent(const glm::dvec3& normal, double radius);

// World box of the clipped surface: exact for the named forms, of a general quadric that of its clipping box.
Extent quadricExtent(const Object& object);

// The object's geometry rounded to fp32: everything of shared::Quadric except its ids and material. The
// rounded numbers define the surface; it differs from the exact one by 2^-24 of the distance from `point` and
// of the object's size.
shared::Quadric roundQuadric(const Object& object, const Frame& frame);

// Encloses the rounded quadric.
Box quadricBox(const Object& object, const Frame& frame, const shared::Quadric& rounded);

// Its own vertices without the repetitions of the device's array; nothing if one of them is not finite or
// beyond fp32.
std::optional<std::vector<glm::vec3>> roundPolygon(const PolygonShape& polygon, const glm::dvec3& origin);
// Widens to double for polygonPlane.
std::vector<glm::dvec3> widened(const std::vector<glm::vec3>& vertices);
// Encloses the outline and what of the plane, as the device has it, lies opposite to its vertices.
Box polygonBox(const std::vector<glm::vec3>& vertices, const glm::vec3& point, const glm::vec3& normal);
// Loop trips that the device takes around the outline.
uint32_t polygonTrips(size_t vertices);

// Entries of the BVH in the order of ids.
struct Primitives {
    struct Source {
        uint32_t object, face;
    };
    std::vector<Box> boxes;      // of the rounded primitives
    std::vector<uint8_t> kinds;  // shared::kKind...
    std::vector<Source> sources;
    std::array<uint32_t, shared::kKindCount> counts{};  // of each kind
};

// Throws Error(Scene) if count passes limit; `what` is the array's name.
void checkLimit(const char* what, uint64_t count, uint64_t limit);

// ---- A kind of primitive: one packer for each of shaders/shared/primitives.h, in a file of
// src/pack/primitives/

// Which materials something packed has; may be used by many threads.
class Materials {
  public:
    explicit Materials(size_t count) : used_(count) {}
    bool used(size_t material) const { return used_[material].load(std::memory_order_relaxed); }
    void use(size_t material) {
        // Read first: many threads writing the same byte would pass its cache line around.
        if (!used(material)) used_[material].store(true, std::memory_order_relaxed);
    }

  private:
    std::vector<std::atomic<bool>> used_;
};

// Rows that primitives have in further arrays; where the next ones begin.
struct FurtherRows {
    uint32_t normals = 0, polygonVertices = 0, attributes = 0;
};

// The scene on its way into the arrays.
struct Packing {
    const Scene& scene;
    const PrimitiveNumbers& numbers;
    const Frame& frame;
    PackedScene& packed;
    Materials& materials;

    const Object& objectOf(Primitives::Source source) const { return scene.objects[source.object]; }
    // Id, object and material of a primitive that is an object by itself.
    template <class Primitive>
    void identify(Primitives::Source source, Primitive& primitive) const {
        primitive.id = numbers.firstId(source.object);
        primitive.object = source.object;
        primitive.material = objectOf(source).material;
        materials.use(primitive.material);
    }
};

class KindPacker {
  public:
    virtual ~KindPacker() = default;

    // True for the shapes that become primitives of this kind, where no transform makes them instances.
    virtual bool packs(const Shape& shape) const = 0;

    // ---- On the way in. `face`: of a mesh, else 0.

    virtual PrimitiveStatus statusOf(const Object&, uint32_t /*face*/, const Frame&) const {
        return PrimitiveStatus::Kept;
    }
    // Takes in where the faces from begin to end are in the world.
    virtual void extend(const Object& object, uint32_t begin, uint32_t end, Extent& extent) const = 0;
    // Box of a kept primitive: contains the rounded primitive and everything that the device's test may
    // accept.
    virtual Box box(const Object& object, uint32_t face, const Frame& frame) const = 0;
    // True if the row is the same from both eyes, `before` and `after`.
    virtual bool isSameFrom(const Object&, const Frame& /*before*/, const Frame& /*after*/) const {
        return true;
    }
    // Adds the rows that the primitive will have in further arrays.
    virtual void count(const Packing&, Primitives::Source, FurtherRows&) const {}
    // Writes the primitive to place `slot` of its array, and its further rows from `next` on, which moves
    // behind them.
    virtual void write(const Packing& packing, Primitives::Source source, uint32_t slot,
                       FurtherRows& next) const = 0;

    // ---- Of a packed primitive, in its own coordinates

    // Balls that together reach as far as it does: visit(centre, radius). None of what has no end.
    using VisitBall = std::function<void(const glm::dvec3& center, double radius)>;
    virtual void balls(const PackedScene&, uint32_t /*index*/, const VisitBall&) const {}
    // How often its surface winds round the point; closed surfaces together do so a whole number of times. 1
    // or 0 for a solid by itself, the sum of windingOf for a part of a surface. Not of triangles, see
    // mediaAt.
    virtual double windings(const PackedScene&, uint32_t /*index*/, const glm::dvec3& /*point*/) const {
        return 0;
    }
};

// A kind whose objects become one row of `rows` each.
template <class Row, std::vector<Row> PackedScene::*rows>
class RowPacker : public KindPacker {
  public:
    bool isSameFrom(const Object& object, const Frame& before, const Frame& after) const final {
        return sameBits(rounded(object, before), rounded(object, after));
    }
    void write(const Packing& packing, Primitives::Source source, uint32_t slot, FurtherRows&) const final {
        Row& row = (packing.packed.*rows)[slot];
        row = rounded(packing.objectOf(source), packing.frame);
        packing.identify(source, row);
    }

  protected:
    // The row without id, object and material.
    virtual Row rounded(const Object& object, const Frame& frame) const = 0;
};

// The map of a quadric or box into its own coordinates.
template <class Solid>
glm::dmat3 toLocal(const Solid& solid) {
    return glm::transpose(
        glm::dmat3(glm::dvec3(solid.toLocal0), glm::dvec3(solid.toLocal1), glm::dvec3(solid.toLocal2)));
}
// Visits the corners of the box that clips a solid, as balls without radius.
template <class Solid>
void visitCorners(const Solid& solid, const glm::dmat3& toWorld, const KindPacker::VisitBall& visit) {
    const glm::vec3 &lo = solid.lo, &hi = solid.hi;
    for (int i = 0; i < 8; ++i)
        visit(glm::dvec3(solid.point) +
                  toWorld * glm::dvec3(i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z),
              0);
}

// The solid angle of a triangle, from 0, over that of the whole sphere; positive if 0 is on its inner side
// (A. van Oosterom, J. Strackee 1983, see mediaAt).
double windingOf(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

const KindPacker& packerOf(shared::PrimitiveKind kind);

// Kind of the object's primitives: instances if its shape cannot absorb its transform.
shared::PrimitiveKind kindOf(const Object& object);

// Defined with the kind: const KindPacker& packerOfTriangle(), ...
#define GLINT_PACKER(number, Kind, KINDS, kinds, one, many) const KindPacker& packerOf##Kind();
GLINT_PRIMITIVES(GLINT_PACKER, GLINT_PACKER)
#undef GLINT_PACKER

}  // namespace glint
