#include "support/packed_scene_maker.h"

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <numbers>

#include "bvh/flatten.h"

namespace glint::test {
namespace {

using glm::vec3;

Box around(std::initializer_list<vec3> points) {
    Box box;
    for (const vec3& p : points) box.include(p);
    return box;
}

Box boxOf(const shared::Triangle& t) {
    return around({t.v0, t.v1, t.v2});
}

Box boxOf(const shared::Sphere& s) {
    const glm::dvec3 n(s.anchorNormal);
    const bool anchored = n != glm::dvec3(0);
    const double r = anchored ? s.radius * glm::length(n) : s.radius;
    const glm::dvec3 center = glm::dvec3(s.point) - static_cast<double>(s.radius) * n;
    Box box;
    for (int i = 0; i < 3; ++i) {
        box.lo[i] = std::nextafter(static_cast<float>(center[i] - r), -shared::kInfinity);
        box.hi[i] = std::nextafter(static_cast<float>(center[i] + r), shared::kInfinity);
    }
    return box;
}

Box boxOf(const shared::Disc& d) {
    const vec3 reach(1.01f * d.radius);
    return around({d.center - reach, d.center + reach});
}

// Gives the children of a node of flattenBvh their boxes as they were built: flattenBvh widens them.
void tighten(const Bvh& bvh, uint32_t from, std::vector<shared::Node>& nodes, uint32_t to) {
    shared::Node& node = nodes[to];
    const BvhNode &left = bvh.nodes[bvh.nodes[from].first], &right = bvh.nodes[bvh.nodes[from].first + 1];
    node.lo0 = left.box.lo, node.hi0 = left.box.hi;
    node.lo1 = right.box.lo, node.hi1 = right.box.hi;
    if (isInnerChild(node.child0)) tighten(bvh, bvh.nodes[from].first, nodes, node.child0);
    if (isInnerChild(node.child1)) tighten(bvh, bvh.nodes[from].first + 1, nodes, node.child1);
}

vec3 normalOf(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
    return vec3(glm::normalize(glm::cross(b - a, c - a)));
}

// Orders the primitives by the leaves of a tree over them.
void makeTree(PackedScene& scene, uint32_t maxLeafSize) {
    const PackedScene given = scene;
    std::vector<Box> boxes;
    std::vector<uint8_t> kinds;
    const auto add = [&](uint32_t kind, const Box& box) {
        boxes.push_back(box);
        kinds.push_back(static_cast<uint8_t>(kind));
    };
    for (const shared::Triangle& t : given.triangles) add(shared::kKindTriangle, boxOf(t));
    for (const shared::Sphere& s : given.spheres) add(shared::kKindSphere, boxOf(s));
    for (const shared::Disc& d : given.discs) add(shared::kKindDisc, boxOf(d));
    for (const shared::Polygon& p : given.polygons) {
        Box box;
        for (uint32_t v = 0; v <= p.trips * shared::kPolygonEdgesPerTrip; ++v)
            box.include(given.polygonVertices[p.firstVertex + v].position);
        add(shared::kKindPolygon, box);
    }
    if (boxes.empty()) return;
    const Bvh bvh = buildBvh(boxes, {.maxLeafSize = maxLeafSize, .groups = &kinds});
    scene.nodes = flattenBvh(bvh, kinds);
    scene.environment.root = 0;
    if (bvh.nodes.size() > 1) {
        tighten(bvh, 0, scene.nodes, 0);
    } else {
        scene.nodes[0].lo0 = bvh.nodes[0].box.lo;
        scene.nodes[0].hi0 = bvh.nodes[0].box.hi;
    }
    // Each kind in the order of its leaves.
    const size_t spheres = given.triangles.size(), discs = spheres + given.spheres.size(),
                 polygons = discs + given.discs.size();
    std::vector<uint32_t> next(4, 0);
    for (const uint32_t item : bvh.order) {
        if (item < spheres) {
            scene.triangles[next[0]] = given.triangles[item];
            scene.triangleSurfaces[next[0]++] = given.triangleSurfaces[item];
        } else if (item < discs) {
            scene.spheres[next[1]++] = given.spheres[item - spheres];
        } else if (item < polygons) {
            scene.discs[next[2]++] = given.discs[item - discs];
        } else {
            scene.polygons[next[3]++] = given.polygons[item - polygons];
        }
    }
}

}  // namespace

SceneMaker::SceneMaker() {
    environment.root = shared::kNone;
    environment.maxDepth = 5;
    material(vec3(1));
}

uint32_t SceneMaker::material(const vec3& diffuse, const vec3& specular, float shininess, const vec3& mirror,
                              const vec3& ambient) {
    scene_.materials.push_back({.ambient = ambient,
                                .shininess = shininess,
                                .diffuse = diffuse,
                                .specular = specular,
                                .mirror = mirror});
    return static_cast<uint32_t>(scene_.materials.size()) - 1;
}

uint32_t SceneMaker::triangle(const vec3& v0, const vec3& v1, const vec3& v2, uint32_t material) {
    scene_.triangles.push_back({.v0 = v0, .id = nextId_, .v1 = v1, .v2 = v2});
    scene_.triangleSurfaces.push_back({.normal = normalOf(v0, v1, v2),
                                       .object = nextId_,
                                       .material = material,
                                       .vertexNormals = shared::kNone});
    return nextId_++;
}

uint32_t SceneMaker::triangle(const vec3& v0, const vec3& v1, const vec3& v2,
                              const shared::VertexNormals& normals, uint32_t material) {
    const uint32_t id = triangle(v0, v1, v2, material);
    scene_.triangleSurfaces.back().vertexNormals = static_cast<uint32_t>(scene_.vertexNormals.size());
    scene_.vertexNormals.push_back(normals);
    return id;
}

uint32_t SceneMaker::sphere(const vec3& center, float radius, uint32_t material) {
    return anchoredSphere(center, vec3(0), radius, material);
}

uint32_t SceneMaker::anchoredSphere(const vec3& point, const vec3& normal, float radius, uint32_t material) {
    scene_.spheres.push_back({.point = point,
                              .radius = radius,
                              .anchorNormal = normal,
                              .id = nextId_,
                              .object = nextId_,
                              .material = material});
    return nextId_++;
}

uint32_t SceneMaker::plane(const vec3& point, const vec3& normal, uint32_t material) {
    scene_.planes.push_back(
        {.point = point, .id = nextId_, .normal = normal, .object = nextId_, .material = material});
    return nextId_++;
}

uint32_t SceneMaker::disc(const vec3& center, const vec3& normal, float radius, uint32_t material) {
    scene_.discs.push_back({.center = center,
                            .id = nextId_,
                            .normal = normal,
                            .radius = radius,
                            .object = nextId_,
                            .material = material});
    return nextId_++;
}

uint32_t SceneMaker::polygon(const std::vector<vec3>& vertices, uint32_t material) {
    const uint32_t trips = (static_cast<uint32_t>(vertices.size()) + shared::kPolygonEdgesPerTrip - 1) /
                           shared::kPolygonEdgesPerTrip;
    scene_.polygons.push_back({.point = vertices[0],
                               .id = nextId_,
                               .normal = normalOf(vertices[0], vertices[1], vertices[2]),
                               .object = nextId_,
                               .material = material,
                               .firstVertex = static_cast<uint32_t>(scene_.polygonVertices.size()),
                               .trips = trips});
    for (size_t i = 0; i <= size_t{trips} * shared::kPolygonEdgesPerTrip; ++i)
        scene_.polygonVertices.push_back({vertices[i < vertices.size() ? i : 0], 0});
    return nextId_++;
}

void SceneMaker::cube(const vec3& center, float halfEdge) {
    const ClosedMesh cube = gridCube(1);
    const auto corner = [&](uint32_t v) { return center + halfEdge * vec3(cube.vertices[v]); };
    for (const glm::uvec3& t : cube.triangles) triangle(corner(t.x), corner(t.y), corner(t.z));
}

void SceneMaker::light(uint32_t kind, const vec3& position, const vec3& intensity) {
    scene_.lights.push_back({.position = position, .kind = kind, .intensity = intensity});
}

void SceneMaker::spot(const vec3& position, const vec3& axis, double angle, double penumbra, uint32_t kind,
                      const vec3& intensity) {
    light(kind, position, intensity);
    const auto oneMinusCosine = [](double degrees) {
        return static_cast<float>(1 - std::cos(degrees * std::numbers::pi / 180));
    };
    shared::Light& l = scene_.lights.back();
    l.axis = axis;
    l.inner = oneMinusCosine(angle);
    l.outer = oneMinusCosine(angle + penumbra);
}

PackedScene SceneMaker::finish(uint32_t maxLeafSize) const {
    PackedScene scene = scene_;
    scene.environment = environment;
    scene.environment.planeCount = static_cast<uint32_t>(scene.planes.size());
    scene.environment.lightCount = static_cast<uint32_t>(scene.lights.size());
    makeTree(scene, maxLeafSize);
    return scene;
}

ClosedMesh makeBall(uint32_t parallels, uint32_t meridians, const std::function<double()>& radius) {
    ClosedMesh mesh;
    // The poles and the seam are single vertices, so that the mesh is closed.
    const auto add = [&](double theta, double phi) {
        const double r = radius();
        mesh.vertices.emplace_back(r * std::sin(theta) * std::cos(phi), r * std::sin(theta) * std::sin(phi),
                                   r * std::cos(theta));
    };
    add(0, 0);
    for (uint32_t t = 1; t < parallels; ++t) {
        for (uint32_t p = 0; p < meridians; ++p)
            add(std::numbers::pi * t / parallels, 2 * std::numbers::pi * p / meridians);
    }
    add(std::numbers::pi, 0);
    const auto vertex = [&](uint32_t t, uint32_t p) {
        if (t == 0) return 0u;
        if (t == parallels) return static_cast<uint32_t>(mesh.vertices.size()) - 1;
        return 1 + (t - 1) * meridians + p % meridians;
    };
    for (uint32_t t = 0; t < parallels; ++t) {
        for (uint32_t p = 0; p < meridians; ++p) {
            if (t > 0) mesh.triangles.emplace_back(vertex(t, p), vertex(t + 1, p), vertex(t, p + 1));
            if (t + 1 < parallels)
                mesh.triangles.emplace_back(vertex(t + 1, p), vertex(t + 1, p + 1), vertex(t, p + 1));
        }
    }
    return mesh;
}

ClosedMesh makeBumpyMesh(uint32_t seed, uint32_t steps) {
    Random random(seed);
    ClosedMesh mesh = makeBall(steps, steps, [&] { return 1 + 5 * random.uniform(0, 1); });
    for (glm::dvec3& v : mesh.vertices) v = vec3(v);
    return mesh;
}

ClosedMesh gridCube(uint32_t n) {
    ClosedMesh cube;
    std::map<std::array<double, 3>, uint32_t> known;
    for (int axis = 0; axis < 3; ++axis) {
        for (const double side : {-1.0, 1.0}) {
            const auto at = [&](uint32_t i, uint32_t j) {
                glm::dvec3 v;
                v[axis] = side;
                v[(axis + 1) % 3] = -1 + 2.0 * i / n;
                v[(axis + 2) % 3] = -1 + 2.0 * j / n;
                const auto [found, fresh] =
                    known.emplace(std::array{v.x, v.y, v.z}, static_cast<uint32_t>(cube.vertices.size()));
                if (fresh) cube.vertices.push_back(v);
                return found->second;
            };
            for (uint32_t i = 0; i < n; ++i) {
                for (uint32_t j = 0; j < n; ++j) {
                    uint32_t a = at(i, j), b = at(i + 1, j), c = at(i + 1, j + 1), d = at(i, j + 1);
                    if (side < 0) std::swap(b, d);
                    cube.triangles.insert(cube.triangles.end(), {{a, b, c}, {a, c, d}});
                }
            }
        }
    }
    return cube;
}

std::optional<reference::Hit> closestOfAll(const reference::Tracer& tracer, const reference::Ray& ray,
                                           const reference::Source& source) {
    const auto model = std::make_shared<reference::Model>(tracer.model());
    std::vector<reference::rows::Node> nodes = *model->nodes;
    const glm::dvec3 endless(std::numeric_limits<double>::infinity());
    for (reference::rows::Node& node : nodes) {
        node.lo0 = node.lo1 = -endless;
        node.hi0 = node.hi1 = endless;
    }
    model->nodes = std::make_shared<const std::vector<reference::rows::Node>>(std::move(nodes));
    return reference::Tracer(model, {.methods = tracer.methods()}, 0).closest(ray, source);
}

reference::Ray makeRay(const glm::dvec3& origin, const glm::dvec3& direction) {
    return {origin, direction};
}

reference::Ray rayTowards(const glm::dvec3& origin, const glm::dvec3& target) {
    return makeRay(origin, target - origin);
}

glm::dvec3 Random::direction() {
    const double z = uniform(-1, 1), phi = uniform(0, 2 * std::numbers::pi), r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

}  // namespace glint::test
