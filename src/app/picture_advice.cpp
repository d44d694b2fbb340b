#include "app/picture_advice.h"

#include <algorithm>
#include <array>
#include <limits>
#include <variant>

#include "reference/tracer.h"
#include "scene/camera_frame.h"

namespace glint::app {

namespace {

// Position of the box around all finite geometry in the camera's view.
struct Placement {
    double depthMin = std::numeric_limits<double>::infinity();   // beyond the plane through the eye that
    double depthMax = -std::numeric_limits<double>::infinity();  // is parallel to the image plane
    double distanceMin = 0, distanceMax = 0;                     // along camera rays, of any of its points
};

Placement placeBounds(const Camera& camera, const PackedScene& packed) {
    const glm::dvec3 lo = packed.origin + glm::dvec3(packed.boundsLo),
                     hi = packed.origin + glm::dvec3(packed.boundsHi);
    const CameraFrame frame = cameraFrame(camera);
    Placement p;
    for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 point(corner & 1 ? hi.x : lo.x, corner & 2 ? hi.y : lo.y, corner & 4 ? hi.z : lo.z);
        const double depth = -glm::dot(point - camera.eye, frame.w);
        p.depthMin = std::min(p.depthMin, depth);
        p.depthMax = std::max(p.depthMax, depth);
        p.distanceMax = std::max(p.distanceMax, glm::distance(point, camera.eye));
    }
    p.distanceMin = glm::distance(glm::clamp(camera.eye, lo, hi), camera.eye);
    if (camera.projection == Projection::Orthographic) {
        const double cosine = -glm::dot(frame.view, frame.w);
        p.distanceMin = p.depthMin / cosine;
        p.distanceMax = p.depthMax / cosine;
    }
    return p;
}

// Camera rays spread over the picture, followed by the reference.
class Scout {
  public:
    Scout(const Picture& picture, const Scene& scene, const PackedScene& packed, const Request& request)
        : tracer_(packed, request),
          camera_(packCamera(scene.camera, request.width, request.height, packed.origin)) {
        constexpr int kSide = 16;
        const Region& r = picture.region;
        for (int i = 0; i < kSide * kSide; ++i) {
            rays_.push_back(tracer_.cameraRay(camera_, r.x0 + (i % kSide + 0.5) * r.width() / kSide,
                                              r.y0 + (i / kSide + 0.5) * r.height() / kSide));
        }
    }
    // Hits of the rays without near and far limits.
    std::vector<reference::Hit> unboundedHits() const {
        std::vector<reference::Hit> hits;
        for (reference::Ray ray : rays_) {
            ray.tMin = 0;
            ray.tMax = std::numeric_limits<double>::infinity();
            if (const auto hit = tracer_.closest(ray)) hits.push_back(*hit);
        }
        return hits;
    }
    // The paths that meet something.
    std::vector<reference::PixelRecord> paths() const {
        std::vector<reference::PixelRecord> records;
        for (const reference::Ray& ray : rays_) {
            records.push_back(tracer_.trace(ray, {}, true));
            if (!records.back().surface) records.pop_back();
        }
        return records;
    }
    size_t rays() const { return rays_.size(); }

