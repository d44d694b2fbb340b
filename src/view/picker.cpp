#include "view/picker.h"

#include <cstdio>

#include "reference/tracer.h"
#include "trace/ray_batch.h"

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

std::string bounceText(const Scene& scene, const reference::Bounce& bounce, size_t index) {
    const std::string ray = index == 0 ? "eye" : "mirror " + std::to_string(index);
    if (!bounce.hit || !bounce.surface) return ray + ": nothing (background)";
    char numbers[96];
    std::snprintf(numbers, sizeof(numbers), " face %u, t = %.6g", bounce.surface->primitive, bounce.hit->t);
    return ray + ": " + objectName(scene, bounce.surface->object) + numbers + ", " +
           materialName(scene, bounce.surface->material) + shadowText(bounce.occluded);
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
    for (size_t i = 0; i < record.path.size(); ++i) pick.path.push_back(bounceText(scene, record.path[i], i));
    return pick;
}

std::string pickCsv(const Pick& pick) {
    return kHitCsvHeading + hitCsv(hitOf(pick.data), kDeviceDigits);
}

}  // namespace glint::view
