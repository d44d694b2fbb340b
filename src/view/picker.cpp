#include "view/picker.h"

#include <cstdio>

#include "reference/tracer.h"
#include "trace/ray_batch.h"
#include "view/tone.h"

namespace glint::view {

namespace {

std::string objectName(const Scene& scene, uint32_t object) {
    return object < scene.objects.size() ? scene.objects[object].name : "?";
}

std::string materialName(const Scene& scene, uint32_t material) {
    if (material >= scene.materials.size()) return "?";
    const std::string& name = scene.materials[material].name;
    return name.empty() ? "(no name)" : name;
}

std::string shadowText(const std::vector<uint8_t>& occluded) {
    std::string text;
    for (size_t i = 0; i < occluded.size(); ++i) {
        if (occluded[i] != 0) text += (text.empty() ? "" : " ") + std::to_string(i);
    }
    return text.empty() ? "" : ", in shadow of light " + text;
}

const char* nameOfRay(reference::RayClass kind) {
    if (kind == reference::RayClass::Mirrored) return "reflected";
    return kind == reference::RayClass::Refracted ? "transmitted" : "eye";
}

std::string rayText(const Scene& scene, const reference::Bounce& bounce) {
    const std::string ray = nameOfRay(bounce.kind);
    if (!bounce.hit || !bounce.surface) return ray + ": nothing (background)";
    char numbers[96];
    std::snprintf(numbers, sizeof(numbers), " face %u, t = %.6g", bounce.surface->primitive, bounce.hit->t);
    return ray + ": " + objectName(scene, bounce.surface->object) + numbers + ", " +
           materialName(scene, bounce.surface->material) + shadowText(bounce.occluded);
}

std::vector<PickRay> raysOf(const ViewScene& scene, const reference::PixelRecord& record) {
    const double whole = luminance(record.color);
    const double far = 2 * boundsOf(scene).radius;  // how long a ray is drawn that hits nothing
    std::vector<PickRay> rays;
    for (const reference::Bounce& bounce : record.path) {
        PickRay ray;
        ray.kind = bounce.kind;
        ray.depth = bounce.depth;
        ray.hit = bounce.hit.has_value();
        ray.from = scene.packed.origin + bounce.ray.origin;
        ray.to = ray.hit ? scene.packed.origin + bounce.surface->position
                         : ray.from + far * glm::normalize(bounce.ray.direction);
        ray.share = whole > 0 ? luminance(bounce.light) / whole : 0;
        ray.text = rayText(scene.scene, bounce);
        rays.push_back(ray);
    }
    return rays;
}

}  // namespace

Pick pickPixel(Session& session, int x, int y) {
    const Scene& scene = session.scene().scene;
    Pick pick;
    pick.x = x;
    pick.y = y;
    pick.width = session.width();
    pick.height = session.height();
    pick.data = session.pixel(x, y);
    if (pick.hit()) {
        pick.object = objectName(scene, pick.data.object);
        pick.material = materialName(scene, pick.data.material);
    }
    const reference::Tracer tracer(session.scene().packed, session.tracing());
    const reference::Ray ray = tracer.cameraRay(session.packedCamera(), x + 0.5, y + 0.5);
    const reference::PixelRecord record = tracer.trace(ray, {}, true);
    pick.rays = raysOf(session.scene(), record);
    return pick;
}

std::string pickCsv(const Pick& pick) {
    return kHitCsvHeading + hitCsv(hitOf(pick.data), kDeviceDigits);
}

std::string pickTree(const Pick& pick) {
    std::string lines;
    for (const PickRay& ray : pick.rays) {
        char share[16];
        std::snprintf(share, sizeof(share), "%.1f %% ", 100 * ray.share);
        lines += std::string(2 * ray.depth, ' ') + share + ray.text + '\n';
    }
    return lines;
}

}  // namespace glint::view
