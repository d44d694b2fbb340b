// The shapes of a scene as rows of the layout, in double. The formulas are those of
// shaders/shared/primitives.h.
#include <array>
#include <cmath>

#include "core/room.h"
#include "core/vectors.h"
#include "reference/truth/part.h"
#include "scene/polygon_plane.h"

namespace glint::reference::truth {
namespace {

using glm::dmat3;
using glm::dvec3;

dmat3 magnitudesOf(const dmat3& m) {
    return {glm::abs(m[0]), glm::abs(m[1]), glm::abs(m[2])};
}

// The half edges of a box's faces from its middle, at right angles to them, as unit vectors and lengths.
struct Slabs {
    dvec3 normal[3];
    double half[3];
};

// A face's normal is at right angles to the other two edges.
Slabs slabsOf(const dvec3 (&edge)[3]) {
    Slabs slabs;
    for (int i = 0; i < 3; ++i) {
        dvec3 n = unit(glm::cross(edge[(i + 1) % 3], edge[(i + 2) % 3]));
        if (glm::dot(n, edge[i]) < 0) n = -n;
        slabs.normal[i] = n;
        slabs.half[i] = glm::dot(n, edge[i]);
    }
    return slabs;
}

}  // namespace

dvec3 unit(const dvec3& v) {
    const dvec3 size = glm::abs(v);
    const dvec3 scaled = v / std::max({size.x, size.y, size.z});
    return scaled / glm::length(scaled);
}

Place::Place(const Affine& transform) : linear(transform.linear), offset(transform.offset) {
    // Row i of the inverse is the cross product of the columns after i over the volume.
    const double volume = glm::dot(linear[0], glm::cross(linear[1], linear[2]));
    for (int i = 0; i < 3; ++i) {
        const dvec3 row = glm::cross(linear[(i + 1) % 3], linear[(i + 2) % 3]) / volume;
        for (int j = 0; j < 3; ++j) inverse[j][i] = row[j];
    }
    const dvec3 sums = magnitudesOf(linear) * (magnitudesOf(inverse) * dvec3(1));
    gain = std::max({sums.x, sums.y, sums.z});
}

// Every number of a disturbed model is off by kDisturbanceRoom units of itself; twice that, as box and
// surface are sums.
void Part::addItem(shared::PrimitiveKind kind, size_t index, Bounds box, double gain) {
    box.grow(2 * kDisturbanceRoom * 0x1p-24 * gain * box.reach());
    items.push_back({box, static_cast<uint32_t>(kind), static_cast<uint32_t>(index)});
}

// From near its surface the nearest point of that and the normal there, as the layout says: 1/64 of the
// radius.
void Part::addSphere(const SphereShape& sphere, const dvec3& origin, const dvec3& eye, const Identity& who) {
    rows::Sphere row;
    row.point = sphere.center - origin;
    row.radius = sphere.radius;
    const double distance = glm::distance(eye, sphere.center);
    if (std::abs(distance - sphere.radius) * 64 < sphere.radius) {
        row.anchorNormal = unit(eye - sphere.center);
        row.point += sphere.radius * row.anchorNormal;
    }
    identify(who, row);
    model.spheres.push_back(row);
    Bounds box;
    box.include(sphere.center - origin - sphere.radius);
    box.include(sphere.center - origin + sphere.radius);
    addItem(shared::PrimitiveKind::Sphere, model.spheres.size() - 1, box, 4);
}

void Part::addPlane(const PlaneShape& plane, const dvec3& origin, const Identity& who) {
    rows::Plane row;
    row.point = plane.point - origin;
    row.normal = unit(plane.normal);
    identify(who, row);
    model.planes.push_back(row);
}

void Part::addDisc(const DiscShape& disc, const dvec3& origin, const Identity& who) {
    rows::Disc row;
    row.center = disc.center - origin;
    row.normal = unit(disc.normal);
    row.radius = disc.radius;
    identify(who, row);
    model.discs.push_back(row);
    Bounds box;
    // Along an axis as far as the sine of the normal's angle to it.
    dvec3 reach(0);
    for (int i = 0; i < 3; ++i)
        reach[i] = disc.radius * std::hypot(row.normal[(i + 1) % 3], row.normal[(i + 2) % 3]);
    box.include(row.center - reach);
    box.include(row.center + reach);
    addItem(shared::PrimitiveKind::Disc, model.discs.size() - 1, box, 4);
}

void Part::addPolygon(const PolygonShape& polygon, const dvec3& origin, const Identity& who) {
    std::vector<dvec3> outline;
    Bounds box;
    for (const dvec3& vertex : polygon.vertices) {
        if (!isFinite(vertex)) return;
        outline.push_back(vertex - origin);
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
    identify(who, row);
    for (size_t i = 0; i <= row.trips * kEdges; ++i) {
        rows::PolygonVertex vertex;
        vertex.position = outline[i < outline.size() ? i : 0];
        model.polygonVertices.push_back(vertex);
    }
    model.polygons.push_back(row);
    // A vertex may lie off the plane, where the hit is.
    box.grow(plane->deviation);
    addItem(shared::PrimitiveKind::Polygon, model.polygons.size() - 1, box, 4);
}

void Part::addBox(const BoxShape& box, const Place* place, const dvec3& origin, const Identity& who) {
    rows::Cuboid row;
    Bounds bounds;
    if (place == nullptr) {
        row.toLocal0.x = row.toLocal1.y = row.toLocal2.z = 1;
        row.lo = box.min - origin;
        row.hi = box.max - origin;
        bounds.include(row.lo);
        bounds.include(row.hi);
    } else {
        const dvec3 half = (box.max - box.min) / 2.0;
        const dvec3 edge[3] = {place->linear[0] * half.x, place->linear[1] * half.y,
                               place->linear[2] * half.z};
        const Slabs slabs = slabsOf(edge);
        row.point = (*place)((box.min + box.max) / 2.0) - origin;
        row.toLocal0 = slabs.normal[0];
        row.toLocal1 = slabs.normal[1];
        row.toLocal2 = slabs.normal[2];
        row.hi = {slabs.half[0], slabs.half[1], slabs.half[2]};
        row.lo = -row.hi;
        const dvec3 reach = glm::abs(edge[0]) + glm::abs(edge[1]) + glm::abs(edge[2]);
        bounds.include(row.point - reach);
        bounds.include(row.point + reach);
    }
    if (!isFinite(row.lo) || !isFinite(row.hi) || !glm::all(glm::lessThan(row.lo, row.hi))) return;
    identify(who, row);
    model.cuboids.push_back(row);
    addItem(shared::PrimitiveKind::Cuboid, model.cuboids.size() - 1, bounds,
            place == nullptr ? 1 : 8 * place->gain);
}

void Part::addTriangle(const dvec3 (&vertices)[3], const dvec3& origin, const Identity& who) {
    rows::Triangle row;
    row.v0 = vertices[0] - origin;
    row.v1 = vertices[1] - origin;
    row.v2 = vertices[2] - origin;
    row.id = who.id;
    rows::TriangleSurface surface;
    surface.object = who.object;
    surface.primitive = who.face;
    surface.material = who.material;
    surface.vertexNormals = shared::kNone;
    model.triangles.push_back(row);
    model.triangleSurfaces.push_back(surface);
    Bounds box;
    for (const dvec3& v : {row.v0, row.v1, row.v2}) box.include(v);
    addItem(shared::PrimitiveKind::Triangle, model.triangles.size() - 1, box);
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
void Part::addMesh(const Mesh& mesh, const dvec3& origin, const Identity& first) {
    const size_t count = mesh.corners.size();
    reserveMore(items, count);
    reserveMore(model.triangles, count);
    reserveMore(model.triangleSurfaces, count);
    for (uint32_t face = 0; face < count; ++face) {
        const glm::uvec3 c = mesh.corners[face];
        const dvec3 v[3] = {mesh.positions[c.x], mesh.positions[c.y], mesh.positions[c.z]};
        if (!isFinite(v[0]) || !isFinite(v[1]) || !isFinite(v[2])) continue;
        if (glm::cross(v[1] - v[0], v[2] - v[0]) == dvec3(0)) continue;
        addTriangle(v, origin,
                    {first.id + face, first.object, mesh.faces.empty() ? face : mesh.faces[face],
                     mesh.materials.empty() ? first.material : mesh.materials[face]});
        addAttributes(mesh, face);
    }
}

namespace {

// Fills the arrays of the model in the order of leaves.
class LeafWriter {
  public:
    LeafWriter(Part& part, Model& model) : part_(part), model_(model) {
        reserveMore(model.triangles, part.model.triangles.size());
        reserveMore(model.triangleSurfaces, part.model.triangles.size());
        normals_ = moved(model.vertexNormals, part.model.vertexNormals);
        attributes_ = moved(model.vertexAttributes, part.model.vertexAttributes);
        vertices_ = moved(model.polygonVertices, part.model.polygonVertices);
    }

    // The child that stands for the leaf.
    uint32_t leaf(const TreeNode& node) {
        const uint32_t kind = part_.items[node.first].kind;
        uint32_t first = 0;
        switch (static_cast<shared::PrimitiveKind>(kind)) {
#define GLINT_WRITE(number, Kind, kinds, one, many)                               \
    case shared::PrimitiveKind::Kind:                                             \
        first = static_cast<uint32_t>(model_.kinds.size());                       \
        for (uint32_t i = node.first; i < node.first + node.count; ++i)           \
            write(part_.model.kinds[part_.items[i].index], part_.items[i].index); \
        break;
            GLINT_PRIMITIVES(GLINT_WRITE, GLINT_WRITE)
#undef GLINT_WRITE
        }
        return shared::kLeafFlag | kind << shared::kLeafKindShift |
               (node.count - 1) << shared::kLeafCountShift | first;
    }

  private:
    template <class Row>
    static uint32_t moved(std::vector<Row>& to, const std::vector<Row>& from) {
        const auto base = static_cast<uint32_t>(to.size());
        to.insert(to.end(), from.begin(), from.end());
        return base;
    }
    void write(const rows::Triangle& row, uint32_t index) {
        rows::TriangleSurface surface = part_.model.triangleSurfaces[index];
        if (surface.vertexNormals != shared::kNone) surface.vertexNormals += normals_;
        if (surface.attributes != 0) surface.attributes += attributes_;
        model_.triangles.push_back(row);
        model_.triangleSurfaces.push_back(surface);
    }
    void write(rows::Polygon row, uint32_t) {
        row.firstVertex += vertices_;
        model_.polygons.push_back(row);
    }
#define GLINT_WRITE_ROW(Kind, kinds)              \
    void write(const rows::Kind& row, uint32_t) { \
        model_.kinds.push_back(row);              \
    }
    GLINT_WRITE_ROW(Sphere, spheres)
    GLINT_WRITE_ROW(Plane, planes)
    GLINT_WRITE_ROW(Disc, discs)
    GLINT_WRITE_ROW(Quadric, quadrics)
    GLINT_WRITE_ROW(Instance, instances)
    GLINT_WRITE_ROW(Cuboid, cuboids)
#undef GLINT_WRITE_ROW

    Part& part_;
    Model& model_;
    uint32_t normals_, attributes_, vertices_;
};

}  // namespace

uint32_t append(Part&& part, const Context& context, std::vector<rows::Node>& nodes, Model& model) {
    const auto solo = static_cast<uint32_t>(shared::PrimitiveKind::Instance);
    const std::vector<TreeNode> tree = buildTree(part.items, solo, context);
    model.planes.insert(model.planes.end(), part.model.planes.begin(), part.model.planes.end());
    if (tree.empty()) return shared::kNone;
    LeafWriter writer(part, model);
    const auto root = static_cast<uint32_t>(nodes.size());
    reserveMore(nodes, tree.size() / 2 + 1);
    // Leaves are written in the order of the walk, so that what is near in space is near in memory.
    std::vector<uint32_t> place(tree.size(), 0), waiting{0};
    if (tree[0].count > 0) {
        rows::Node& node = nodes.emplace_back();
        node.lo0 = tree[0].box.lo;
        node.hi0 = tree[0].box.hi;
        node.child0 = writer.leaf(tree[0]);
        node.child1 = shared::kNone;
        return root;
    }
    nodes.emplace_back();
    place[0] = root;
    while (!waiting.empty()) {
        const TreeNode& at = tree[waiting.back()];
        const uint32_t here = place[waiting.back()];
        waiting.pop_back();
        uint32_t children[2];
        for (int side = 0; side < 2; ++side) {
            const uint32_t index = side == 0 ? at.left : at.right;
            if (tree[index].count > 0) {
                children[side] = writer.leaf(tree[index]);
                continue;
            }
            place[index] = children[side] = static_cast<uint32_t>(nodes.size());
            nodes.emplace_back();
            waiting.push_back(index);
        }
        rows::Node& node = nodes[here];
        node.lo0 = tree[at.left].box.lo;
        node.hi0 = tree[at.left].box.hi;
        node.child0 = children[0];
        node.lo1 = tree[at.right].box.lo;
        node.hi1 = tree[at.right].box.hi;
        node.child1 = children[1];
    }
    return root;
}

}  // namespace glint::reference::truth
