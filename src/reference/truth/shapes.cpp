// The shapes of a scene as rows of the layout, in double. The formulas are those of
// shaders/shared/primitives.h.
#include <array>
#include <cmath>

#include "core/room.h"
#include "core/vectors.h"
#include "reference/numbers.h"
#include "reference/truth/part.h"
#include "scene/polygon_plane.h"

namespace glint::reference::truth {

using glm::dvec3;

dvec3 unit(const dvec3& v) {
    const dvec3 scaled = v / greatestMagnitude(v);
    return scaled / glm::length(scaled);
}

Place::Place(const Affine& transform) : linear(transform.linear), offset(transform.offset) {
    // Row i of the inverse is the cross product of the columns after i over the volume.
    const double volume = glm::dot(linear[0], glm::cross(linear[1], linear[2]));
    for (int i = 0; i < 3; ++i) {
        const dvec3 row = glm::cross(linear[(i + 1) % 3], linear[(i + 2) % 3]) / volume;
        for (int j = 0; j < 3; ++j) inverse[j][i] = row[j];
    }
    gain = greatestMagnitude(magnitudes(linear) * (magnitudes(inverse) * dvec3(1)));
}

// Every number of a disturbed model is off by kDisturbanceRoom units of itself; twice that, as box and
// surface are sums.
void Part::addItem(shared::PrimitiveKind kind, size_t index, Bounds box, double gain) {
    box.grow(2 * kDisturbanceRoom * 0x1p-24 * gain * box.reach());
    items.push_back({box, kind, static_cast<uint32_t>(index)});
}

// From near its surface the nearest point of that and the normal there, as the layout says: 1/64 of the
// radius.
void Part::add(const SphereShape& sphere, const Setting& at) {
    rows::Sphere row;
    row.point = sphere.center - at.origin;
    row.radius = sphere.radius;
    const double distance = glm::distance(at.eye, sphere.center);
    if (std::abs(distance - sphere.radius) * 64 < sphere.radius) {
        row.anchorNormal = unit(at.eye - sphere.center);
        row.point += sphere.radius * row.anchorNormal;
    }
    Bounds box;
    box.include(sphere.center - at.origin - sphere.radius);
    box.include(sphere.center - at.origin + sphere.radius);
    put(shared::PrimitiveKind::Sphere, model.spheres, row, at, box, 4);
}

void Part::add(const PlaneShape& plane, const Setting& at) {
    rows::Plane row;
    row.point = plane.point - at.origin;
    row.normal = unit(plane.normal);
    identify(at, row);
    model.planes.push_back(row);
}

void Part::add(const DiscShape& disc, const Setting& at) {
    rows::Disc row;
    row.center = disc.center - at.origin;
    row.normal = unit(disc.normal);
    row.radius = disc.radius;
    Bounds box;
    // Along an axis as far as the sine of the normal's angle to it.
    dvec3 reach(0);
    for (int i = 0; i < 3; ++i)
        reach[i] = disc.radius * std::hypot(row.normal[(i + 1) % 3], row.normal[(i + 2) % 3]);
    box.include(row.center - reach);
    box.include(row.center + reach);
    put(shared::PrimitiveKind::Disc, model.discs, row, at, box, 4);
}

void Part::add(const PolygonShape& polygon, const Setting& at) {
    std::vector<dvec3> outline;
    Bounds box;
    for (const dvec3& vertex : polygon.vertices) {
        if (!isFinite(vertex)) return;
        outline.push_back(vertex - at.origin);
        box.include(outline.back());
    }
    const auto plane = polygonPlane(outline);
    if (!plane) return;
    rows::Polygon row;
    row.point = plane->point;
    row.normal = plane->normal;
    row.firstVertex = static_cast<uint32_t>(model.polygonVertices.size());
    constexpr size_t kEdges = shared::kPolygonEdgesPerTrip;
    row.trips = static_cast<uint32_t>((outline.size() + kEdges - 1) / kEdges);
    for (size_t i = 0; i <= row.trips * kEdges; ++i) {
        rows::PolygonVertex vertex;
        vertex.position = outline[i < outline.size() ? i : 0];
        model.polygonVertices.push_back(vertex);
    }
    // A vertex may lie off the plane, where the hit is.
    box.grow(plane->deviation);
    put(shared::PrimitiveKind::Polygon, model.polygons, row, at, box, 4);
}

void Part::add(const BoxShape& box, const Setting& at) {
    const Place& place = at.place;
    rows::Cuboid row;
    Bounds bounds;
    if (!at.moved) {
        row.toLocal0.x = row.toLocal1.y = row.toLocal2.z = 1;
        row.lo = box.min - at.origin;
        row.hi = box.max - at.origin;
        bounds.include(row.lo);
        bounds.include(row.hi);
    } else {
        const dvec3 half = (box.max - box.min) / 2.0;
        const dvec3 edge[3] = {place.linear[0] * half.x, place.linear[1] * half.y, place.linear[2] * half.z};
        row.point = place((box.min + box.max) / 2.0) - at.origin;
        dvec3* const normals[3] = {&row.toLocal0, &row.toLocal1, &row.toLocal2};
        for (int i = 0; i < 3; ++i) {
            // A face's normal is at right angles to the other two edges.
            const dvec3 n = unit(glm::cross(edge[(i + 1) % 3], edge[(i + 2) % 3]));
            *normals[i] = glm::dot(n, edge[i]) < 0 ? -n : n;
            row.hi[i] = glm::dot(*normals[i], edge[i]);
        }
        row.lo = -row.hi;
        const dvec3 reach = glm::abs(edge[0]) + glm::abs(edge[1]) + glm::abs(edge[2]);
        bounds.include(row.point - reach);
        bounds.include(row.point + reach);
    }
    if (!isFinite(row.lo) || !isFinite(row.hi) || !glm::all(glm::lessThan(row.lo, row.hi))) return;
    put(shared::PrimitiveKind::Cuboid, model.cuboids, row, at, bounds, at.moved ? 8 * place.gain : 1);
}

void Part::add(const TriangleShape& triangle, const Setting& at) {
    const auto& v = triangle.vertices;
    const dvec3 area = glm::cross(v[1] - v[0], v[2] - v[0]);
    if (area != dvec3(0) && isFinite(area)) addTriangle(v, at);
}

void Part::addTriangle(const dvec3 (&vertices)[3], const Setting& at) {
    rows::Triangle row;
    row.v0 = vertices[0] - at.origin;
    row.v1 = vertices[1] - at.origin;
    row.v2 = vertices[2] - at.origin;
    row.id = at.id();
    rows::TriangleSurface surface;
    surface.object = at.who.object;
    surface.primitive = at.who.face;
    surface.material = at.who.material;
    surface.vertexNormals = shared::kNone;
    model.triangles.push_back(row);
    model.triangleSurfaces.push_back(surface);
    Bounds box;
    for (const dvec3& v : {row.v0, row.v1, row.v2}) box.include(v);
    addItem(shared::PrimitiveKind::Triangle, model.triangles.size() - 1, box, 1);
}

void Part::addAttributes(const Mesh& mesh, uint32_t face) {
    rows::TriangleSurface& surface = model.triangleSurfaces.back();
    if (!mesh.normalCorners.empty()) {
        const glm::uvec3 corners = mesh.normalCorners[face];
        rows::VertexNormals normals;
        dvec3* const out[3] = {&normals.n0, &normals.n1, &normals.n2};
        bool complete = true;
        for (int i = 0; i < 3 && complete; ++i) {
            complete = corners[i] != Mesh::kNoIndex && isFinite(mesh.normals[corners[i]]) &&
                       mesh.normals[corners[i]] != dvec3(0);
            if (complete) *out[i] = unit(mesh.normals[corners[i]]);
        }
        if (complete) {
            surface.vertexNormals = static_cast<uint32_t>(model.vertexNormals.size());
            model.vertexNormals.push_back(normals);
        }
    }
    const auto first = static_cast<uint32_t>(model.vertexAttributes.size());
    const auto put = [&](const dvec3& value) { model.vertexAttributes.emplace_back().value = value; };
    if (!mesh.uvCorners.empty() && mesh.uvCorners[face].x != Mesh::kNoIndex) {
        const glm::uvec3 c = mesh.uvCorners[face];
        put({mesh.uvs[c.x].x, mesh.uvs[c.y].x, mesh.uvs[c.z].x});
        put({mesh.uvs[c.x].y, mesh.uvs[c.y].y, mesh.uvs[c.z].y});
        surface.attributes = first | shared::kAttributeUvs;
    }
    if (!mesh.colorCorners.empty() && mesh.colorCorners[face].x != Mesh::kNoIndex) {
        for (int i = 0; i < 3; ++i) put(mesh.colors[mesh.colorCorners[face][i]]);
        surface.attributes |= first | shared::kAttributeColors;
    }
}

// Skip triangles with a corner that is not finite, or without area.
void Part::add(const MeshShape& shape, const Setting& at) {
    const Mesh& mesh = *shape.mesh;
    const size_t count = mesh.corners.size();
    reserveMore(items, count);
    reserveMore(model.triangles, count);
    reserveMore(model.triangleSurfaces, count);
    Setting one = at;
    for (uint32_t face = 0; face < count; ++face) {
        const glm::uvec3 c = mesh.corners[face];
        const dvec3 v[3] = {mesh.positions[c.x], mesh.positions[c.y], mesh.positions[c.z]};
        if (!isFinite(v[0]) || !isFinite(v[1]) || !isFinite(v[2])) continue;
        if (glm::cross(v[1] - v[0], v[2] - v[0]) == dvec3(0)) continue;
        one.who.id = at.who.id + face;
        one.who.face = mesh.faces.empty() ? face : mesh.faces[face];
        if (!mesh.materials.empty()) one.who.material = mesh.materials[face];
        addTriangle(v, one);
        addAttributes(mesh, face);
    }
}

}  // namespace glint::reference::truth
