// The shapes of a scene as rows of the layout, in double, by the formulas of shaders/shared/primitives.h; and
// the media that enclose the eye, by the solid angle of their surfaces (docs/reference/shading.md).
#include <cmath>
#include <numbers>

#include "core/room.h"
#include "core/vectors.h"
#include "reference/instance.h"
#include "reference/numbers.h"
#include "reference/traverse.h"
#include "reference/truth/part.h"
#include "reference/truth/truth.h"
#include "scene/polygon_plane.h"
#include "scene/transform.h"

namespace glint::reference {
namespace truth {

using glm::dvec3;

Place::Place(const Affine& transform)
    : linear(transform.linear),
      inverse(glm::inverse(linear)),
      offset(transform.offset),
      gain(greatestMagnitude(magnitudes(linear) * (magnitudes(inverse) * dvec3(1)))) {}

// Every number of a disturbed model is off by kDisturbanceRoom units of itself; twice that, as box and
// surface are sums.
void Part::addItem(shared::PrimitiveKind kind, size_t index, Bounds box, double gain) {
    box.grow(2 * kDisturbanceRoom * 0x1p-24 * gain * box.reach());
    items.push_back({box, kind, static_cast<uint32_t>(index)});
}

namespace {

// If the eye is nearer to the surface than 1/64 of the radius: the nearest point and the normal there, as the
// layout requires.
void add(Part& part, const SphereShape& sphere, const Setting& at) {
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
    part.put(shared::PrimitiveKind::Sphere, part.model.spheres, row, at, box, 4);
}

void add(Part& part, const PlaneShape& plane, const Setting& at) {
    rows::Plane row;
    row.point = plane.point - at.origin;
    row.normal = unit(plane.normal);
    if (at.anchor) {
        const dvec3 point = *at.anchor - glm::dot(row.normal, *at.anchor - row.point) * row.normal;
        const dvec3 eye = at.eye - at.origin;
        if (glm::distance(point, eye) <= kAnchorRoom * glm::distance(row.point, eye)) row.point = point;
    }
    identify(at, row);
    part.whole.planes.push_back(row);
}

void add(Part& part, const DiscShape& disc, const Setting& at) {
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
    part.put(shared::PrimitiveKind::Disc, part.model.discs, row, at, box, 4);
}

// False, without a triangle, if a corner is not finite or the area is 0.
bool addTriangle(Part& part, const dvec3 (&vertices)[3], const Setting& at) {
    const dvec3 area = glm::cross(vertices[1] - vertices[0], vertices[2] - vertices[0]);
    if (!isFinite(area) || area == dvec3(0)) return false;
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
    part.model.triangles.push_back(row);
    part.model.triangleSurfaces.push_back(surface);
    Bounds box;
    for (const dvec3& v : {row.v0, row.v1, row.v2}) box.include(v);
    part.addItem(shared::PrimitiveKind::Triangle, part.model.triangles.size() - 1, box, 1);
    return true;
}

// Sets normals, texture coordinates and colours of the triangle added last.
void addAttributes(Part& part, const Mesh& mesh, uint32_t face) {
    rows::TriangleSurface& surface = part.model.triangleSurfaces.back();
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
            surface.vertexNormals = static_cast<uint32_t>(part.whole.vertexNormals.size());
            part.whole.vertexNormals.push_back(normals);
        }
    }
    const auto first = static_cast<uint32_t>(part.whole.vertexAttributes.size());
    const auto put = [&](const dvec3& value) { part.whole.vertexAttributes.emplace_back().value = value; };
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

void add(Part& part, const PolygonShape& polygon, const Setting& at) {
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
    row.firstVertex = static_cast<uint32_t>(part.whole.polygonVertices.size());
    constexpr size_t kEdges = shared::kPolygonEdgesPerTrip;
    row.trips = static_cast<uint32_t>((outline.size() + kEdges - 1) / kEdges);
    for (size_t i = 0; i <= row.trips * kEdges; ++i) {
        rows::PolygonVertex vertex;
        vertex.position = outline[i < outline.size() ? i : 0];
        part.whole.polygonVertices.push_back(vertex);
    }
    // A vertex may lie off the plane, where the hit is.
    box.grow(plane->deviation);
    part.put(shared::PrimitiveKind::Polygon, part.model.polygons, row, at, box, 4);
}

void add(Part& part, const BoxShape& box, const Setting& at) {
    const Place& place = at.place;
    rows::Cuboid row;
    if (!at.moved) {
        row.toLocal0.x = row.toLocal1.y = row.toLocal2.z = 1;
        row.lo = box.min - at.origin;
        row.hi = box.max - at.origin;
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
    }
    if (!isFinite(row.lo) || !isFinite(row.hi) || !glm::all(glm::lessThan(row.lo, row.hi))) return;
    part.put(shared::PrimitiveKind::Cuboid, part.model.cuboids, row, at, boxOf(row),
             at.moved ? 8 * place.gain : 1);
}

void add(Part& part, const TriangleShape& triangle, const Setting& at) {
    addTriangle(part, triangle.vertices, at);
}

void add(Part& part, const MeshShape& shape, const Setting& at) {
    const Mesh& mesh = *shape.mesh;
    const size_t count = mesh.corners.size();
    reserveMore(part.items, count);
    reserveMore(part.model.triangles, count);
    reserveMore(part.model.triangleSurfaces, count);
    Setting one = at;
    for (uint32_t face = 0; face < count; ++face) {
        const glm::uvec3 c = mesh.corners[face];
        const dvec3 v[3] = {mesh.positions[c.x], mesh.positions[c.y], mesh.positions[c.z]};
        one.who.id = at.who.id + face;
        one.who.face = mesh.faces.empty() ? face : mesh.faces[face];
        if (!mesh.materials.empty()) one.who.material = mesh.materials[face];
        if (addTriangle(part, v, one)) addAttributes(part, mesh, face);
    }
}

}  // namespace

void Part::add(const Shape& shape, const Setting& at) {
    std::visit(
        [&](const auto& one) {
            if constexpr (requires { truth::add(*this, one, at); })
                truth::add(*this, one, at);
            else
                addQuadric(shape, at);
        },
        shape);
}

// ---- Media

namespace {

// Solid angle of a triangle from 0, in whole spheres (A. van Oosterom, J. Strackee 1983).
double solidAngle(const dvec3& a, const dvec3& b, const dvec3& c) {
    const double x = glm::length(a), y = glm::length(b), z = glm::length(c);
    const double over = glm::dot(glm::cross(a, b), c);
    const double under = x * y * z + z * glm::dot(a, b) + x * glm::dot(b, c) + y * glm::dot(c, a);
    return std::atan2(over, under) / (2 * std::numbers::pi);
}

class MediaAround {
  public:
    MediaAround(const dvec3& eye, const Model& model)
        : eye_(eye), model_(model), turns_(model.optics.size() + 1), boxes_(turns_.size()) {}

