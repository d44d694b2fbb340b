// Explains images that show nothing.
#include <algorithm>
#include <cmath>
#include <limits>
#include <variant>

#include "app/render_command.h"
#include "core/format.h"
#include "core/quantize.h"
#include "pack/request_environment.h"
#include "reference/tracer.h"

namespace glint::app {

namespace {

// Camera rays spread over the image, and the paths of those that hit a surface.
struct Scouts {
    std::vector<reference::PixelRecord> paths;
    bool allHit = true;
    bool clipped = false;  // some hits are outside the camera's near and far
};

Scouts scoutsOf(const Picture& picture, const LoadedScene& loaded, const Request& request) {
    constexpr int kSide = 16;
    const reference::Tracer tracer(loaded.packed, request);
    const shared::Camera camera = cameraOf(loaded.packed, request);
    const Region& r = picture.region;
    Scouts scouts;
    for (int i = 0; i < kSide * kSide; ++i) {
        reference::Ray ray = tracer.cameraRay(camera, r.x0 + (i % kSide + 0.5) * r.width() / kSide,
                                              r.y0 + (i / kSide + 0.5) * r.height() / kSide);
        reference::PixelRecord path = tracer.trace(ray, {}, true);
        if (path.surface) {
            scouts.paths.push_back(std::move(path));
            continue;
        }
        scouts.allHit = false;
        ray.tMin = 0;
        ray.tMax = std::numeric_limits<double>::infinity();
        scouts.clipped = scouts.clipped || tracer.closest(ray);
    }
    return scouts;
}

std::string emptyReason(const Picture& picture, const LoadedScene& loaded, const Request& request) {
    if (loaded.scene.objects.empty()) return "the scene has no objects";
    if (loaded.packed.planes.empty() && loaded.packed.environment.root == shared::kNone)
        return "nothing is left of its objects (see the warnings above)";
    if (scoutsOf(picture, loaded, request).clipped)
        return "everything is nearer than the camera's near or farther away than its far";
    if (request.region.width() < request.width || request.region.height() < request.height)
        return "nothing is in this --crop; leave it out to see the whole image";
    return "the camera looks past the objects, or they are smaller than a pixel; check its eye and target "
           "(glint info prints the bounds)";
}

// The object that surrounds the camera, if all rays hit it from inside and no light of the scene reaches it.
std::optional<std::string> darkObjectAround(const Scouts& scouts, const Scene& scene) {
    if (!scouts.allHit) return std::nullopt;
    const uint32_t object = scouts.paths.front().surface->object;
    for (const reference::PixelRecord& path : scouts.paths) {
        const reference::Surface& surface = *path.surface;
        const bool inside = glm::dot(surface.geometricNormal, path.path.front().ray.direction) > 0;
        const Material& material = scene.materials[surface.material];
        if (!inside || surface.object != object || material.transmission != Color(0)) return std::nullopt;
        // Lights add to the ambient part.
        if (glm::any(glm::greaterThan(path.color, 1.0001 * material.ambient * scene.ambient)))
            return std::nullopt;
    }
    return "the camera is inside " + scene.objects[object].name + ", which blocks every light";
}

std::string blackReason(const Picture& picture, const LoadedScene& loaded, const Request& request) {
    const Scene& scene = loaded.scene;
    const auto isDark = [](const Light& light) {
        return std::visit([](const auto& l) { return l.intensity == Color(0); }, light);
    };
    if (std::all_of(scene.lights.begin(), scene.lights.end(), isDark) && scene.ambient == Color(0))
        return "the scene has neither lights nor ambient light";
    const Scouts scouts = scoutsOf(picture, loaded, request);
    if (const auto inside = darkObjectAround(scouts, scene)) return *inside;
    const auto onlyReflects = [&](const reference::PixelRecord& path) {
        const Material& m = scene.materials[path.surface->material];
        return m.ambient == Color(0) && m.diffuse == Color(0) &&
               (m.mirror != Color(0) || m.transmission != Color(0));
    };
    const uint32_t depth = depthOf(loaded.packed, request);
    if (depth < 5 && !scouts.paths.empty() &&
        std::all_of(scouts.paths.begin(), scouts.paths.end(), onlyReflects))
        return "what is seen shows only reflections and refractions, and maxDepth is " +
               std::to_string(depth) + "; use --max-depth 5";
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

// True if the surfaces in the image have the colour of a plain background, up to rounding.
bool looksLikeBackground(const Picture& picture, const Scene& scene) {
    const std::vector<float>& pixels = picture.color.pixels;
    if (scene.environment) return false;
    for (size_t i = 0; i < pixels.size(); i += 4)
        for (int c = 0; c < 3; ++c) {
            const double background = scene.background[c];
            if (std::abs(pixels[i + static_cast<size_t>(c)] - background) > 1e-5 * background) return false;
        }
    return true;
}

// A plane through the eye is edge-on: for example a floor at y = 0 by the default camera.
std::optional<std::string> planeThroughEye(const Scene& scene, const glm::dvec3& eye) {
    for (const Object& object : scene.objects) {
        const auto* plane = std::get_if<PlaneShape>(&object.shape);
        if (plane != nullptr && !object.transform && glm::dot(plane->normal, eye - plane->point) == 0)
            return "the camera lies in the plane of " + object.name +
                   ", which is invisible from there; move the camera's eye";
    }
    return std::nullopt;
}

// The exposure that makes the brightest value about 1.
std::string exposureAdvice(const char* how, float brightest) {
    return format(
        "everything in the image is too %s for 8 bits; the brightest value is %.3g: use --exposure %d, or a "
        "format with floats such as .exr",
        how, static_cast<double>(brightest), -static_cast<int>(std::ceil(std::log2(brightest))));
}

}  // namespace

std::optional<std::string> pictureAdvice(const Picture& picture, const LoadedScene& loaded,
                                         const Request& request, float scale) {
    if (!picture.complete) return std::nullopt;
    const Contents found = contentsOf(picture);
    if (!found.hits) return "the image shows only background: " + emptyReason(picture, loaded, request);
    if (found.brightest == 0)
        return "everything in the image is black: " + blackReason(picture, loaded, request);
    if (looksLikeBackground(picture, loaded.scene))
        return "the image shows only background: the surfaces have its colour, by what they let through, "
               "mirror or reflect; change a material or the background";
    if (scale > 0 && srgbByte(found.brightest * scale) == 0) return exposureAdvice("dark", found.brightest);
    if (scale > 0 && found.darkest * scale >= 1 && found.brightest * scale > 1)
        return exposureAdvice("bright", found.brightest);
    if (found.misses) return planeThroughEye(loaded.scene, request.camera.eye);
    return darkObjectAround(scoutsOf(picture, loaded, request), loaded.scene);
}

}  // namespace glint::app
