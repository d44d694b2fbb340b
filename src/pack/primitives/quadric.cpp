#include "pack/kind_packer.h"
#include "pack/quadrics.h"

namespace glint {
namespace {

class QuadricPacker final : public KindPacker {
  public:
    bool packs(const Shape& shape) const override {
        return std::holds_alternative<QuadricShape>(shape) || std::holds_alternative<EllipsoidShape>(shape) ||
               std::holds_alternative<CylinderShape>(shape) || std::holds_alternative<ConeShape>(shape) ||
               std::holds_alternative<HyperboloidShape>(shape) ||
               std::holds_alternative<ParaboloidShape>(shape);
    }
    void extend(const Object& object, uint32_t, uint32_t, Extent& extent) const override {
        const Extent own = quadricExtent(object);
        extent.include(own.lo);
        extent.include(own.hi);
    }
    Box box(const Object& object, uint32_t, const Frame& frame) const override {
        return quadricBox(object, frame, roundQuadric(object, frame));
    }
    void write(const Packing& packing, Primitives::Source source, uint32_t slot,
               FurtherRows&) const override {
        shared::Quadric& quadric = packing.packed.quadrics[slot];
        quadric = roundQuadric(packing.objectOf(source), packing.frame);
        packing.identify(source, quadric);
    }
    void balls(const PackedScene& scene, uint32_t index, const VisitBall& visit) const override {
        const shared::Quadric& q = scene.quadrics[index];
        const glm::dmat3 toWorld = glm::inverse(toLocal(q));
        for (int i = 0; i < 8; ++i) {
            const glm::dvec3 corner(i & 1 ? q.hi.x : q.lo.x, i & 2 ? q.hi.y : q.lo.y,
                                    i & 4 ? q.hi.z : q.lo.z);
            visit(glm::dvec3(q.point) + toWorld * corner, 0);
        }
    }
    // Inside if it is so of the surface and of the box that cuts it off, as of a capped one.
    double windings(const PackedScene& scene, uint32_t index, const glm::dvec3& point) const override {
        const shared::Quadric& q = scene.quadrics[index];
        const bool fromApex = (q.caps & shared::kFromApex) != 0;
        const glm::dvec3 local = toLocal(q) * (point - glm::dvec3(q.point)), s(q.squares), p(q.products);
        const glm::dvec3 y = fromApex ? local + glm::dvec3(q.linear) : local;
        const glm::dvec3 qy(s.x * y.x + p.z * y.y + p.y * y.z, p.z * y.x + s.y * y.y + p.x * y.z,
                            p.y * y.x + p.x * y.y + s.z * y.z);
        const double rest = 2 * glm::dot(glm::dvec3(q.linear), y) + static_cast<double>(q.constant);
        const double side = glm::dot(y, qy) + (fromApex ? 0 : rest);
        const bool inBox = glm::all(glm::greaterThanEqual(local, glm::dvec3(q.lo))) &&
                           glm::all(glm::lessThanEqual(local, glm::dvec3(q.hi)));
        return side < 0 && inBox ? 1 : 0;
    }

  private:
    static glm::dmat3 toLocal(const shared::Quadric& q) {
        return glm::transpose(
            glm::dmat3(glm::dvec3(q.toLocal0), glm::dvec3(q.toLocal1), glm::dvec3(q.toLocal2)));
    }
};

}  // namespace

const KindPacker& packerOfQuadric() {
    static const QuadricPacker packer;
    return packer;
}

}  // namespace glint
