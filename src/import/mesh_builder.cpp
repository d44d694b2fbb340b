#include "import/mesh_builder.h"

#include <algorithm>
#include <numeric>

#include "core/quantize.h"
#include "core/text_file.h"
#include "core/vectors.h"
#include "import/polygon_split.h"
#include "import/text_scanner.h"

namespace glint {

namespace {

constexpr glm::uvec3 kNoCorners(Mesh::kNoIndex);

bool areNone(const std::vector<glm::uvec3>& corners) {
    return std::ranges::all_of(corners, [](const glm::uvec3& c) { return c == kNoCorners; });
}

std::string counted(size_t count, const char* singular, const char* plural) {
    return std::to_string(count) + " " + (count == 1 ? singular : plural);
}

bool hasThreeDifferent(const std::vector<uint32_t>& corners) {
    if (corners.size() < 3) return false;
    // Neighbours differ already, so the first two count; any third corner differs from both.
    return std::any_of(corners.begin(), corners.end(),
                       [&](uint32_t corner) { return corner != corners[0] && corner != corners[1]; });
}

}  // namespace

void MeshBuilder::reserve(size_t triangles) {
    mesh_.corners.reserve(triangles);
    if (!normals.empty()) mesh_.normalCorners.reserve(triangles);
    if (!uvs.empty()) mesh_.uvCorners.reserve(triangles);
    if (!colors.empty()) mesh_.colorCorners.reserve(triangles);
}

void MeshBuilder::addTriangle(uint32_t a, uint32_t b, uint32_t c, uint32_t material) {
    const auto pick = [&](const std::vector<uint32_t>& from) {
        return from.empty() ? kNoCorners : glm::uvec3(from[a], from[b], from[c]);
    };
    mesh_.corners.push_back(pick(corners_));
    if (!normals.empty()) mesh_.normalCorners.push_back(pick(normalCorners_));
    if (!uvs.empty()) mesh_.uvCorners.push_back(pick(uvCorners_));
    if (!colors.empty()) mesh_.colorCorners.push_back(pick(colorCorners_));
    keepFace(mesh_.corners.size() - 1);
    keepMaterial(mesh_.corners.size() - 1, material);
}

// The list of faces stays empty as long as each triangle is the face of its own number.
void MeshBuilder::keepFace(size_t triangle) {
    if (mesh_.faces.empty()) {
        if (polygons_ == triangle) return;
        mesh_.faces.resize(triangle);
        std::iota(mesh_.faces.begin(), mesh_.faces.end(), 0u);
    }
    mesh_.faces.push_back(polygons_);
}

// The list of materials starts with the first triangle that has one.
void MeshBuilder::keepMaterial(size_t triangle, uint32_t material) {
    if (mesh_.materials.empty()) {
        if (material == Mesh::kNoIndex) return;
        mesh_.materials.resize(triangle, Mesh::kNoIndex);
    }
    mesh_.materials.push_back(material);
}

void MeshBuilder::addPolygon(const Corners& polygon, uint32_t material) {
    for (auto* scratch : {&corners_, &normalCorners_, &uvCorners_, &colorCorners_}) scratch->clear();
    const auto& corners = polygon.vertices;
    for (size_t i = 0; i < corners.size(); i++) {
        if (corners[i] == corners[(i + 1) % corners.size()]) continue;  // a repeated corner
        corners_.push_back(corners[i]);
        if (!polygon.normals.empty()) normalCorners_.push_back(polygon.normals[i]);
        if (!polygon.uvs.empty()) uvCorners_.push_back(polygon.uvs[i]);
        if (!polygon.colors.empty()) colorCorners_.push_back(polygon.colors[i]);
    }
    if (!hasThreeDifferent(corners_)) {
        degenerate_++;
    } else if (corners_.size() == 3) {
        addTriangle(0, 1, 2, material);
    } else {
        points_.clear();
        triangles_.clear();
        for (const uint32_t corner : corners_) points_.push_back(positions[corner]);
        if (!splitPolygon(points_, triangles_)) crossing_++;
        for (const auto& [a, b, c] : triangles_) addTriangle(a, b, c, material);
    }
    polygons_++;
}

void MeshBuilder::decodeColors(const std::string& file, std::vector<std::string>& warnings) {
    const auto isBad = [](const Color& c) { return !(c.x >= 0 && c.y >= 0 && c.z >= 0); };
    double greatest = 0;
    size_t bad = 0;
    for (Color& color : colors) {
        bad += isBad(color);
        if (isBad(color)) color = kNoColor;
        if (color != kNoColor) greatest = std::max({greatest, color.x, color.y, color.z});
    }
    if (bad > 0)
        warnings.push_back(file + ": " + counted(bad, "vertex colour is", "vertex colours are") +
                           " negative or no number; white is used");
    const bool integers = colorCodes == ColorCodes::Integers;
    const bool codes = integers || greatest > 2;
    if (codes && !integers)
        warnings.push_back(file + ": colours up to " + describe(greatest) +
                           " are taken as codes, not fractions");
    const double white = !codes ? 1 : greatest <= 255 ? 255 : greatest <= 65535 ? 65535 : 4294967295.0;
    for (Color& color : colors) {
        if (color == kNoColor)
            color = Color(1);
        else if (codes || colorCodes == ColorCodes::Srgb)
            for (int i = 0; i < 3; i++) color[i] = linearFromSrgb(color[i] / white);
    }
}

// A normal that is not finite would spread through the shading; the triangle is flat without it.
void MeshBuilder::dropBadNormals() {
    const auto bad = [this](uint32_t index) { return !isFinite(normals[index]); };
    for (glm::uvec3& corners : mesh_.normalCorners) {
        if (corners == kNoCorners || !(bad(corners.x) || bad(corners.y) || bad(corners.z))) continue;
        corners = kNoCorners;
        badNormals_++;
    }
    if (areNone(mesh_.normalCorners)) {
        mesh_.normalCorners.clear();
        normals.clear();
    }
}

void MeshBuilder::assignDefaultMaterial(std::vector<Material>& materials) {
    const auto missing = [](uint32_t material) { return material == Mesh::kNoIndex; };
    if (mesh_.materials.empty()) {
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

void MeshBuilder::finishAttributes() {
    for (auto* list : {&mesh_.uvCorners, &mesh_.colorCorners})
        if (areNone(*list)) list->clear();
    if (!mesh_.uvCorners.empty()) mesh_.uvs = std::move(uvs);
    if (!mesh_.colorCorners.empty()) mesh_.colors = std::move(colors);
}

ImportedMesh MeshBuilder::finish(const std::string& file, std::vector<Material> materials,
                                 std::vector<std::string> warnings) {
    if (polygons_ == 0) failFile(file, "holds no faces; points and lines cannot be rendered");
    if (mesh_.corners.empty()) failFile(file, "no face has three different vertices");
    dropBadNormals();
    decodeColors(file, warnings);
    finishAttributes();
    assignDefaultMaterial(materials);
    if (degenerate_ > 0)
        warnings.push_back(file + ": " + counted(degenerate_, "face", "faces") +
                           " with fewer than three different vertices left out");
    if (crossing_ > 0)
        warnings.push_back(file + ": " + counted(crossing_, "face crosses itself", "faces cross themselves") +
                           ": the triangles that they are split into overlap");
    if (badNormals_ > 0)
        warnings.push_back(file + ": the vertex normals of " + counted(badNormals_, "triangle", "triangles") +
                           " are not finite and are not used");
    mesh_.positions = std::move(positions);
    mesh_.normals = std::move(normals);
    return {std::move(mesh_), std::move(materials), {}, std::move(warnings)};
}

}  // namespace glint
