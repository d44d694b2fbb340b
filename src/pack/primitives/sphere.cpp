#include <cmath>

#include "pack/primitives.h"

namespace glint {

shared::Sphere roundSphere(const SphereShape& sphere, const Frame& frame) {
    shared::Sphere out;
    out.radius = static_cast<float>(sphere.radius);
    const glm::dvec3 toEye = frame.eye - sphere.center;
    const double distance = glm::length(toEye);
    glm::dvec3 point = sphere.center;
    if (std::abs(distance - sphere.radius) < sphere.radius / 64) {
        const glm::dvec3 normal = toEye / distance;  // not 0: more than 63/64 of the radius
        point += sphere.radius * normal;
        out.anchorNormal = glm::vec3(normal);
    }
    out.point = glm::vec3(point - frame.origin);
    return out;
}

Box sphereBox(const shared::Sphere& sphere) {
    // The anchored form is the sphere about point - r n of radius r |n|: |n| is 1 but for its rounding.
    glm::dvec3 center(sphere.point);
    double radius = sphere.radius;
    const glm::dvec3 normal(sphere.anchorNormal);
    if (normal != glm::dvec3(0)) {
        center -= radius * normal;
        radius *= glm::length(normal);
    }
    Box box;
    for (int axis = 0; axis < 3; ++axis) {
        // Six roundings in double, each of at most 2^-53 times a quantity below |centre| + 3 radius.
        const double margin = 0x1p-50 * (std::abs(center[axis]) + 3 * radius);
        setRounded(box, axis, center[axis] - radius - margin, center[axis] + radius + margin);
    }
    return box;
}

namespace {

class SpherePacker final : public RowPacker<shared::Sphere, &PackedScene::spheres> {
  public:
    bool packs(const Shape& shape) const override { return std::holds_alternative<SphereShape>(shape); }
    void extend(const Object& object, uint32_t, uint32_t, Extent& extent) const override {
        const auto& sphere = std::get<SphereShape>(object.shape);
        extent.include(sphere.center - sphere.radius);
        extent.include(sphere.center + sphere.radius);
    }
    Box box(const Object& object, uint32_t, const Frame& frame) const override {
        return sphereBox(rounded(object, frame));
    }
    void balls(const PackedScene& scene, uint32_t index, const VisitBall& visit) const override {
        const shared::Sphere& sphere = scene.spheres[index];
        visit(glm::dvec3(sphere.point) - static_cast<double>(sphere.radius) * glm::dvec3(sphere.anchorNormal),
              sphere.radius);
    }
    double windings(const PackedScene& scene, uint32_t index, const glm::dvec3& point) const override {
        const shared::Sphere& sphere = scene.spheres[index];
        const glm::dvec3 offset = point - glm::dvec3(sphere.point), normal(sphere.anchorNormal);
        const double radius = sphere.radius;
        const bool anchored = sphere.anchorNormal != glm::vec3(0);
        const double side =
            glm::dot(offset, offset) + (anchored ? 2 * radius * glm::dot(normal, offset) : -radius * radius);
        return side < 0 ? 1 : 0;
    }

  private:
    shared::Sphere rounded(const Object& object, const Frame& frame) const override {
        return roundSphere(std::get<SphereShape>(object.shape), frame);
    }
};

}  // namespace

const KindPacker& packerOfSphere() {
    static const SpherePacker packer;
    return packer;
}

}  // namespace glint
