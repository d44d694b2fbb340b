// The primitives of a scene, numbered and rounded to fp32; internal to the packing.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "bvh/builder.h"
#include "pack/packed_scene.h"
#include "scene/scene.h"
#include "shared/layout.h"

namespace glint {

// Ids are consecutive over objects and, within a mesh, over its triangles; every primitive has one, packed or
// not. Items are what is packed: the primitives, and an instance as a whole.
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
    bool any() const { return triangle_ != nullptr || mesh_ != nullptr; }
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

class Instances;

// Viewpoint of the packed scene, for bounds on rounding errors.
struct Frame {
    glm::dvec3 origin{0};
    glm::dvec3 eye{0};                     // world
    const Instances* instances = nullptr;  // placed
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

// Rounds to fp32; nothing if a component is not finite or beyond fp32.
std::optional<glm::vec3> roundPoint(const glm::dvec3& point);
// Sets one axis of a box, outwards by the margin and one float.
void setRounded(Box& box, int axis, double center, double extent, double margin);
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

// Point, radius and anchor normal; anchored as shared/layout.h describes it if the eye is nearer to the
// surface than radius / 64: then centre and radius would cancel 6 and more of fp32's 24 bits.
shared::Sphere roundSphere(const SphereShape& sphere, const Frame& frame);
shared::Cuboid roundCuboid(const Object& object, const Frame& frame);
// Encloses the rounded sphere, whatever its form.
Box sphereBox(const shared::Sphere& sphere);

shared::Disc roundDisc(const DiscShape& disc, const Frame& frame);
Box discBox(const shared::Disc& disc);
// How far a disc reaches from its centre along each axis. normal: any length but zero.
glm::dvec3 discExtent(const glm::dvec3& normal, double radius);

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

}  // namespace glint