    std::vector<uint32_t> find() {
        if (model_.environment.root != shared::kNone) addTriangles(model_.environment.root, nullptr);
#define GLINT_ADD(number, Kind, KINDS, kinds, one, many) \
    for (const rows::Kind& row : model_.kinds) add(row);
        GLINT_PRIMITIVES(GLINT_ADD, GLINT_NO_KIND)
#undef GLINT_ADD
        std::vector<uint32_t> media;
        for (uint32_t medium = 1; medium < turns_.size(); ++medium)
            for (long i = 0; i < std::lround(turns_[medium]) && i < long{shared::kMaxMedia}; ++i)
                media.push_back(medium);
        std::stable_sort(media.begin(), media.end(),
                         [&](uint32_t a, uint32_t b) { return sizeOf(a) > sizeOf(b); });
        media.resize(std::min<size_t>(media.size(), shared::kMaxMedia));
        return media;
    }

  private:
    uint32_t mediumOf(uint32_t material) const {
        return model_.materials[material].medium;
    }
    double sizeOf(uint32_t medium) const {
        return glm::length(0.5 * boxes_[medium].hi - 0.5 * boxes_[medium].lo);
    }

    // Adds the triangles of the world or of an instance. Instances are of meshes and discs.
    void addTriangles(uint32_t root, const rows::Instance* instance) {
        traverse(
            *model_.nodes, root, [](const rows::Node&, int) { return 0.0; }, [] { return 0.0; },
            [&](const Leaf& leaf, double) {
                for (uint32_t i = leaf.first; i < leaf.end; ++i) {
                    if (leaf.kind == shared::PrimitiveKind::Triangle) addTriangle(i, instance);
                    if (leaf.kind == shared::PrimitiveKind::Instance)
                        addTriangles(model_.instances[i].root, &model_.instances[i]);
                }
                return false;
            });
    }

