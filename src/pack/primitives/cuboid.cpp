// Boxes (GLINT_CUBOID_ROWS). An axis-aligned one has its corners in the scene's own coordinates, so that
// faces that boxes share lie in the same plane, to the last bit; one with a transform is measured from its
// middle, or from its point nearest the eye.
#include <algorithm>

#include "core/vectors.h"
#include "pack/primitives.h"
#include "scene/transform.h"

namespace glint {
namespace {

using glm::dmat3;
using glm::dvec3;

// In the world: the middle and, as columns, half the edges.
struct Edges {
    dvec3 middle;
    dmat3 half;
};

Edges edgesOf(const Object& object) {
    const auto& box = std::get<BoxShape>(object.shape);
    const Affine placed = object.transform.value_or(Affine{});
    const dvec3 half = 0.5 * box.max - 0.5 * box.min;
    return {apply(placed, box.min + half),
            {placed.linear[0] * half.x, placed.linear[1] * half.y, placed.linear[2] * half.z}};
}

dvec3 reachOf(const dmat3& half) {
    return glm::abs(half[0]) + glm::abs(half[1]) + glm::abs(half[2]);
}

// Nearest the eye, in distances from the middle along the rows, if that is nearer than half of the size: hits
// err by 2^-24 of the way to what the box is measured from.
dvec3 anchorOf(const dvec3& eye, const dvec3& half) {
    const dvec3 nearest = glm::clamp(eye, -half, half);
    const double greatest = std::max({half.x, half.y, half.z});
    return glm::distance(eye, nearest) < 0.5 * greatest ? nearest : dvec3(0);
}

class CuboidPacker final : public RowPacker<shared::Cuboid, &PackedScene::cuboids> {
  public:
    bool packs(const Shape& shape) const override { return std::holds_alternative<BoxShape>(shape); }
    // Without volume after rounding, far from the scene's origin, it has a pair of faces that are one.
    PrimitiveStatus statusOf(const Object& object, uint32_t, const Frame& frame) const override {
        const shared::Cuboid c = rounded(object, frame);
        if (!isFinite(c.point) || !isFinite(c.lo) || !isFinite(c.hi)) return PrimitiveStatus::NotFinite;
        return glm::all(glm::lessThan(c.lo, c.hi)) ? PrimitiveStatus::Kept : PrimitiveStatus::NoArea;
    }
    void extend(const Object& object, uint32_t, uint32_t, Extent& extent) const override {
        const Edges edges = edgesOf(object);
        extent.include(edges.middle - reachOf(edges.half));
        extent.include(edges.middle + reachOf(edges.half));
    }
    // The device's slabs are those of the tree's boxes where there is no transform. With one, rounding moves
    // y by 2^-24 of |T| |x - point|, four times for good measure, and that comes back through |T^-1|.
    Box box(const Object& object, uint32_t, const Frame& frame) const override {
        const shared::Cuboid c = rounded(object, frame);
        if (!object.transform) return {c.lo, c.hi};
        const dmat3 rows = toLocal(c), back = inverse({rows, dvec3(0)}).linear;
        const dvec3 size = 0.5 * dvec3(c.hi) - 0.5 * dvec3(c.lo), away = back * (dvec3(c.lo) + size);
        const dvec3 reach = magnitudes(back) * size;
        const dvec3 moved = magnitudes(rows) * (glm::abs(away) + reach);
        const dvec3 margin = 0x1p-20 * (magnitudes(back) * moved);
        const dvec3 middle = dvec3(c.point) + away;
        Box box;
        for (int axis = 0; axis < 3; ++axis)
            setRounded(box, axis, middle[axis] - reach[axis] - margin[axis],
                       middle[axis] + reach[axis] + margin[axis]);
        return box;
    }
    void balls(const PackedScene& scene, uint32_t index, const VisitBall& visit) const override {
        const shared::Cuboid& c = scene.cuboids[index];
        visitCorners(c, inverse({toLocal(c), dvec3(0)}).linear, visit);
    }
    double windings(const PackedScene& scene, uint32_t index, const dvec3& point) const override {
        const shared::Cuboid& c = scene.cuboids[index];
        const dvec3 y = toLocal(c) * (point - dvec3(c.point));
        return glm::all(glm::greaterThan(y, dvec3(c.lo))) && glm::all(glm::lessThan(y, dvec3(c.hi))) ? 1 : 0;
    }

  private:
    shared::Cuboid rounded(const Object& object, const Frame& frame) const override {
        shared::Cuboid out;
        if (!object.transform) {
            const auto& box = std::get<BoxShape>(object.shape);
            out.toLocal0.x = out.toLocal1.y = out.toLocal2.z = 1;
            out.lo = glm::vec3(box.min - frame.origin);
            out.hi = glm::vec3(box.max - frame.origin);
            return out;
        }
        const Edges edges = edgesOf(object);
        // Row i of the inverse is across the other two edges; of length 1 it measures the distance from the
        // middle.
        dmat3 rows = glm::transpose(inverse({edges.half, dvec3(0)}).linear);
        dvec3 half;
        for (int axis = 0; axis < 3; ++axis) {
            const double length = glm::length(rows[axis]);
            half[axis] = 1 / length;
            rows[axis] /= length;
        }
        const dmat3 local = glm::transpose(rows);
        dvec3 from = anchorOf(local * (frame.eye - edges.middle), half);
        const dvec3 point = edges.middle + inverse({local, dvec3(0)}).linear * from;
        out.point = glm::vec3(point - frame.origin);
        // The rounded point is not that one.
        if (from != dvec3(0)) from = local * (dvec3(out.point) + frame.origin - edges.middle);
        out.toLocal0 = glm::vec3(rows[0]);
        out.toLocal1 = glm::vec3(rows[1]);
        out.toLocal2 = glm::vec3(rows[2]);
        out.lo = glm::vec3(-half - from);
        out.hi = glm::vec3(half - from);
        return out;
    }
};

}  // namespace

const KindPacker& packerOfCuboid() {
    static const CuboidPacker packer;
    return packer;
}

}  // namespace glint
