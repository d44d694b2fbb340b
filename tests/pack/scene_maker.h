// Small scenes to pack.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace glint::test {

inline uint32_t addObject(Scene& scene, Shape shape, uint32_t material = 0) {
    if (scene.materials.empty()) scene.materials.resize(1);
    const auto index = static_cast<uint32_t>(scene.objects.size());
    scene.objects.push_back({"/objects/" + std::to_string(index), std::move(shape), material});
    return index;
}

// cells x cells squares of two triangles each over [0, cells] x [0, cells] in the plane z = 0, shifted by
// `offset`, all facing +z.
inline std::shared_ptr<Mesh> gridMesh(uint32_t cells, const glm::dvec3& offset = glm::dvec3(0)) {
    auto mesh = std::make_shared<Mesh>();
    for (uint32_t y = 0; y <= cells; ++y)
        for (uint32_t x = 0; x <= cells; ++x) mesh->positions.push_back(offset + glm::dvec3(x, y, 0));
    for (uint32_t y = 0; y < cells; ++y) {
        for (uint32_t x = 0; x < cells; ++x) {
            const uint32_t a = y * (cells + 1) + x, b = a + 1, c = a + cells + 1, d = c + 1;
            mesh->corners.push_back({a, b, d});
            mesh->corners.push_back({a, d, c});
        }
    }
    return mesh;
}

}  // namespace glint::test
