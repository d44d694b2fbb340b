// Visits of a packed scene's arrays and kinds of primitives, generated from the lists of shaders/shared, so
// that no file has a list of its own.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <vector>

#include "pack/packed_scene.h"

namespace glint {

// visit(name, array) for each array of the scene, the tree's nodes among them.
template <class Visit, class Packed = PackedScene>
void visitArrays(const Packed& scene, const Visit& visit) {
#define GLINT_VISIT(binding, field, Struct, ROWS) \
    if constexpr (requires { scene.field.data(); }) visit(#field, scene.field);
    GLINT_SCENE_ARRAYS(GLINT_VISIT)
#undef GLINT_VISIT
}

// Name and count of a kind of primitive.
struct KindCount {
    shared::PrimitiveKind kind;
    const char* array;       // of PackedScene
    const char *one, *many;  // for people
    size_t count;            // a triangle that was split for the tree is one; instances as such
};

// visit(KindCount) for each kind, in the order of their numbers.
template <class Visit>
void visitKinds(const PackedScene& scene, const Visit& visit) {
#define GLINT_VISIT(number, Kind, KINDS, kinds, one, many) \
    visit(KindCount{                                       \
        shared::PrimitiveKind::Kind, #kinds, #one, #many,  \
        scene.kinds.size() -                               \
            (shared::kKind##Kind == shared::kKindTriangle ? scene.statistics.splitTriangles : 0)});
    GLINT_PRIMITIVES(GLINT_VISIT, GLINT_VISIT)
#undef GLINT_VISIT
}

// visit(kind, array) for each kind, with the array of its primitives.
template <class Packed, class Visit>
void visitPrimitiveArrays(Packed& scene, const Visit& visit) {
#define GLINT_VISIT(number, Kind, KINDS, kinds, one, many) visit(shared::PrimitiveKind::Kind, scene.kinds);
    GLINT_PRIMITIVES(GLINT_VISIT, GLINT_VISIT)
#undef GLINT_VISIT
}

// Calls visit with primitive `index` of a kind, as shared::Triangle, shared::Sphere, ... `scene`: anything
// with an array for each kind.
template <class Packed, class Visit>
decltype(auto) visitPrimitive(const Packed& scene, shared::PrimitiveKind kind, uint32_t index,
                              Visit&& visit) {
    switch (kind) {
#define GLINT_VISIT(number, Kind, KINDS, kinds, one, many) \
    case shared::PrimitiveKind::Kind:                      \
        return visit(scene.kinds[index]);
        GLINT_PRIMITIVES(GLINT_VISIT, GLINT_VISIT)
#undef GLINT_VISIT
    }
    throw std::logic_error("no such kind of primitive");
}

inline shared::PrimitiveKind kindOfLeaf(uint32_t leaf) {
    return static_cast<shared::PrimitiveKind>(leaf >> shared::kLeafKindShift & shared::kLeafKindMask);
}
inline shared::PrimitiveKind kindOfPrimitive(uint32_t primitive) {
    return static_cast<shared::PrimitiveKind>(primitive >> shared::kPrimitiveKindShift);
}

// Calls visit(kind, index) for each primitive of the tree with this root.
template <class Nodes, class Visit>
void visitLeaves(const Nodes& nodes, uint32_t root, const Visit& visit) {
    std::vector<uint32_t> pending{root};
    while (!pending.empty()) {
        const uint32_t child = pending.back();
        pending.pop_back();
        if (child == shared::kNone) continue;
        if (!(child & shared::kLeafFlag)) {
            pending.push_back(nodes[child].child0);
            pending.push_back(nodes[child].child1);
            continue;
        }
        const uint32_t first = child & shared::kLeafFirstMask;
        const uint32_t last = first + (child >> shared::kLeafCountShift & shared::kLeafCountMask);
        for (uint32_t i = first; i <= last; ++i) visit(kindOfLeaf(child), i);
    }
}

}  // namespace glint
