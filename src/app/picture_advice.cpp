#include "app/picture_advice.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

#include "app/common.h"
#include "core/quantize.h"
#include "pack/request_environment.h"
#include "reference/tracer.h"
#include "scene/cameras.h"

namespace glint::app {

namespace {

// True if the box around all finite geometry lies behind the plane through the eye that is parallel to the
// image plane.
bool liesBehind(const Camera& camera, const PackedScene& packed) {
    const glm::dvec3 lo = packed.origin + glm::dvec3(packed.boundsLo),
                     hi = packed.origin + glm::dvec3(packed.boundsHi), w = cameraFrame(camera).w;
    const glm::dvec3 nearest = glm::mix(lo, hi, glm::lessThan(w, glm::dvec3(0)));
    return glm::dot(nearest - camera.eye, w) >= 0;
}

// Camera rays spread over the picture, followed by the reference.
class Scout {
  public:
    Scout(const Picture& picture, const Scene& scene, const PackedScene& packed, const Request& request)
        : tracer_(packed, request) {
        constexpr int kSide = 16;
        const auto camera = packCamera(scene.camera, request.width, request.height, packed.origin);
        const Region& r = picture.region;
        for (int i = 0; i < kSide * kSide; ++i)
            rays_.push_back(tracer_.cameraRay(camera, r.x0 + (i % kSide + 0.5) * r.width() / kSide,
                                              r.y0 + (i / kSide + 0.5) * r.height() / kSide));
        for (const reference::Ray& ray : rays_) {
            paths_.push_back(tracer_.trace(ray, {}, true));
            if (!paths_.back().surface) paths_.pop_back();
        }
    }
    // Distances of the closest hits without the camera's near and far.
    std::vector<double> unboundedHits() const {
        std::vector<double> hits;
        for (reference::Ray ray : rays_) {
            ray.tMin = 0;
            ray.tMax = std::numeric_limits<double>::infinity();
            if (const auto hit = tracer_.closest(ray)) hits.push_back(hit->t);
        }
        return hits;
    }
    // The paths of rays that hit a surface.
    const std::vector<reference::PixelRecord>& paths() const { return paths_; }
    bool allHit() const { return paths_.size() == rays_.size(); }
    // True if the materials of all first surfaces pass `test`, and there are any.
    template <typename Test>
    bool all(const Scene& scene, const Test& test) const {
        return !paths_.empty() && std::all_of(paths_.begin(), paths_.end(), [&](const auto& path) {
            return test(scene.materials[path.surface->material]);
        });
    }

