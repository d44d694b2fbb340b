#include "app/picture_advice.h"

#include <algorithm>
#include <array>
#include <limits>
#include <variant>

#include "scene/camera_frame.h"

namespace glint::app {

namespace {

// Where the box around all finite geometry lies as the camera sees it.
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

std::string emptyReason(const Picture& picture, const Scene& scene, const PackedScene& packed) {
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
    if (picture.region.width() < scene.image.width || picture.region.height() < scene.image.height) {
        return "there is nothing else in this --crop";
    }
    return "the camera looks past the objects; glint info tells where they are";
}

bool isDark(const Light& light) {
    return std::visit([](const auto& l) { return l.intensity == Color(0); }, light);
}

std::string blackReason(const Scene& scene) {
    const bool noAmbient = scene.ambient == Color(0);
    const bool noLight = std::all_of(scene.lights.begin(), scene.lights.end(), isDark);
    if (scene.lights.empty() && noAmbient) return "the scene has neither lights nor ambient light";
    if (noLight && noAmbient) return "all its lights have the intensity 0, and there is no ambient light";
    return "no light reaches what is seen, or its materials are black";
}

}  // namespace

std::optional<std::string> pictureAdvice(const Picture& picture, const Scene& scene,
                                         const PackedScene& packed) {
    if (!picture.complete) return std::nullopt;
    bool anyHit = false, anyColor = false;
    for (size_t i = 0; i < picture.color.pixels.size(); i += 4) {
        const float* c = &picture.color.pixels[i];
        if (c[3] <= 0) continue;
        anyHit = true;
        // At the rim of an object some samples show the background, which says nothing about the object.
        if (c[3] >= 1 && !(c[0] == 0 && c[1] == 0 && c[2] == 0)) anyColor = true;
    }
    if (!anyHit) return "the picture shows background only: " + emptyReason(picture, scene, packed);
    if (!anyColor) return "everything in the picture is black: " + blackReason(scene);
    return std::nullopt;
}

}  // namespace glint::app
