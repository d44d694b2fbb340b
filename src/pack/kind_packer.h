// Packing interface of a kind of primitive: one object for each kind of shaders/shared/primitives.h, each in
// a file of src/pack/primitives/.
#pragma once

#include <functional>

#include "pack/extent.h"
#include "pack/pack_geometry.h"
#include "pack/packed_scene.h"
#include "pack/primitives.h"

namespace glint {

// Outcome for a primitive: absent without a warning, kept, or dropped with a warning.
enum class Fate : uint8_t { Absent, Kept, NoArea, NotFinite };

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

    virtual Fate judge(const Object&, uint32_t /*face*/, const Frame&) const { return Fate::Kept; }
    // Takes in where the faces from begin to end are in the world.
    virtual void extend(const Object& object, uint32_t begin, uint32_t end, Extent& extent) const = 0;
    // Box of a kept primitive: contains the rounded primitive and everything that the device's test may
    // accept.
    virtual Box box(const Object& object, uint32_t face, const Frame& frame) const = 0;
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
    // How often its surface goes round the point, which closed surfaces together do a whole number of times:
    // 1 or 0 for a solid by itself, the sum of windingOf for a part of a surface. Not of triangles, which
    // mediaAt knows.
    virtual double windings(const PackedScene&, uint32_t /*index*/, const glm::dvec3& /*point*/) const {
        return 0;
    }
};

// The solid angle of a triangle, seen from 0, over that of the whole sphere; positive if its outer side is
// turned away (A. van Oosterom, J. Strackee 1983, see mediaAt).
double windingOf(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

const KindPacker& packerOf(shared::PrimitiveKind kind);

// Kind of the object's primitives: instances if its shape cannot absorb its transform.
shared::PrimitiveKind kindOf(const Object& object);

// Defined with the kind: const KindPacker& packerOfTriangle(), ...
#define GLINT_PACKER(number, Kind, kinds, one, many) const KindPacker& packerOf##Kind();
GLINT_PRIMITIVES(GLINT_PACKER, GLINT_PACKER)
#undef GLINT_PACKER

}  // namespace glint
