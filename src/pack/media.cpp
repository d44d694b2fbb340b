#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "pack/packed_scene.h"

namespace glint {
namespace {

using glm::dvec3;

// What is known of a material's surfaces around a point.
struct Enclosure {
    double windings = 0;  // how often they go round it
    double size = 0;      // the diagonal of their box, infinite with a plane
    dvec3 lo{std::numeric_limits<double>::infinity()}, hi{-std::numeric_limits<double>::infinity()};

    void include(const dvec3& p) {
        lo = glm::min(lo, p);
        hi = glm::max(hi, p);
    }
};

// The solid angle of a triangle over that of the whole sphere, positive if its outer side is turned away.
double windingOf(const dvec3& a, const dvec3& b, const dvec3& c) {
    const double la = glm::length(a), lb = glm::length(b), lc = glm::length(c);
    const double volume = glm::dot(a, glm::cross(b, c));
    const double cosines = la * lb * lc + glm::dot(a, b) * lc + glm::dot(b, c) * la + glm::dot(c, a) * lb;
    return 2 * std::atan2(volume, cosines) / (4 * std::numbers::pi);
}

class MediaFinder {
  public:
    MediaFinder(const PackedScene& scene, const dvec3& point)
        : scene_(scene), point_(point), enclosures_(scene.optics.size() + 1) {}

    glm::uvec4 find() {
        if (scene_.environment.root != shared::kNone) addTree(scene_.environment.root, {});
        addPlanes();
        std::vector<uint32_t> media;
        for (uint32_t medium = 1; medium < enclosures_.size(); ++medium) {
            Enclosure& e = enclosures_[medium];
            if (e.size == 0) e.size = glm::length(e.hi - e.lo);
            const auto times = static_cast<int>(std::lround(e.windings));
            for (int i = 0; i < times && i < static_cast<int>(shared::kMaxMedia); ++i)
                media.push_back(medium);
        }
        std::stable_sort(media.begin(), media.end(),
                         [&](uint32_t a, uint32_t b) { return enclosures_[a].size > enclosures_[b].size; });
        glm::uvec4 found(0);
        for (size_t i = 0; i < std::min<size_t>(media.size(), shared::kMaxMedia); ++i)
            found[static_cast<int>(i)] = media[i];
        return found;
    }

  private:
    uint32_t mediumOf(uint32_t material) const { return scene_.materials[material].medium; }

    void addTriangle(uint32_t medium, const dvec3& a, const dvec3& b, const dvec3& c) {
        Enclosure& e = enclosures_[medium];
        for (const dvec3& p : {a, b, c}) e.include(p);
        e.windings += windingOf(a - point_, b - point_, c - point_);
    }

    // Where a tree stands: the world itself, or an instance.
    struct Place {
        const shared::Instance* instance = nullptr;

        dvec3 world(const glm::vec3& p) const {
            if (instance == nullptr) return dvec3(p);
            const dvec3 x(p);
            return dvec3(instance->place) + dvec3(glm::dot(dvec3(instance->toWorldX), x),
                                                  glm::dot(dvec3(instance->toWorldY), x),
                                                  glm::dot(dvec3(instance->toWorldZ), x));
        }
        uint32_t material(uint32_t own) const {
            return instance == nullptr || instance->material == shared::kNone ? own : instance->material;
        }
    };

    void addTree(uint32_t root, const Place& place) {
        std::vector<uint32_t> pending{root};
        while (!pending.empty()) {
            const uint32_t child = pending.back();
            pending.pop_back();
            if (child == shared::kNone) continue;
            if ((child & shared::kLeafFlag) == 0) {
                pending.push_back(scene_.nodes[child].child0);
                pending.push_back(scene_.nodes[child].child1);
                continue;
            }
            const uint32_t first = child & shared::kLeafFirstMask;
            const uint32_t count = (child >> shared::kLeafCountShift & shared::kLeafCountMask) + 1;
            for (uint32_t i = first; i < first + count; ++i)
                addPrimitive(child >> shared::kLeafKindShift & shared::kLeafKindMask, i, place);
        }
    }

    void addPrimitive(uint32_t kind, uint32_t i, const Place& place) {
        switch (kind) {
            case shared::kKindTriangle:
                return addTriangle(scene_.triangles[i],
                                   mediumOf(place.material(scene_.triangleSurfaces[i].material)), place);
            case shared::kKindPolygon:
                return addPolygon(scene_.polygons[i]);
            case shared::kKindSphere:
                return addSphere(scene_.spheres[i]);
            case shared::kKindQuadric:
                return addQuadric(scene_.quadrics[i]);
            case shared::kKindInstance:
                return addTree(scene_.instances[i].root, {&scene_.instances[i]});
            default:;  // discs enclose nothing
        }
    }

