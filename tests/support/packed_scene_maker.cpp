#include "support/packed_scene_maker.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace glint::test {
namespace {

using glm::vec3;

struct Bounds {
    vec3 lo{std::numeric_limits<float>::max()}, hi{-std::numeric_limits<float>::max()};
    void include(const vec3& lower, const vec3& upper) {
        lo = glm::min(lo, lower);
        hi = glm::max(hi, upper);
    }
};

struct Item {
    uint32_t kind, index;  // into the arrays as added
    Bounds box;
};

Bounds sphereBounds(const shared::Sphere& s) {
    const glm::dvec3 n(s.anchorNormal);
    const bool anchored = n != glm::dvec3(0);
    const double r = anchored ? s.radius * glm::length(n) : s.radius;
    const glm::dvec3 center = glm::dvec3(s.point) - static_cast<double>(s.radius) * n;
    Bounds b;
    for (int i = 0; i < 3; ++i) {
        b.lo[i] = std::nextafter(static_cast<float>(center[i] - r), -std::numeric_limits<float>::infinity());
        b.hi[i] = std::nextafter(static_cast<float>(center[i] + r), std::numeric_limits<float>::infinity());
    }
    return b;
}

// Splits at the median of the widest axis of the centroids, and small mixed sets by kind.
class TreeMaker {
  public:
    TreeMaker(const PackedScene& from, PackedScene& to, uint32_t leafSize)
        : from_(from), to_(to), leafSize_(leafSize) {}

    void run() {
        std::vector<Item> items;
        for (uint32_t i = 0; i < from_.triangles.size(); ++i) {
            const shared::Triangle& t = from_.triangles[i];
            items.push_back({shared::kKindTriangle, i, {}});
            for (const vec3& v : {t.v0, t.v1, t.v2}) items.back().box.include(v, v);
        }
        for (uint32_t i = 0; i < from_.spheres.size(); ++i) {
            items.push_back({shared::kKindSphere, i, sphereBounds(from_.spheres[i])});
        }
        for (uint32_t i = 0; i < from_.discs.size(); ++i) {
            const shared::Disc& d = from_.discs[i];
            const vec3 reach(std::nextafter(d.radius, std::numeric_limits<float>::infinity()));
            items.push_back({shared::kKindDisc, i, {}});
            items.back().box.include(d.center - 1.01f * reach, d.center + 1.01f * reach);
        }
        for (uint32_t i = 0; i < from_.polygons.size(); ++i) {
            const shared::Polygon& p = from_.polygons[i];
            items.push_back({shared::kKindPolygon, i, {}});
            for (uint32_t v = 0; v <= p.trips * shared::kPolygonEdgesPerTrip; ++v) {
                const vec3 at = from_.polygonVertices[p.firstVertex + v].position;
                items.back().box.include(at, at);
            }
        }
        if (items.empty()) return;
        to_.environment.root = 0;
        if (isLeaf(items.begin(), items.end())) {
            to_.nodes.resize(1);
            to_.nodes[0].child1 = shared::kNone;
            setChild(0, 0, items.begin(), items.end());
        } else {
            makeNode(items.begin(), items.end());
        }
    }

  private:
    using Iterator = std::vector<Item>::iterator;

    bool isLeaf(Iterator first, Iterator last) const {
        return last - first <= leafSize_ &&
               std::all_of(first, last, [&](const Item& i) { return i.kind == first->kind; });
    }

    uint32_t makeNode(Iterator first, Iterator last) {
        const auto index = static_cast<uint32_t>(to_.nodes.size());
        to_.nodes.emplace_back();
        const Iterator middle = split(first, last);
        setChild(index, 0, first, middle);
        setChild(index, 1, middle, last);
        return index;
    }

    void setChild(uint32_t node, int side, Iterator first, Iterator last) {
        Bounds box;
        for (Iterator i = first; i != last; ++i) box.include(i->box.lo, i->box.hi);
        const uint32_t child = isLeaf(first, last) ? makeLeaf(first, last) : makeNode(first, last);
        shared::Node& n = to_.nodes[node];
        (side == 0 ? n.lo0 : n.lo1) = box.lo;
        (side == 0 ? n.hi0 : n.hi1) = box.hi;
        (side == 0 ? n.child0 : n.child1) = child;
    }

