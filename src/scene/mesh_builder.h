// Collects the polygons of a mesh file as triangles.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "scene/importers.h"

namespace glint {

class MeshBuilder {
  public:
    // Filled by the reader; positions must be complete before the first polygon that uses them is added.
    std::vector<glm::dvec3> positions;
    std::vector<glm::dvec3> normals;

    // `corners` index positions, `normalCorners` index normals and is empty or as long; indices must be in
    // range. Fewer than three different corners: dropped and counted. `material` counts only if some
    // polygon's differs from kNoIndex.
    void addPolygon(std::span<const uint32_t> corners, std::span<const uint32_t> normalCorners,
                    uint32_t material = Mesh::kNoIndex);

    void reserve(size_t triangles);

    // The mesh, with warnings that start with `file`. Throws Error(Scene) if there is no triangle. Polygons
    // without a material get a default one if others have one.
    ImportedMesh finish(const std::string& file, std::vector<Material> materials,
                        std::vector<std::string> warnings);

  private:
    void addTriangle(const glm::uvec3& corners, const glm::uvec3& normalCorners, uint32_t material);
    void dropBadNormals();
    void assignDefaultMaterial(std::vector<Material>& materials);

    Mesh mesh_;
    uint32_t polygons_ = 0;
    size_t degenerate_ = 0;
    size_t badNormals_ = 0;
    // Scratch of addPolygon.
    std::vector<uint32_t> corners_, normalCorners_;
    std::vector<glm::dvec3> points_;
    std::vector<std::array<uint32_t, 3>> triangles_;
};

}  // namespace glint