    // A mirrored instance turns the winding of its triangles around.
    void addTriangle(const shared::Triangle& t, uint32_t medium, const Place& place) {
        if (medium == 0) return;
        const bool mirrored = place.instance != nullptr && place.instance->mirrored != 0;
        const dvec3 b = place.world(t.v1), c = place.world(t.v2);
        addTriangle(medium, place.world(t.v0), mirrored ? c : b, mirrored ? b : c);
    }

    // A fan about the first vertex: what it covers twice with opposite signs, in a concave outline, cancels.
    void addPolygon(const shared::Polygon& polygon) {
        const uint32_t medium = mediumOf(polygon.material);
        if (medium == 0) return;
        const shared::PolygonVertex* v = &scene_.polygonVertices[polygon.firstVertex];
        const uint32_t edges = polygon.trips * shared::kPolygonEdgesPerTrip;
        for (uint32_t i = 1; i + 1 < edges; ++i)
            addTriangle(medium, dvec3(v[0].position), dvec3(v[i].position), dvec3(v[i + 1].position));
    }

    void addSphere(const shared::Sphere& sphere) {
        if (mediumOf(sphere.material) == 0) return;
        Enclosure& e = enclosures_[mediumOf(sphere.material)];
        const dvec3 offset = point_ - dvec3(sphere.point), normal(sphere.anchorNormal);
        const double radius = sphere.radius;
        const bool anchored = sphere.anchorNormal != glm::vec3(0);
        const double side =
            glm::dot(offset, offset) + (anchored ? 2 * radius * glm::dot(normal, offset) : -radius * radius);
        e.windings += side < 0 ? 1 : 0;
        const dvec3 center = dvec3(sphere.point) - radius * normal;
        e.include(center - radius);
        e.include(center + radius);
    }

    // Inside if it is so of the surface and of the box that cuts it off, as of a capped one.
    void addQuadric(const shared::Quadric& q) {
        if (mediumOf(q.material) == 0) return;
        Enclosure& e = enclosures_[mediumOf(q.material)];
        const glm::dmat3 toLocal =
            glm::transpose(glm::dmat3(dvec3(q.toLocal0), dvec3(q.toLocal1), dvec3(q.toLocal2)));
        const dvec3 y = toLocal * (point_ - dvec3(q.point)), s(q.squares), p(q.products);
        const dvec3 qy(s.x * y.x + p.z * y.y + p.y * y.z, p.z * y.x + s.y * y.y + p.x * y.z,
                       p.y * y.x + p.x * y.y + s.z * y.z);
        const double side =
            glm::dot(y, qy) + 2 * glm::dot(dvec3(q.linear), y) + static_cast<double>(q.constant);
        const bool inBox =
            glm::all(glm::greaterThanEqual(y, dvec3(q.lo))) && glm::all(glm::lessThanEqual(y, dvec3(q.hi)));
        e.windings += side < 0 && inBox ? 1 : 0;
        const glm::dmat3 toWorld = glm::inverse(toLocal);
        for (int i = 0; i < 8; ++i) {
            const dvec3 corner(i & 1 ? q.hi.x : q.lo.x, i & 2 ? q.hi.y : q.lo.y, i & 4 ? q.hi.z : q.lo.z);
            e.include(dvec3(q.point) + toWorld * corner);
        }
    }

    void addPlanes() {
        for (const shared::Plane& plane : scene_.planes) {
            if (mediumOf(plane.material) == 0) continue;
            Enclosure& e = enclosures_[mediumOf(plane.material)];
            e.windings += glm::dot(dvec3(plane.normal), point_ - dvec3(plane.point)) < 0 ? 1 : 0;
            e.size = std::numeric_limits<double>::infinity();
        }
    }

    const PackedScene& scene_;
    dvec3 point_;
    std::vector<Enclosure> enclosures_;  // by medium; 0 is unused
};

}  // namespace

glm::uvec4 mediaAt(const PackedScene& scene, const glm::dvec3& point) {
    return scene.optics.empty() ? glm::uvec4(0) : MediaFinder(scene, point).find();
}

}  // namespace glint
