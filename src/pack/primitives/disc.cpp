#include <cmath>

#include "core/vectors.h"
#include "pack/primitives.h"

namespace glint {

shared::Disc roundDisc(const DiscShape& disc, const Frame& frame) {
    shared::Disc out;
    out.center = glm::vec3(disc.center - frame.origin);
    out.normal = glm::vec3(unitVector(disc.normal).value());
    out.radius = static_cast<float>(disc.radius);
    return out;
}

glm::dvec3 discExtent(const glm::dvec3& normal, double radius) {
    // The greatest e.x of unit vectors x perpendicular to n is the length of e's part in the plane, the sine
    // of the angle to n: as a length of the other two components, since 1 - n_i^2 would cancel.
    const glm::dvec3 n = unitVector(normal).value();
    return radius * glm::dvec3(std::hypot(n.y, n.z), std::hypot(n.z, n.x), std::hypot(n.x, n.y));
}

Box discBox(const shared::Disc& disc) {
    const glm::dvec3 center(disc.center);
    const glm::dvec3 extent = discExtent(glm::dvec3(disc.normal), disc.radius);
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
        if (extent[axis] == 0) {
            box.lo[axis] = box.hi[axis] = disc.center[axis];
        } else {
            // Eight roundings in double of quantities below |centre| + radius.
            const double margin = 0x1p-50 * (std::abs(center[axis]) + disc.radius);
            setRounded(box, axis, center[axis] - extent[axis] - margin, center[axis] + extent[axis] + margin);
        }
    }
    return box;
}

namespace {

// Encloses nothing.
class DiscPacker final : public RowPacker<shared::Disc, &PackedScene::discs> {
  public:
    bool packs(const Shape& shape) const override { return std::holds_alternative<DiscShape>(shape); }
    void extend(const Object& object, uint32_t, uint32_t, Extent& extent) const override {
        const auto& disc = std::get<DiscShape>(object.shape);
        const glm::dvec3 reach = discExtent(disc.normal, disc.radius);
        extent.include(disc.center - reach);
        extent.include(disc.center + reach);
    }
    Box box(const Object& object, uint32_t, const Frame& frame) const override {
        return discBox(rounded(object, frame));
    }
    void balls(const PackedScene& scene, uint32_t index, const VisitBall& visit) const override {
        visit(scene.discs[index].center, scene.discs[index].radius);
    }

  private:
    shared::Disc rounded(const Object& object, const Frame& frame) const override {
        return roundDisc(std::get<DiscShape>(object.shape), frame);
    }
};

}  // namespace

const KindPacker& packerOfDisc() {
    static const DiscPacker packer;
    return packer;
}

}  // namespace glint
