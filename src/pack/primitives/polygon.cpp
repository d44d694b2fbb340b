#include <cmath>

#include "pack/primitives.h"
#include "scene/limits.h"
#include "scene/polygon_plane.h"

namespace glint {

std::optional<std::vector<glm::vec3>> roundPolygon(const PolygonShape& polygon, const glm::dvec3& origin) {
    std::vector<glm::vec3> rounded;
    rounded.reserve(polygon.vertices.size());
    for (const glm::dvec3& vertex : polygon.vertices) {
        const auto p = roundPoint(vertex - origin);
        if (!p) return std::nullopt;
        rounded.push_back(*p);
    }
    return rounded;
}

std::vector<glm::dvec3> widened(const std::vector<glm::vec3>& vertices) {
    return {vertices.begin(), vertices.end()};
}

Box polygonBox(const std::vector<glm::vec3>& vertices, const glm::vec3& point, const glm::vec3& normal) {
    Box box;
    const glm::dvec3 n(normal);
    for (const glm::vec3& vertex : vertices) {
        box.include(vertex);
        const glm::dvec3 v(vertex);
        const glm::dvec3 onPlane = v - glm::dot(n, v - glm::dvec3(point)) / glm::dot(n, n) * n;
        if (onPlane == v) continue;
        for (int axis = 0; axis < 3; ++axis) {
            Box reach = box;
            // Four roundings in double of coordinates and of the way between them.
            const double margin = 0x1p-50 * std::abs(onPlane[axis]);
            setRounded(reach, axis, onPlane[axis] - margin, onPlane[axis] + margin);
            if (onPlane[axis] < box.lo[axis]) box.lo[axis] = reach.lo[axis];
            if (onPlane[axis] > box.hi[axis]) box.hi[axis] = reach.hi[axis];
        }
    }
    return box;
}

uint32_t polygonTrips(size_t vertices) {
    static_assert(kMaxPolygonVertices == shared::kMaxPolygonTrips * shared::kPolygonEdgesPerTrip);
    constexpr uint32_t kEdges = shared::kPolygonEdgesPerTrip;
    return (static_cast<uint32_t>(vertices) + kEdges - 1) / kEdges;
}

namespace {

// Uses the vertices as read: in an outline that crosses itself Newell's sum may nearly cancel, and rounded
// vertices would turn the plane by their rounding error over the rest.
PolygonPlane localPlane(const PolygonShape& polygon, const glm::dvec3& origin) {
    PolygonPlane plane = polygonPlane(polygon.vertices).value();
    plane.point -= origin;
    return plane;
}

// Length of a polygon's part of the vertex array: its edges and those without length that fill the last trip.
uint32_t packedVertices(const PolygonShape& polygon) {
    return polygonTrips(polygon.vertices.size()) * shared::kPolygonEdgesPerTrip + 1;
}

class PolygonPacker final : public KindPacker {
  public:
    bool packs(const Shape& shape) const override { return std::holds_alternative<PolygonShape>(shape); }
    PrimitiveStatus statusOf(const Object& object, uint32_t, const Frame& frame) const override {
        const auto vertices = roundPolygon(std::get<PolygonShape>(object.shape), frame.origin);
        if (!vertices) return PrimitiveStatus::NotFinite;
        return polygonPlane(widened(*vertices)) && polygonPlane(std::get<PolygonShape>(object.shape).vertices)
                   ? PrimitiveStatus::Kept
                   : PrimitiveStatus::NoArea;
    }
    void extend(const Object& object, uint32_t, uint32_t, Extent& extent) const override {
        for (const glm::dvec3& vertex : std::get<PolygonShape>(object.shape).vertices) extent.include(vertex);
    }
    Box box(const Object& object, uint32_t, const Frame& frame) const override {
        const auto& shape = std::get<PolygonShape>(object.shape);
        const auto vertices = roundPolygon(shape, frame.origin).value();
        const PolygonPlane plane = localPlane(shape, frame.origin);
        return withEdgeMargin(polygonBox(vertices, glm::vec3(plane.point), glm::vec3(plane.normal)));
    }
    void count(const Packing& packing, Primitives::Source source, FurtherRows& rows) const override {
        rows.polygonVertices += packedVertices(std::get<PolygonShape>(packing.objectOf(source).shape));
    }
    void write(const Packing& packing, Primitives::Source source, uint32_t slot,
               FurtherRows& next) const override {
        const auto& shape = std::get<PolygonShape>(packing.objectOf(source).shape);
        const std::vector<glm::vec3> vertices = roundPolygon(shape, packing.frame.origin).value();
        const PolygonPlane plane = localPlane(shape, packing.frame.origin);
        shared::Polygon& polygon = packing.packed.polygons[slot];
        polygon.point = glm::vec3(plane.point);
        polygon.normal = glm::vec3(plane.normal);
        polygon.firstVertex = next.polygonVertices;
        polygon.trips = polygonTrips(vertices.size());
        packing.identify(source, polygon);
        for (uint32_t i = 0; i < packedVertices(shape); ++i)
            packing.packed.polygonVertices[next.polygonVertices++].position =
                vertices[i < vertices.size() ? i : 0];
    }
    void balls(const PackedScene& scene, uint32_t index, const VisitBall& visit) const override {
        const shared::Polygon& polygon = scene.polygons[index];
        for (uint32_t i = 0; i <= polygon.trips * shared::kPolygonEdgesPerTrip; ++i)
            visit(scene.polygonVertices[polygon.firstVertex + i].position, 0);
    }
    // A fan about the first vertex: in a concave outline, areas covered twice with opposite signs cancel.
    double windings(const PackedScene& scene, uint32_t index, const glm::dvec3& point) const override {
        const shared::Polygon& polygon = scene.polygons[index];
        const shared::PolygonVertex* v = &scene.polygonVertices[polygon.firstVertex];
        const uint32_t edges = polygon.trips * shared::kPolygonEdgesPerTrip;
        const auto seen = [&](uint32_t i) { return glm::dvec3(v[i].position) - point; };
        double sum = 0;
        for (uint32_t i = 1; i + 1 < edges; ++i) sum += windingOf(seen(0), seen(i), seen(i + 1));
        return sum;
    }
};

}  // namespace

const KindPacker& packerOfPolygon() {
    static const PolygonPacker packer;
    return packer;
}

}  // namespace glint
