#include "pack/primitives.h"

#include <cmath>
#include <limits>

#include "core/error.h"

namespace glint {

PrimitiveNumbers::PrimitiveNumbers(const Scene& scene) {
    uint64_t id = 0, item = 0;
    first_.reserve(scene.objects.size() + 1);
    ids_.reserve(scene.objects.size());
    for (const Object& object : scene.objects) {
        first_.push_back(static_cast<uint32_t>(item));
        ids_.push_back(static_cast<uint32_t>(id));
        const auto* mesh = std::get_if<MeshShape>(&object.shape);
        const size_t faces = mesh != nullptr ? mesh->mesh->corners.size() : 1;
        id += faces;
        item += object.transform ? 1 : faces;
        checkLimit("primitives", id, shared::kNone - 1);
    }
    first_.push_back(static_cast<uint32_t>(item));
}

void checkLimit(const char* what, uint64_t count, uint64_t limit) {
    if (count <= limit) return;
    throw Error(ErrorKind::Scene, std::string(what) + ": the scene has " + std::to_string(count) +
                                      ", the limit is " + std::to_string(limit) + "; leave some out");
}

std::optional<glm::vec3> roundPoint(const glm::dvec3& p) {
    constexpr double kLargest = std::numeric_limits<float>::max();
    // NaN compares false.
    if (!(std::abs(p.x) <= kLargest && std::abs(p.y) <= kLargest && std::abs(p.z) <= kLargest))
        return std::nullopt;
    return glm::vec3(p);
}

void setRounded(Box& box, int axis, double center, double extent, double margin) {
    constexpr float kInf = std::numeric_limits<float>::infinity();
    box.lo[axis] = std::nextafter(static_cast<float>(center - extent - margin), -kInf);
    box.hi[axis] = std::nextafter(static_cast<float>(center + extent + margin), kInf);
}

}  // namespace glint