  private:
    reference::Tracer tracer_;
    shared::Camera camera_;
    std::vector<reference::Ray> rays_;
};

// The camera's ends cut everything off that its rays would meet.
std::optional<std::string> clippedReason(const Camera& camera, const std::vector<reference::Hit>& hits) {
    if (hits.empty()) return std::nullopt;
    const auto all = [&](const auto& test) { return std::all_of(hits.begin(), hits.end(), test); };
    if (all([&](const reference::Hit& hit) { return hit.t > camera.farT; }))
        return "everything is farther away than the camera's far";
    if (all([&](const reference::Hit& hit) { return hit.t <= camera.nearT; }))
        return "everything is nearer than the camera's near";
    return std::nullopt;
}

std::string emptyReason(const Picture& picture, const Scene& scene, const PackedScene& packed,
                        const Request& request) {
    if (scene.objects.empty()) return "the scene has no objects";
    const bool finiteGeometry = packed.environment.root != shared::kNone;
    if (!finiteGeometry && packed.planes.empty())
        return "nothing is left of its objects (see the warnings above)";
    if (packed.planes.empty()) {
        const Placement p = placeBounds(scene.camera, packed);
        if (p.depthMax <= 0) return "everything lies behind the camera; check its eye and target";
        if (p.distanceMin > scene.camera.farT) return "everything is farther away than the camera's far";
        if (p.distanceMax < scene.camera.nearT) return "everything is nearer than the camera's near";
    }
    if (const auto clipped =
            clippedReason(scene.camera, Scout(picture, scene, packed, request).unboundedHits()))
        return *clipped;
    if (picture.region.width() < request.width || picture.region.height() < request.height) {
        return "there is nothing else in this --crop";
    }
    return "the camera looks past the objects; glint info tells where they are";
}

bool isDark(const Light& light) {
    return std::visit([](const auto& l) { return l.intensity == Color(0); }, light);
}

bool isBlack(const Material& material) {
    return material.ambient == Color(0) && material.diffuse == Color(0) && material.specular == Color(0) &&
           material.mirror == Color(0);
}

// The object that surrounds the camera, if it is all that the rays see, from behind, and no light of the
// scene gets in.
std::optional<uint32_t> darkObjectAround(const Scout& scout, const std::vector<reference::PixelRecord>& paths,
                                         const Scene& scene) {
    if (paths.size() < scout.rays()) return std::nullopt;
    const uint32_t object = paths.front().surface->object;
    for (const reference::PixelRecord& record : paths) {
        const reference::Surface& surface = *record.surface;
        const bool behind = glm::dot(surface.geometricNormal, record.path.front().ray.direction) > 0;
        if (!behind || surface.object != object) return std::nullopt;
        const Material& material = scene.materials[surface.material];
        if (material.mirror != Color(0)) return std::nullopt;
        // Light adds to the ambient part, or there is none.
        const Color ambient = material.ambient * scene.ambient;
        if (glm::any(glm::greaterThan(record.color, 1.0001 * ambient))) return std::nullopt;
    }
    return object;
}

std::string insideReason(const Scene& scene, uint32_t object) {
    return "the camera is inside " + scene.objects[object].name + ", and no light is in there with it";
}

// Why the surfaces that the rays meet are black although the scene has light.
std::string unlitReason(const std::vector<reference::PixelRecord>& paths, const Scene& scene) {
    size_t blackMaterials = 0, shaded = 0;
    for (const reference::PixelRecord& record : paths) {
        blackMaterials += isBlack(scene.materials[record.surface->material]);
        const auto& occluded = record.path.front().occluded;
        shaded += std::find(occluded.begin(), occluded.end(), 1) != occluded.end();
    }
    if (!paths.empty() && blackMaterials == paths.size()) return "the materials of what is seen are black";
    if (!paths.empty() && shaded == 0) return "all lights are behind the surfaces that are seen";
    if (!paths.empty() && shaded == paths.size()) return "all that is seen lies in shadow";
    return "no light reaches what is seen, or its materials are black";
}

std::string blackReason(const Picture& picture, const Scene& scene, const PackedScene& packed,
                        const Request& request) {
    const bool noAmbient = scene.ambient == Color(0);
    const bool noLight = std::all_of(scene.lights.begin(), scene.lights.end(), isDark);
    if (scene.lights.empty() && noAmbient) return "the scene has neither lights nor ambient light";
    if (noLight && noAmbient) return "all its lights have the intensity 0, and there is no ambient light";
    const Scout scout(picture, scene, packed, request);
    const auto paths = scout.paths();
    if (const auto object = darkObjectAround(scout, paths, scene)) return insideReason(scene, *object);
    return unlitReason(paths, scene);
}

}  // namespace

std::optional<std::string> pictureAdvice(const Picture& picture, const Scene& scene,
                                         const PackedScene& packed, const Request& request) {
    if (!picture.complete) return std::nullopt;
    bool anyHit = false, allHit = true, anyWhole = false, anyColor = false, anyRimColor = false;
    for (size_t i = 0; i < picture.color.pixels.size(); i += 4) {
        const float* c = &picture.color.pixels[i];
        if (c[3] <= 0) allHit = false;
        if (c[3] <= 0) continue;
        anyHit = true;
        const bool colored = !(c[0] == 0 && c[1] == 0 && c[2] == 0);
        // At the rim of an object some samples show the background, which says nothing about the object.
        (c[3] >= 1 ? anyColor : anyRimColor) |= colored;
        anyWhole |= c[3] >= 1;
    }
    if (!anyHit) return "the picture shows background only: " + emptyReason(picture, scene, packed, request);
    if (!(anyWhole ? anyColor : anyRimColor))
        return "everything in the picture is black: " + blackReason(picture, scene, packed, request);
    if (allHit) {
        const Scout scout(picture, scene, packed, request);
        if (const auto object = darkObjectAround(scout, scout.paths(), scene))
            return insideReason(scene, *object);
    }
    return std::nullopt;
}

}  // namespace glint::app