    void addTriangle(uint32_t i, const rows::Instance* instance) {
        const rows::Triangle& t = model_.triangles[i];
        uint32_t material = model_.triangleSurfaces[i].material;
        dvec3 v[3] = {t.v0, t.v1, t.v2};
        bool mirrored = false;
        if (instance != nullptr) {
            if (instance->material != shared::kNone) material = instance->material;
            const InstanceFrame frame(*instance);
            for (dvec3& p : v) p = frame.pointInWorld(p);
            mirrored = instance->mirrored != 0;
        }
        const uint32_t medium = mediumOf(material);
        if (medium == 0) return;
        for (const dvec3& p : v) boxes_[medium].include(p);
        const double turns = solidAngle(v[0] - eye_, v[1] - eye_, v[2] - eye_);
        turns_[medium] += mirrored ? -turns : turns;
    }

    void add(const rows::Triangle&) {}
    void add(const rows::Disc&) {}  // goes round nothing
    template <class Solid>
    void add(const Solid& solid) {
        if (const uint32_t medium = mediumOf(solid.material))
            turns_[medium] += turnsOf(solid, boxes_[medium]);
    }

    // How often the surface encloses the eye. The medium's box grows by the surface's.
    double turnsOf(const rows::Plane& plane, Bounds& box) const {
        box.include(dvec3(std::numeric_limits<double>::max()));
        box.include(dvec3(-std::numeric_limits<double>::max()));
        return glm::dot(plane.normal, eye_ - plane.point) < 0 ? 1 : 0;
    }
    double turnsOf(const rows::Sphere& s, Bounds& box) const {
        const dvec3 center = s.point - s.radius * s.anchorNormal;
        box.include(center - s.radius);
        box.include(center + s.radius);
        return glm::distance(eye_, center) < s.radius ? 1 : 0;
    }
    double turnsOf(const rows::Polygon& p, Bounds& box) const {
        const rows::PolygonVertex* v = &model_.polygonVertices[p.firstVertex];
        double turns = 0;
        for (uint32_t i = 0; i < p.trips * shared::kPolygonEdgesPerTrip; ++i) {
            box.include(v[i].position);
            if (i > 0)
                turns += solidAngle(v[0].position - eye_, v[i].position - eye_, v[i + 1].position - eye_);
        }
        return turns;
    }
    double turnsOf(const rows::Quadric& q, Bounds& box) const {
        const dvec3 y = eyeIn(q, box);
        for (int i = 0; i < 3; ++i)
            if (y[i] < q.lo[i] || y[i] > q.hi[i]) return 0;
        const double value = glm::dot(y, symmetric(q.squares, q.products) * y + 2.0 * q.linear) + q.constant;
        return value < 0 ? 1 : 0;
    }
    double turnsOf(const rows::Cuboid& c, Bounds& box) const {
        const dvec3 y = eyeIn(c, box);
        return glm::all(glm::lessThan(c.lo, y)) && glm::all(glm::lessThan(y, c.hi)) ? 1 : 0;
    }

    // The eye in the solid's own coordinates.
    template <class Solid>
    dvec3 eyeIn(const Solid& solid, Bounds& box) const {
        box.include(boxOf(solid));
        return toLocal(solid) * (eye_ - solid.point);
    }

    dvec3 eye_;
    const Model& model_;
    std::vector<double> turns_;
    std::vector<Bounds> boxes_;
};

}  // namespace

}  // namespace truth

void setEye(Model& model, const glm::dvec3& eye) {
    if (model.optics.empty()) return;
    const std::vector<uint32_t> media = truth::MediaAround(eye, model).find();
    rows::Environment& e = model.environment;
    uint32_t* const places[] = {&e.eyeMedium0, &e.eyeMedium1, &e.eyeMedium2, &e.eyeMedium3};
    for (size_t i = 0; i < shared::kMaxMedia; ++i) *places[i] = i < media.size() ? media[i] : 0;
}

}  // namespace glint::reference