    Iterator split(Iterator first, Iterator last) const {
        if (last - first <= leafSize_) {
            const Iterator middle =
                std::partition(first, last, [kind = first->kind](const Item& i) { return i.kind == kind; });
            if (middle != first && middle != last) return middle;
        }
        Bounds centers;
        for (Iterator i = first; i != last; ++i) {
            const vec3 c = 0.5f * i->box.lo + 0.5f * i->box.hi;
            centers.include(c, c);
        }
        const vec3 size = centers.hi - centers.lo;
        const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
        const Iterator middle = first + (last - first) / 2;
        std::nth_element(first, middle, last, [axis](const Item& a, const Item& b) {
            return a.box.lo[axis] + a.box.hi[axis] < b.box.lo[axis] + b.box.hi[axis];
        });
        return middle;
    }

    uint32_t makeLeaf(Iterator first, Iterator last) {
        const uint32_t kind = first->kind;
        const size_t start = kind == shared::kKindTriangle ? to_.triangles.size()
                             : kind == shared::kKindSphere ? to_.spheres.size()
                             : kind == shared::kKindDisc   ? to_.discs.size()
                                                           : to_.polygons.size();
        for (Iterator i = first; i != last; ++i) {
            if (kind == shared::kKindTriangle) {
                to_.triangles.push_back(from_.triangles[i->index]);
                to_.triangleSurfaces.push_back(from_.triangleSurfaces[i->index]);
            } else if (kind == shared::kKindSphere) {
                to_.spheres.push_back(from_.spheres[i->index]);
            } else if (kind == shared::kKindDisc) {
                to_.discs.push_back(from_.discs[i->index]);
            } else {
                to_.polygons.push_back(from_.polygons[i->index]);
            }
        }
        return shared::kLeafFlag | first->kind << shared::kLeafKindShift |
               static_cast<uint32_t>(last - first - 1) << shared::kLeafCountShift |
               static_cast<uint32_t>(start);
    }

    const PackedScene& from_;
    PackedScene& to_;
    uint32_t leafSize_;
};

}  // namespace

SceneMaker::SceneMaker() {
    environment.root = shared::kNone;
    environment.maxDepth = 5;
    material(vec3(1));
}

uint32_t SceneMaker::material(const vec3& diffuse, const vec3& specular, float shininess, const vec3& mirror,
                              const vec3& ambient) {
    shared::Material m;
    m.ambient = ambient;
    m.diffuse = diffuse;
    m.specular = specular;
    m.shininess = shininess;
    m.mirror = mirror;
    scene_.materials.push_back(m);
    return static_cast<uint32_t>(scene_.materials.size()) - 1;
}

uint32_t SceneMaker::triangle(const vec3& v0, const vec3& v1, const vec3& v2, uint32_t material) {
    shared::Triangle t;
    t.v0 = v0;
    t.v1 = v1;
    t.v2 = v2;
    t.id = nextId_;
    shared::TriangleSurface s;
    s.normal =
        vec3(glm::normalize(glm::cross(glm::dvec3(v1) - glm::dvec3(v0), glm::dvec3(v2) - glm::dvec3(v0))));
    s.object = nextId_;
    s.material = material;
    s.vertexNormals = shared::kNone;
    scene_.triangles.push_back(t);
    scene_.triangleSurfaces.push_back(s);
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
    shared::Sphere s;
    s.point = point;
    s.anchorNormal = normal;
    s.radius = radius;
    s.id = s.object = nextId_;
    s.material = material;
    scene_.spheres.push_back(s);
    return nextId_++;
}

uint32_t SceneMaker::plane(const vec3& point, const vec3& normal, uint32_t material) {
    shared::Plane p;
    p.point = point;
    p.normal = normal;
    p.id = p.object = nextId_;
    p.material = material;
    scene_.planes.push_back(p);
    return nextId_++;
}

uint32_t SceneMaker::disc(const vec3& center, const vec3& normal, float radius, uint32_t material) {
    shared::Disc d;
    d.center = center;
    d.normal = normal;
    d.radius = radius;
    d.id = d.object = nextId_;
    d.material = material;
    scene_.discs.push_back(d);
    return nextId_++;
}