  private:
    reference::Tracer tracer_;
    std::vector<reference::Ray> rays_;
    std::vector<reference::PixelRecord> paths_;
};

std::string emptyReason(const Picture& picture, const Scene& scene, const PackedScene& packed,
                        const Request& request) {
    if (scene.objects.empty()) return "the scene has no objects";
    if (packed.planes.empty()) {
        if (packed.environment.root == shared::kNone)
            return "nothing is left of its objects (see the warnings above)";
        if (liesBehind(scene.camera, packed))
            return "everything lies behind the camera; check its eye and target";
    }
    const std::vector<double> hits = Scout(picture, scene, packed, request).unboundedHits();
    if (!hits.empty() && *std::min_element(hits.begin(), hits.end()) > scene.camera.farT)
        return "everything is farther away than the camera's far";
    if (!hits.empty() && *std::max_element(hits.begin(), hits.end()) <= scene.camera.nearT)
        return "everything is nearer than the camera's near";
    if (picture.region.width() < request.width || picture.region.height() < request.height)
        return "there is nothing else in this --crop";
    return "the camera looks past the objects; glint info tells where they are";
}

bool isDark(const Light& light) {
    return std::visit([](const auto& l) { return l.intensity == Color(0); }, light);
}

bool reflects(const Material& material) {
    return material.mirror != Color(0) || material.transmission != Color(0);
}

bool isBlack(const Material& material) {
    return material.ambient == Color(0) && material.diffuse == Color(0) && material.specular == Color(0);
}

// The object that surrounds the camera, if all rays hit it from inside and no light of the scene reaches it.
std::optional<std::string> darkObjectAround(const Scout& scout, const Scene& scene) {
    if (!scout.allHit()) return std::nullopt;
    const uint32_t object = scout.paths().front().surface->object;
    for (const reference::PixelRecord& record : scout.paths()) {
        const reference::Surface& surface = *record.surface;
        const bool behind = glm::dot(surface.geometricNormal, record.path.front().ray.direction) > 0;
        const Material& material = scene.materials[surface.material];
        if (!behind || surface.object != object || material.mirror != Color(0)) return std::nullopt;
        // Lights add to the ambient part.
        if (glm::any(glm::greaterThan(record.color, 1.0001 * material.ambient * scene.ambient)))
            return std::nullopt;
    }
    return "the camera is inside " + scene.objects[object].name + ", which blocks every light";
}

std::string blackReason(const Picture& picture, const Scene& scene, const PackedScene& packed,
                        const Request& request) {
    const bool noAmbient = scene.ambient == Color(0);
    const bool noLight = std::all_of(scene.lights.begin(), scene.lights.end(), isDark);
    if (scene.lights.empty() && noAmbient) return "the scene has neither lights nor ambient light";
    if (noLight && noAmbient) return "all its lights have the intensity 0, and there is no ambient light";
    const Scout scout(picture, scene, packed, request);
    if (const auto inside = darkObjectAround(scout, scene)) return *inside;
    if (scout.all(scene, isBlack)) {
        if (!scout.all(scene, reflects)) return "the materials of what is seen are black";
        const uint32_t depth = depthOf(packed, request);
        return "what is seen shows only reflections and refractions, and " +
               (depth < 5 ? "maxDepth is " + std::to_string(depth) + "; use --max-depth 5"
                          : std::string("they are black"));
    }
    const auto& paths = scout.paths();
    const auto shaded = std::count_if(paths.begin(), paths.end(), [](const reference::PixelRecord& record) {
        const auto& occluded = record.path.front().occluded;
        return std::find(occluded.begin(), occluded.end(), 1) != occluded.end();
    });
    if (!paths.empty() && shaded == 0) return "all lights are behind the surfaces that are seen";
    if (!paths.empty() && shaded == static_cast<ptrdiff_t>(paths.size()))
        return "all that is seen lies in shadow";
    return "no light reaches what is seen, or its materials are black";
}

// Contents of the image. Rims of objects, where some samples show the background, count only if no pixel
// shows an object alone.
struct Contents {
    bool hits = false, misses = false;
    float brightest = 0, darkest = std::numeric_limits<float>::infinity();  // greatest channel of a pixel
};

Contents contentsOf(const Picture& picture) {
    const std::vector<float>& pixels = picture.color.pixels;
    Contents found;
    bool whole = false;
    for (size_t i = 3; i < pixels.size(); i += 4) whole = whole || pixels[i] >= 1;
    for (size_t i = 0; i < pixels.size(); i += 4) {
        const float* c = &pixels[i];
        (c[3] > 0 ? found.hits : found.misses) = true;
        if (c[3] <= 0 || (whole && c[3] < 1)) continue;
        const float value = std::max({c[0], c[1], c[2]});
        found.brightest = std::max(found.brightest, value);
        found.darkest = std::min(found.darkest, value);
    }
    return found;
}

// The exposure that makes `value` about 1, as advice.
std::string exposureAdvice(float value) {
    return format("; the brightest value is %.3g: use --exposure %d, or a format with floats such as .exr",
                  static_cast<double>(value), -static_cast<int>(std::ceil(std::log2(value))));
}

}  // namespace

std::optional<std::string> pictureAdvice(const Picture& picture, const Scene& scene,
                                         const PackedScene& packed, const Request& request, float scale) {
    if (!picture.complete) return std::nullopt;
    const Contents found = contentsOf(picture);
    if (!found.hits)
        return "the image shows only background: " + emptyReason(picture, scene, packed, request);
    if (found.brightest == 0)
        return "everything in the image is black: " + blackReason(picture, scene, packed, request);
    if (scale > 0 && srgbByte(found.brightest * scale) == 0)
        return "everything in the image is too dark for 8 bits" + exposureAdvice(found.brightest);
    if (scale > 0 && found.darkest * scale >= 1 && found.brightest * scale > 1)
        return "everything in the image is too bright for 8 bits" + exposureAdvice(found.brightest);
    if (found.misses) return std::nullopt;
    return darkObjectAround(Scout(picture, scene, packed, request), scene);
}

}  // namespace glint::app
