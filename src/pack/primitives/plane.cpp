#include "pack/primitives.h"

namespace glint {
namespace {

// Without end, so in no tree: packPlanes (pack_scene.cpp) writes them.
class PlanePacker final : public KindPacker {
  public:
    bool packs(const Shape& shape) const override { return std::holds_alternative<PlaneShape>(shape); }
    PrimitiveStatus statusOf(const Object&, uint32_t, const Frame&) const override {
        return PrimitiveStatus::Absent;
    }
    void extend(const Object&, uint32_t, uint32_t, Extent&) const override {}
    Box box(const Object&, uint32_t, const Frame&) const override { return {}; }
    void write(const Packing&, Primitives::Source, uint32_t, FurtherRows&) const override {}
    double windings(const PackedScene& scene, uint32_t index, const glm::dvec3& point) const override {
        const shared::Plane& plane = scene.planes[index];
        return glm::dot(glm::dvec3(plane.normal), point - glm::dvec3(plane.point)) < 0 ? 1 : 0;
    }
};

}  // namespace

const KindPacker& packerOfPlane() {
    static const PlanePacker packer;
    return packer;
}

}  // namespace glint
