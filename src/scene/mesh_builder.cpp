#include "scene/mesh_builder.h"

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "scene/polygon_split.h"

namespace glint {

namespace {

constexpr glm::uvec3 kNoNormals(Mesh::kNoIndex);

std::string counted(size_t count, const char* singular, const char* plural) {
    return std::to_string(count) + " " + (count == 1 ? singular : plural);
}

bool hasThreeDifferent(const std::vector<uint32_t>& corners) {
    if (corners.size() < 3) return false;
    // Neighbours differ already, so the first two are two; what is wanted is one that is neither.
    return std::any_of(corners.begin(), corners.end(),
                       [&](uint32_t corner) { return corner != corners[0] && corner != corners[1]; });
}

}  // namespace

void MeshBuilder::reserve(size_t triangles) {
    mesh_.corners.reserve(triangles);
    mesh_.faces.reserve(triangles);
    mesh_.materials.reserve(triangles);
    if (!normals.empty()) mesh_.normalCorners.reserve(triangles);
}

void MeshBuilder::addTriangle(const glm::uvec3& corners, const glm::uvec3& normalCorners, uint32_t material) {
    mesh_.corners.push_back(corners);
    if (!normals.empty()) mesh_.normalCorners.push_back(normalCorners);
    mesh_.faces.push_back(polygons_);
    mesh_.materials.push_back(material);
}

void MeshBuilder::addPolygon(std::span<const uint32_t> corners, std::span<const uint32_t> normalCorners,
                             uint32_t material) {
    const bool smooth = !normalCorners.empty();
    corners_.clear();
    normalCorners_.clear();
    for (size_t i = 0; i < corners.size(); i++) {
        if (corners[i] == corners[(i + 1) % corners.size()])
            continue;  // a corner repeated at once is no corner
        corners_.push_back(corners[i]);
        if (smooth) normalCorners_.push_back(normalCorners[i]);
    }
    if (!hasThreeDifferent(corners_)) {
        degenerate_++;
    } else if (corners_.size() == 3) {
        addTriangle({corners_[0], corners_[1], corners_[2]},
                    smooth ? glm::uvec3(normalCorners_[0], normalCorners_[1], normalCorners_[2]) : kNoNormals,
                    material);
    } else {
        points_.clear();
        triangles_.clear();
        for (const uint32_t corner : corners_) points_.push_back(positions[corner]);
        splitPolygon(points_, triangles_);
        for (const auto& [a, b, c] : triangles_)
            addTriangle(
                {corners_[a], corners_[b], corners_[c]},
                smooth ? glm::uvec3(normalCorners_[a], normalCorners_[b], normalCorners_[c]) : kNoNormals,
                material);
    }
    polygons_++;
}

// A normal that is not finite would spread through the shading; the triangle is flat without it.
void MeshBuilder::dropBadNormals() {
    const auto bad = [this](uint32_t index) {
        const glm::dvec3& n = normals[index];
        return !std::isfinite(n.x) || !std::isfinite(n.y) || !std::isfinite(n.z);
    };
    for (glm::uvec3& corners : mesh_.normalCorners) {
        if (corners == kNoNormals || !(bad(corners.x) || bad(corners.y) || bad(corners.z))) continue;
        corners = kNoNormals;
        badNormals_++;
    }
    const auto none = [](const glm::uvec3& corners) { return corners == kNoNormals; };
    if (std::all_of(mesh_.normalCorners.begin(), mesh_.normalCorners.end(), none)) {
        mesh_.normalCorners.clear();
        normals.clear();
    }
}

void MeshBuilder::assignDefaultMaterial(std::vector<Material>& materials) {
    const auto missing = [](uint32_t material) { return material == Mesh::kNoIndex; };
    if (std::all_of(mesh_.materials.begin(), mesh_.materials.end(), missing)) {
        mesh_.materials.clear();
        materials.clear();
        return;
    }
    if (std::none_of(mesh_.materials.begin(), mesh_.materials.end(), missing)) return;
    Material material;
    material.name = "default";
    std::replace(mesh_.materials.begin(), mesh_.materials.end(), Mesh::kNoIndex,
                 static_cast<uint32_t>(materials.size()));
    materials.push_back(material);
}

ImportedMesh MeshBuilder::finish(const std::string& file, std::vector<Material> materials,
                                 std::vector<std::string> warnings) {
    if (polygons_ == 0)
        throw Error(ExitCode::Scene, file + ": holds no faces; points and lines cannot be rendered");
    if (mesh_.corners.empty()) throw Error(ExitCode::Scene, file + ": no face has three different vertices");
    dropBadNormals();
    assignDefaultMaterial(materials);
    if (degenerate_ > 0)
        warnings.push_back(file + ": " + counted(degenerate_, "face", "faces") +
                           " with fewer than three different vertices left out");
    if (badNormals_ > 0)
        warnings.push_back(file + ": the vertex normals of " + counted(badNormals_, "triangle", "triangles") +
                           " are not finite and are not used");
    bool identity = true;
    for (size_t i = 0; i < mesh_.faces.size() && identity; i++) identity = mesh_.faces[i] == i;
    if (identity) mesh_.faces.clear();
    mesh_.positions = std::move(positions);
    mesh_.normals = std::move(normals);
    return {std::move(mesh_), std::move(materials), {}, std::move(warnings)};
}

}  // namespace glint
