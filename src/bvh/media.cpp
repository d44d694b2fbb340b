#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "bvh/packed_scene.h"

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
        addFlat();
        addRound();
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

    void addFlat() {
        for (size_t i = 0; i < scene_.triangles.size(); ++i) {
            const shared::Triangle& t = scene_.triangles[i];
            const uint32_t medium = mediumOf(scene_.triangleSurfaces[i].material);
            if (medium != 0) addTriangle(medium, dvec3(t.v0), dvec3(t.v1), dvec3(t.v2));
        }
        // A fan about the first vertex: what it covers twice with opposite signs, in a concave outline,
        // cancels.
        for (const shared::Polygon& polygon : scene_.polygons) {
            const uint32_t medium = mediumOf(polygon.material);
            if (medium == 0) continue;
            const shared::PolygonVertex* v = &scene_.polygonVertices[polygon.firstVertex];
            const uint32_t edges = polygon.trips * shared::kPolygonEdgesPerTrip;
            for (uint32_t i = 1; i + 1 < edges; ++i)
                addTriangle(medium, dvec3(v[0].position), dvec3(v[i].position), dvec3(v[i + 1].position));
        }
    }

    void addRound() {
        for (const shared::Sphere& sphere : scene_.spheres) {
            if (mediumOf(sphere.material) == 0) continue;
            Enclosure& e = enclosures_[mediumOf(sphere.material)];
            const dvec3 offset = point_ - dvec3(sphere.point), normal(sphere.anchorNormal);
            const double radius = sphere.radius;
            const bool anchored = sphere.anchorNormal != glm::vec3(0);
            const double side = glm::dot(offset, offset) +
                                (anchored ? 2 * radius * glm::dot(normal, offset) : -radius * radius);
            e.windings += side < 0 ? 1 : 0;
            const dvec3 center = dvec3(sphere.point) - radius * normal;
            e.include(center - radius);
            e.include(center + radius);
        }
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
