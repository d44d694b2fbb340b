#include "view/picker.h"

#include <cstdio>

#include "reference/tracer.h"

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
    const reference::Tracer tracer(session.lit());
    const reference::Ray ray = tracer.cameraRay(session.packedCamera(), x + 0.5, y + 0.5);
    const reference::PixelRecord record = tracer.trace(ray, {}, true);
    for (size_t i = 0; i < record.path.size(); ++i) pick.path.push_back(bounceText(scene, record.path[i], i));
    return pick;
}

std::string pickCsv(const Pick& pick) {
    std::string text = "hit,t,u,v,object,primitive,px,py,pz,nx,ny,nz\n";
    if (!pick.hit()) return text + "0,,,,,,,,,,,\n";
    const PixelData& d = pick.data;
    const glm::dvec3 n(d.geometricNormal);
    char line[512];
    std::snprintf(line, sizeof(line), "1,%.9g,%.9g,%.9g,%u,%u,%.9g,%.9g,%.9g,%.9g,%.9g,%.9g\n", d.depth,
                  static_cast<double>(d.u), static_cast<double>(d.v), d.object, d.primitive, d.position.x,
                  d.position.y, d.position.z, n.x, n.y, n.z);
    return text + line;
}

}  // namespace glint::view
