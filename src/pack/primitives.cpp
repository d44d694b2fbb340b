#include "pack/primitives.h"

#include <cmath>
#include <limits>
#include <stdexcept>

#include "core/error.h"
#include "scene/placement.h"

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
        // The highest bit of an id is kDielectricRank, and all bits together are kNone.
        checkLimit("primitives", id, shared::kDielectricRank - 1);
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

void setRounded(Box& box, int axis, double lo, double hi) {
    constexpr float kInf = std::numeric_limits<float>::infinity();
    box.lo[axis] = std::nextafter(static_cast<float>(lo), -kInf);
    box.hi[axis] = std::nextafter(static_cast<float>(hi), kInf);
}

const KindPacker& packerOf(shared::PrimitiveKind kind) {
    switch (kind) {
#define GLINT_CASE(number, Kind, KINDS, kinds, one, many) \
    case shared::PrimitiveKind::Kind:                     \
        return packerOf##Kind();
        GLINT_PRIMITIVES(GLINT_CASE, GLINT_CASE)
#undef GLINT_CASE
    }
    throw std::logic_error("no such kind of primitive");
}

shared::PrimitiveKind kindOf(const Object& object) {
    if (object.transform && !takesTransform(object.shape)) return shared::PrimitiveKind::Instance;
    for (uint32_t kind = 0; kind < shared::kKindCount; ++kind)
        if (packerOf(static_cast<shared::PrimitiveKind>(kind)).packs(object.shape))
            return static_cast<shared::PrimitiveKind>(kind);
    throw std::logic_error("a shape that no kind of primitive packs");
}

}  // namespace glint
