#include "view/view_scene.h"

#include <algorithm>
#include <limits>

#include "import/load.h"

namespace glint::view {

namespace {

struct Box {
    glm::dvec3 lo{std::numeric_limits<double>::infinity()};
    glm::dvec3 hi{-std::numeric_limits<double>::infinity()};

    void add(const glm::dvec3& p) {
        lo = glm::min(lo, p);
        hi = glm::max(hi, p);
    }
    bool empty() const { return lo.x > hi.x; }
    Ball ball(const glm::dvec3& origin) const {
        // A single point still needs a distance to be seen from.
        return {origin + 0.5 * (lo + hi), std::max(0.5 * glm::length(hi - lo), 1e-6)};
    }
};

bool reflects(const shared::Material& m) {
    return m.mirror.x > 0 || m.mirror.y > 0 || m.mirror.z > 0;
}

// From the packed arrays: they hold every kind of object as the few kinds that are traced. Calls
// point(centre, radius) for all that belongs to `object`.
template <typename Point>
void visitPoints(const PackedScene& p, uint32_t object, const Point& point) {
    for (size_t i = 0; i < p.triangleSurfaces.size(); ++i) {
        if (p.triangleSurfaces[i].object != object) continue;
        for (const glm::vec3& v : {p.triangles[i].v0, p.triangles[i].v1, p.triangles[i].v2}) point(v, 0.0);
    }
    for (const shared::Sphere& s : p.spheres) {
        const bool anchored = s.anchorNormal != glm::vec3(0);  // as good as endless
        if (s.object == object && !anchored) point(s.point, static_cast<double>(s.radius));
    }
    for (const shared::Disc& d : p.discs) {
        if (d.object == object) point(d.center, static_cast<double>(d.radius));
    }
    for (const shared::Quadric& q : p.quadrics) {
        if (q.object != object) continue;
        const glm::dmat3 rows(glm::dvec3(q.toLocal0), glm::dvec3(q.toLocal1), glm::dvec3(q.toLocal2));
        const glm::dmat3 back = glm::inverse(glm::transpose(rows));
        for (int corner = 0; corner < 8; ++corner) {
            const glm::dvec3 y((corner & 1 ? q.hi : q.lo).x, (corner & 2 ? q.hi : q.lo).y,
                               (corner & 4 ? q.hi : q.lo).z);
            point(glm::dvec3(q.point) + back * y, 0.0);
        }
    }
    for (const shared::Polygon& polygon : p.polygons) {
        if (polygon.object != object) continue;
        for (uint32_t i = 0; i <= polygon.trips * shared::kPolygonEdgesPerTrip; ++i) {
            point(p.polygonVertices[polygon.firstVertex + i].position, 0.0);
        }
    }
}

}  // namespace

std::shared_ptr<const ViewScene> loadViewScene(const std::filesystem::path& path, std::optional<int> maxDepth,
                                               std::optional<int> samplesPerPixel) {
    auto loaded = std::make_shared<ViewScene>();
    loaded->path = path;
    loaded->scene = loadScene(path);
    if (maxDepth) loaded->scene.maxDepth = *maxDepth;
    if (samplesPerPixel) loaded->scene.image.samplesPerPixel = *samplesPerPixel;
    loaded->packed = packScene(loaded->scene);
    const auto& materials = loaded->packed.materials;
    loaded->also.mirrors = std::any_of(materials.begin(), materials.end(), reflects);
    loaded->also.parallelCamera = true;  // P may ask for it
    return loaded;
}

Ball boundsOf(const ViewScene& scene) {
    const PackedScene& p = scene.packed;
    if (p.environment.root != shared::kNone) {
        Box box;
        box.add(p.boundsLo);
        box.add(p.boundsHi);
        return box.ball(p.origin);
    }
    const Camera& c = scene.scene.camera;
    return {c.target, 0.5 * glm::length(c.eye - c.target)};
}

Ball boundsOf(const ViewScene& scene, uint32_t object, const glm::dvec3& hit, double distance) {
    const PackedScene& p = scene.packed;
    Box box;
    visitPoints(p, object, [&](const glm::dvec3& point, double radius) {
        box.add(point - radius);
        box.add(point + radius);
    });
    if (box.empty()) return {hit, std::max(0.1 * distance, 1e-6)};
    const glm::dvec3 center = 0.5 * (box.lo + box.hi);
    double reach = 1e-6;
    visitPoints(p, object, [&](const glm::dvec3& point, double radius) {
        reach = std::max(reach, glm::length(point - center) + radius);
    });
    return {p.origin + center, reach};
}

}  // namespace glint::view
