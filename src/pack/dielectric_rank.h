// Marks the ids of dielectrics, so that of surfaces in one place the opaque ones come first.
#pragma once

#include <cstdint>
#include <set>

#include "pack/scene_arrays.h"

namespace glint {

// Sets kDielectricRank in the ids of primitives whose material is a dielectric. Where an instance has a
// material of its own, idBase has the bit and its primitives have not.
// `scene`: the arrays of a PackedScene or of the reference's model; `nodes`: its trees.
template <class Arrays, class Nodes>
void rankDielectrics(Arrays& scene, const Nodes& nodes) {
    const auto rankOf = [&](uint32_t material) {
        return scene.materials[material].medium != 0 ? shared::kDielectricRank : 0u;
    };
    for (size_t i = 0; i < scene.triangles.size(); ++i)
        scene.triangles[i].id |= rankOf(scene.triangleSurfaces[i].material);
    visitPrimitiveArrays(scene, [&](shared::PrimitiveKind, auto& array) {
        for (auto& one : array)
            if constexpr (requires { one.id, one.material; }) one.id |= rankOf(one.material);
    });
    std::set<uint32_t> seen;
    for (auto& instance : scene.instances) {
        if (instance.material == shared::kNone) continue;
        instance.idBase |= rankOf(instance.material);
        if (!seen.insert(instance.root).second) continue;
        visitLeaves(nodes, instance.root, [&](shared::PrimitiveKind kind, uint32_t index) {
            const auto clear = [&](auto& array) {
                if constexpr (requires { array[index].id; }) array[index].id &= ~shared::kDielectricRank;
            };
            visitPrimitiveArrays(scene, [&](shared::PrimitiveKind each, auto& array) {
                if (each == kind) clear(array);
            });
        });
    }
}

// The id of a primitive of an instance.
inline uint32_t idInInstance(uint32_t idBase, uint32_t id) {
    return (idBase | (id & shared::kDielectricRank)) + (id & ~shared::kDielectricRank);
}

}  // namespace glint