uint32_t SceneMaker::polygon(const std::vector<vec3>& vertices, uint32_t material) {
    const glm::dvec3 a(vertices[0]), b(vertices[1]), c(vertices[2]);
    shared::Polygon p;
    p.point = vertices[0];
    p.normal = vec3(glm::normalize(glm::cross(b - a, c - a)));
    p.id = p.object = nextId_;
    p.material = material;
    p.firstVertex = static_cast<uint32_t>(scene_.polygonVertices.size());
    p.trips = (static_cast<uint32_t>(vertices.size()) + shared::kPolygonEdgesPerTrip - 1) /
              shared::kPolygonEdgesPerTrip;
    for (size_t i = 0; i <= size_t{p.trips} * shared::kPolygonEdgesPerTrip; ++i)
        scene_.polygonVertices.push_back({vertices[i < vertices.size() ? i : 0], 0});
    scene_.polygons.push_back(p);
    return nextId_++;
}

void SceneMaker::cube(const vec3& center, float halfEdge) {
    for (int axis = 0; axis < 3; ++axis) {
        for (const float side : {-1.0f, 1.0f}) {
            vec3 corners[4];
            for (int k = 0; k < 4; ++k) {  // counterclockwise seen from outside, for side = 1
                corners[k][axis] = side;
                corners[k][(axis + 1) % 3] = k == 1 || k == 2 ? 1.0f : -1.0f;
                corners[k][(axis + 2) % 3] = k >= 2 ? 1.0f : -1.0f;
                corners[k] = center + halfEdge * corners[k];
            }
            if (side < 0) std::swap(corners[1], corners[3]);
            triangle(corners[0], corners[1], corners[2]);
            triangle(corners[0], corners[2], corners[3]);
        }
    }
}

void SceneMaker::light(uint32_t kind, const vec3& position, const vec3& intensity) {
    shared::Light l;
    l.kind = kind;
    l.position = position;
    l.intensity = intensity;
    scene_.lights.push_back(l);
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
    PackedScene scene;
    scene.planes = scene_.planes;
    scene.materials = scene_.materials;
    scene.lights = scene_.lights;
    scene.vertexNormals = scene_.vertexNormals;
    scene.polygonVertices = scene_.polygonVertices;
    scene.environment = environment;
    scene.environment.planeCount = static_cast<uint32_t>(scene.planes.size());
    scene.environment.lightCount = static_cast<uint32_t>(scene.lights.size());
    TreeMaker(scene_, scene, maxLeafSize).run();
    return scene;
}

BumpyMesh makeBumpyMesh(uint32_t seed, uint32_t steps) {
    Random random(seed);
    BumpyMesh mesh;
    // The poles and the seam are single vertices, so that the mesh is closed.
    const auto add = [&](double theta, double phi) {
        const double r = 1 + 5 * random.uniform(0, 1);
        mesh.vertices.emplace_back(r * std::sin(theta) * std::cos(phi), r * std::sin(theta) * std::sin(phi),
                                   r * std::cos(theta));
    };
    add(0, 0);
    for (uint32_t t = 1; t < steps; ++t) {
        for (uint32_t p = 0; p < steps; ++p)
            add(std::numbers::pi * t / steps, 2 * std::numbers::pi * p / steps);
    }
    add(std::numbers::pi, 0);
    const auto vertex = [&](uint32_t t, uint32_t p) {
        if (t == 0) return 0u;
        if (t == steps) return static_cast<uint32_t>(mesh.vertices.size()) - 1;
        return 1 + (t - 1) * steps + p % steps;
    };
    for (uint32_t t = 0; t < steps; ++t) {
        for (uint32_t p = 0; p < steps; ++p) {
            if (t > 0) mesh.triangles.emplace_back(vertex(t, p), vertex(t + 1, p), vertex(t, p + 1));
            if (t + 1 < steps)
                mesh.triangles.emplace_back(vertex(t + 1, p), vertex(t + 1, p + 1), vertex(t, p + 1));
        }
    }
    return mesh;
}

reference::Ray makeRay(const glm::dvec3& origin, const glm::dvec3& direction) {
    reference::Ray ray;
    ray.origin = origin;
    ray.direction = direction;
    return ray;
}

reference::Ray rayTowards(const glm::dvec3& origin, const glm::dvec3& target) {
    return makeRay(origin, target - origin);
}

glm::dvec3 Random::direction() {
    const double z = uniform(-1, 1), phi = uniform(0, 2 * std::numbers::pi), r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

}  // namespace glint::test
