#include "import/mesh_builder.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/quantize.h"
#include "core/text_file.h"
#include "core/vectors.h"

namespace glint {

namespace {

constexpr glm::uvec3 kNoCorners(Mesh::kNoIndex);

// The lists of a mesh's triangles, by the index of a corner that they hold.
constexpr std::pair<uint32_t MeshCorner::*, std::vector<glm::uvec3> Mesh::*> kLists[] = {
    {&MeshCorner::vertex, &Mesh::corners},
    {&MeshCorner::normal, &Mesh::normalCorners},
    {&MeshCorner::uv, &Mesh::uvCorners},
    {&MeshCorner::color, &Mesh::colorCorners}};

bool hasThreeDifferent(const std::vector<MeshCorner>& corners) {
    if (corners.size() < 3) return false;
    // Neighbours differ already, so the first two count; any third corner differs from both.
    return std::ranges::any_of(corners, [&](const MeshCorner& corner) {
        return corner.vertex != corners[0].vertex && corner.vertex != corners[1].vertex;
    });
}

}  // namespace

void dropUnusedAttributes(Mesh& mesh) {
    const auto drop = [](auto& elements, std::vector<glm::uvec3>& corners) {
        if (std::ranges::any_of(corners, [](const glm::uvec3& c) { return c != kNoCorners; })) return;
        elements.clear();
        corners.clear();
    };
    drop(mesh.normals, mesh.normalCorners);
    drop(mesh.uvs, mesh.uvCorners);
    drop(mesh.colors, mesh.colorCorners);
}

void MeshBuilder::addTriangle(const MeshCorner& a, const MeshCorner& b, const MeshCorner& c,
                              uint32_t material) {
    Mesh& mesh = result.mesh;
    const size_t triangle = mesh.corners.size();
    for (const auto& [index, list] : kLists) {
        std::vector<glm::uvec3>& corners = mesh.*list;
        // The list of an attribute starts with the first triangle that has it.
        if (corners.empty() && a.*index == Mesh::kNoIndex) continue;
        if (corners.empty()) corners.reserve(mesh.corners.capacity());
        corners.resize(triangle, kNoCorners);
        corners.emplace_back(a.*index, b.*index, c.*index);
    }
    if (!mesh.materials.empty() || material != Mesh::kNoIndex) {
        mesh.materials.resize(triangle, Mesh::kNoIndex);
        mesh.materials.push_back(material);
    }
    // The list of faces stays empty as long as each triangle is the face of its own number.
    if (mesh.faces.empty() && polygons_ == triangle) return;
    for (size_t i = mesh.faces.size(); i < triangle; i++) mesh.faces.push_back(static_cast<uint32_t>(i));
    mesh.faces.push_back(polygons_);
}

void MeshBuilder::addPolygon(std::span<const MeshCorner> corners, uint32_t material) {
    corners_.clear();
    for (size_t i = 0; i < corners.size(); i++)
        if (corners[i].vertex != corners[(i + 1) % corners.size()].vertex) corners_.push_back(corners[i]);
    if (!hasThreeDifferent(corners_)) {
        degenerate_++;
    } else if (corners_.size() == 3) {
        addTriangle(corners_[0], corners_[1], corners_[2], material);
    } else {
        points_.clear();
        triangles_.clear();
        for (const MeshCorner& corner : corners_) points_.push_back(result.mesh.positions[corner.vertex]);
        if (!splitPolygon(points_, triangles_)) crossing_++;
        for (const auto& [a, b, c] : triangles_) addTriangle(corners_[a], corners_[b], corners_[c], material);
    }
    polygons_++;
}

void MeshBuilder::decodeColors() {
    double greatest = 0;
    size_t bad = 0;
    for (Color& color : result.mesh.colors) {
        if (!(color.x >= 0 && color.y >= 0 && color.z >= 0)) {
            bad++;
            color = kNoColor;
        }
        if (color != kNoColor) greatest = std::max({greatest, color.x, color.y, color.z});
    }
    if (bad > 0)
        warnings.add(counted(bad, "vertex colour"), (bad == 1 ? " is" : " are"),
                     " negative or no number; white is used");
    const bool integers = colorCodes == ColorCodes::Integers;
    const bool codes = integers || greatest > 2;
    if (codes && !integers)
        warnings.add("colours up to ", describe(greatest), " are taken as codes, not fractions");
    const double white = !codes ? 1 : greatest <= 255 ? 255 : greatest <= 65535 ? 65535 : 4294967295.0;
    for (Color& color : result.mesh.colors) {
        if (color == kNoColor)
            color = Color(1);
        else if (codes || colorCodes == ColorCodes::Srgb)
            for (int i = 0; i < 3; i++) color[i] = linearFromSrgb(color[i] / white);
    }
}

// A normal that is not finite would spread through the shading; the triangle is flat without it.
void MeshBuilder::dropBadNormals() {
    const auto bad = [this](uint32_t index) { return !isFinite(result.mesh.normals[index]); };
    size_t dropped = 0;
    for (glm::uvec3& corners : result.mesh.normalCorners) {
        if (corners == kNoCorners || !(bad(corners.x) || bad(corners.y) || bad(corners.z))) continue;
        corners = kNoCorners;
        dropped++;
    }
    if (dropped > 0)
        warnings.add("the vertex normals of ", counted(dropped, "triangle"),
                     " are not finite and are not used");
}

void MeshBuilder::assignDefaultMaterial() {
    std::vector<uint32_t>& used = result.mesh.materials;
    if (used.empty()) {
        result.materials.clear();
    } else if (std::ranges::find(used, Mesh::kNoIndex) != used.end()) {
        std::ranges::replace(used, Mesh::kNoIndex, static_cast<uint32_t>(result.materials.size()));
        result.materials.emplace_back().name = "default";
    }
}

ImportedMesh MeshBuilder::finish() {
    if (polygons_ == 0) failFile(file_, "holds no faces; points and lines cannot be rendered");
    if (result.mesh.corners.empty()) failFile(file_, "no face has three different vertices");
    if (degenerate_ > 0)
        warnings.add(counted(degenerate_, "face"), " with fewer than three different vertices left out");
    if (crossing_ > 0)
        warnings.add(counted(crossing_, "face"), (crossing_ == 1 ? " crosses itself" : " cross themselves"),
                     ": the triangles that they are split into overlap");
    dropBadNormals();
    decodeColors();
    dropUnusedAttributes(result.mesh);
    assignDefaultMaterial();
    return std::move(result);
}

// ---- Polygons into triangles

namespace {

using Point = glm::dvec2;

constexpr double kNoArea = 1e-9;  // of the square of a polygon's size

// Twice the signed area of a, b, c.
double area(const Point& a, const Point& b, const Point& c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

// The corners in a plane, counter-clockwise, relative to the first corner and in units of the polygon's size,
// so that coordinates far from the origin lose nothing and products neither over- nor underflow. Empty if
// that cannot be done.
std::vector<Point> project(std::span<const glm::dvec3> corners) {
    double size = 0;
    for (const glm::dvec3& corner : corners) {
        if (!isFinite(corner - corners[0])) return {};
        size = std::max(size, greatestMagnitude(corner - corners[0]));
    }
    if (size == 0) return {};
    std::vector<glm::dvec3> local;
    for (const glm::dvec3& corner : corners) local.push_back((corner - corners[0]) / size);

    // Newell's normal (Sutherland, Sproull, Schumacker 1974): the sum over edges of (p x q).
    glm::dvec3 normal(0);
    for (size_t i = 0; i < local.size(); i++) normal += glm::cross(local[i], local[(i + 1) % local.size()]);
    // A bow tie's halves cancel each other: then its plane is that of the corners that span most.
    if (glm::dot(normal, normal) < kNoArea * kNoArea)
        for (size_t i = 0; i < local.size(); i++) {
            const glm::dvec3 spanned = glm::cross(local[i], local[(i + 1) % local.size()]);
            if (glm::dot(spanned, spanned) > glm::dot(normal, normal)) normal = spanned;
        }
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (std::abs(normal[k]) > std::abs(normal[axis])) axis = k;
    // Dropping the axis keeps the orientation (x: y, z; y: z, x; z: x, y) if the normal points along it.
    int first = (axis + 1) % 3, second = (axis + 2) % 3;
    if (normal[axis] < 0) std::swap(first, second);
    std::vector<Point> points;
    for (const glm::dvec3& p : local) points.emplace_back(p[first], p[second]);
    return points;
}

// All turns to the left is not enough: a pentagram has them too, but its fan runs backwards somewhere.
bool isConvex(const std::vector<Point>& points) {
    const size_t n = points.size();
    for (size_t i = 0; i < n; i++) {
        if (area(points[i], points[(i + 1) % n], points[(i + 2) % n]) < 0) return false;
        if (i > 0 && i + 1 < n && area(points[0], points[i], points[i + 1]) < 0) return false;
    }
    return true;
}

// Ear clipping over a ring of the corners that are left (Meisters, Polygons have ears, Am. Math. Monthly 82,
// 1975). Cutting an ear changes only its neighbours (Eberly, Triangulation by Ear Clipping, 2002). The search
// for corners in an ear covers the reflex corners within its range of x.
class EarClipper {
  public:
    explicit EarClipper(const std::vector<Point>& points)
        : points_(points),
          next_(points.size()),
          previous_(points.size()),
          reflex_(points.size()),
          ear_(points.size()) {
        const auto n = static_cast<uint32_t>(points.size());
        for (uint32_t i = 0; i < n; i++) {
            next_[i] = (i + 1) % n;
            previous_[next_[i]] = i;
        }
        for (uint32_t i = 0; i < n; i++) {
            reflex_[i] = turn(i) <= 0;
            if (reflex_[i]) byX_.push_back(i);  // only reflex corners can lie inside an ear
        }
        std::ranges::sort(byX_, {}, [this](uint32_t i) { return points_[i].x; });
        for (uint32_t i = 0; i < n; i++) ear_[i] = isEar(i);
    }

    void clip(std::vector<std::array<uint32_t, 3>>& triangles) {
        uint32_t corner = 0;
        for (size_t left = points_.size(); left > 3; left--) {
            // The next ear along the ring. Without one all the way round the polygon crosses itself: then
            // this cuts the rest as a fan.
            for (size_t i = 0; i < left && !ear_[corner]; i++) corner = next_[corner];
            triangles.push_back({previous_[corner], corner, next_[corner]});
            remove(corner);
            corner = next_[corner];
        }
        triangles.push_back({previous_[corner], corner, next_[corner]});
    }

  private:
    // True if a reflex corner lies in the triangle or on its edge. Points in the same place as a corner do
    // not count: the corner itself, and points of a bridge to a hole, which the outline passes twice.
    bool anyWithin(const Point& a, const Point& b, const Point& c) const {
        const Point lo = glm::min(glm::min(a, b), c), hi = glm::max(glm::max(a, b), c);
        auto at = std::ranges::lower_bound(byX_, lo.x, {}, [this](uint32_t i) { return points_[i].x; });
        for (; at != byX_.end() && points_[*at].x <= hi.x; ++at) {
            const Point& p = points_[*at];
            if (!reflex_[*at] || p.y < lo.y || p.y > hi.y || p == a || p == b || p == c) continue;
            if (area(a, b, p) >= 0 && area(b, c, p) >= 0 && area(c, a, p) >= 0) return true;
        }
        return false;
    }

    double turn(uint32_t i) const { return area(points_[previous_[i]], points_[i], points_[next_[i]]); }

    bool isEar(uint32_t i) const {
        return turn(i) > 0 && !anyWithin(points_[previous_[i]], points_[i], points_[next_[i]]);
    }

    void remove(uint32_t i) {
        const uint32_t before = previous_[i], after = next_[i];
        next_[before] = after;
        previous_[after] = before;
        reflex_[i] = false;
        for (const uint32_t neighbour : {before, after})
            if (turn(neighbour) > 0) reflex_[neighbour] = false;
        for (const uint32_t neighbour : {before, after}) ear_[neighbour] = isEar(neighbour);
    }

    const std::vector<Point>& points_;
    std::vector<uint32_t> next_, previous_;
    std::vector<char> reflex_, ear_;
    std::vector<uint32_t> byX_;  // corners that were reflex at first, by x
};

}  // namespace

bool splitPolygon(std::span<const glm::dvec3> corners, std::vector<std::array<uint32_t, 3>>& triangles) {
    if (corners.size() > 3) {
        const std::vector<Point> points = project(corners);
        if (!points.empty() && !isConvex(points)) {
            const auto before = static_cast<std::ptrdiff_t>(triangles.size());
            EarClipper(points).clip(triangles);
            return std::none_of(triangles.begin() + before, triangles.end(), [&](const auto& t) {
                return area(points[t[0]], points[t[1]], points[t[2]]) < -kNoArea;
            });
        }
    }
    for (uint32_t i = 1; i + 1 < corners.size(); i++) triangles.push_back({0, i, i + 1});
    return true;
}

}  // namespace glint
