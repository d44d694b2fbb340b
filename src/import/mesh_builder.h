// Splits the polygons of a mesh file into triangles and collects them.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "import/readers.h"
#include "import/text_scanner.h"

namespace glint {

// Indices of what a corner of a polygon has, in range; kNoIndex for attributes that the polygon lacks.
struct MeshCorner {
    uint32_t vertex = Mesh::kNoIndex, normal = Mesh::kNoIndex, uv = Mesh::kNoIndex, color = Mesh::kNoIndex;
};

class MeshBuilder {
  public:
    explicit MeshBuilder(const std::string& file) : warnings(file, result.warnings), file_(file) {}

    // The reader fills materials, textures and the attributes of vertices. Positions must be complete before
    // the first polygon that uses them is added. Colours are as they stand in the file, kNoColor for white.
    ImportedMesh result;
    FileWarnings warnings;
    // Integers and Srgb are sRGB codes. White is 1 for Srgb, and for Integers the least of 255, 65535 and
    // 2^32 - 1 that holds all values. Colours above 2 are taken as Integers.
    enum class ColorCodes { Linear, Srgb, Integers } colorCodes = ColorCodes::Linear;
    static constexpr Color kNoColor{std::numeric_limits<double>::infinity()};

    // Drops and counts polygons with fewer than three different vertices. If all polygons have the material
    // kNoIndex, the mesh has no materials.
    void addPolygon(std::span<const MeshCorner> corners, uint32_t material = Mesh::kNoIndex);

    void reserve(size_t triangles) { result.mesh.corners.reserve(triangles); }

    // Moves the result out. Throws Error(Scene) if there is no triangle. Polygons without a material get a
    // default one if others have one.
    ImportedMesh finish();

  private:
    void addTriangle(const MeshCorner& a, const MeshCorner& b, const MeshCorner& c, uint32_t material);
    void decodeColors();
    void dropBadNormals();
    void assignDefaultMaterial();

    const std::string file_;
    uint32_t polygons_ = 0;
    size_t degenerate_ = 0;
    size_t crossing_ = 0;
    // Scratch of addPolygon.
    std::vector<MeshCorner> corners_;
    std::vector<glm::dvec3> points_;
    std::vector<std::array<uint32_t, 3>> triangles_;
};

// Clears the attributes that no triangle of the mesh has.
void dropUnusedAttributes(Mesh& mesh);

// Splits the polygon with these corners (three or more) into size - 2 triangles of the same winding and
// appends them to `triangles` as indices into `corners`. A convex polygon becomes a fan about its first
// corner; other simple polygons are cut by ear clipping. For polygons that cross themselves or have no area
// the triangles are arbitrary, but the function returns. The projection along the Newell normal's greatest
// axis decides for polygons that are not planar.
//
// False if some triangles are turned over: then the polygon crosses itself, since triangles of its own
// corners that all face one way form a disc. Does not detect a polygon that overlaps itself without turning
// over, like a roll of tape.
bool splitPolygon(std::span<const glm::dvec3> corners, std::vector<std::array<uint32_t, 3>>& triangles);

}  // namespace glint
