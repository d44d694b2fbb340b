// The media that the eye is inside of: those whose surfaces go round it by their solid angle
// (docs/reference/shading.md).
#include <cmath>
#include <numbers>

#include "reference/instance.h"
#include "reference/traverse.h"
#include "reference/truth/part.h"

namespace glint::reference::truth {
namespace {

using glm::dvec3;

// Solid angle of a triangle seen from 0, in whole spheres (A. van Oosterom, J. Strackee 1983).
double solidAngle(const dvec3& a, const dvec3& b, const dvec3& c) {
    const double x = glm::length(a), y = glm::length(b), z = glm::length(c);
    const double over = glm::dot(glm::cross(a, b), c);
    const double under = x * y * z + z * glm::dot(a, b) + x * glm::dot(b, c) + y * glm::dot(c, a);
    return std::atan2(over, under) / (2 * std::numbers::pi);
}

class MediaAround {
  public:
    MediaAround(const dvec3& eye, const Model& model)
        : eye_(eye), model_(model), turns_(model.optics.size() + 1), boxes_(turns_.size()) {}

    std::vector<uint32_t> find() {
        if (!model_.nodes->empty()) addTree(0, nullptr);
        for (const rows::Plane& plane : model_.planes) add(plane);
        std::vector<uint32_t> media;
        for (uint32_t medium = 1; medium < turns_.size(); ++medium)
            for (long i = 0; i < std::lround(turns_[medium]) && i < long{shared::kMaxMedia}; ++i)
                media.push_back(medium);
        std::stable_sort(media.begin(), media.end(),
                         [&](uint32_t a, uint32_t b) { return sizeOf(a) > sizeOf(b); });
        media.resize(std::min<size_t>(media.size(), shared::kMaxMedia));
        return media;
    }

  private:
    uint32_t mediumOf(uint32_t material) const { return model_.materials[material].medium; }
    double sizeOf(uint32_t medium) const {
        return glm::length(0.5 * boxes_[medium].hi - 0.5 * boxes_[medium].lo);
    }

    void addTree(uint32_t root, const rows::Instance* instance) {
        traverse(
            *model_.nodes, root, [](const rows::Node&, int) { return 0.0; }, [] { return 0.0; },
            [&](const Leaf& leaf, double) {
                for (uint32_t i = leaf.first; i < leaf.end; ++i) addPrimitive(leaf.kind, i, instance);
                return false;
            });
    }

    void addPrimitive(shared::PrimitiveKind kind, uint32_t i, const rows::Instance* instance) {
        switch (kind) {
            case shared::PrimitiveKind::Triangle:
                return addTriangle(i, instance);
            case shared::PrimitiveKind::Sphere:
                return add(model_.spheres[i]);
            case shared::PrimitiveKind::Polygon:
                return add(model_.polygons[i]);
            case shared::PrimitiveKind::Quadric:
                return add(model_.quadrics[i]);
            case shared::PrimitiveKind::Cuboid:
                return add(model_.cuboids[i]);
            case shared::PrimitiveKind::Instance:
                return addTree(model_.instances[i].root, &model_.instances[i]);
            case shared::PrimitiveKind::Disc:   // goes round nothing
            case shared::PrimitiveKind::Plane:  // in no tree
                return;
        }
    }

    void addTriangle(uint32_t i, const rows::Instance* instance) {
        const rows::Triangle& t = model_.triangles[i];
        uint32_t material = model_.triangleSurfaces[i].material;
        dvec3 v[3] = {t.v0, t.v1, t.v2};
        bool mirrored = false;
        if (instance != nullptr) {
            if (instance->material != shared::kNone) material = instance->material;
            const InstanceFrame frame(*instance);
            for (dvec3& p : v) p = frame.pointInWorld(p);
            mirrored = instance->mirrored != 0;
        }
        const uint32_t medium = mediumOf(material);
        if (medium == 0) return;
        for (const dvec3& p : v) boxes_[medium].include(p);
        const double turns = solidAngle(v[0] - eye_, v[1] - eye_, v[2] - eye_);
        turns_[medium] += mirrored ? -turns : turns;
    }

    template <class Solid>
    void add(const Solid& solid) {
        if (const uint32_t medium = mediumOf(solid.material))
            turns_[medium] += turnsOf(solid, boxes_[medium]);
    }

    // How often the surface goes round the eye. The medium's box grows by the surface's.
    double turnsOf(const rows::Plane& plane, Bounds& box) const {
        box.include(dvec3(std::numeric_limits<double>::max()));
        box.include(dvec3(-std::numeric_limits<double>::max()));
        return glm::dot(plane.normal, eye_ - plane.point) < 0 ? 1 : 0;
    }
    double turnsOf(const rows::Sphere& s, Bounds& box) const {
        const dvec3 center = s.point - s.radius * s.anchorNormal;
        box.include(center - s.radius);
        box.include(center + s.radius);
        return glm::distance(eye_, center) < s.radius ? 1 : 0;
    }
    double turnsOf(const rows::Polygon& p, Bounds& box) const {
        const rows::PolygonVertex* v = &model_.polygonVertices[p.firstVertex];
        double turns = 0;
        for (uint32_t i = 0; i < p.trips * shared::kPolygonEdgesPerTrip; ++i) {
            box.include(v[i].position);
            if (i > 0)
                turns += solidAngle(v[0].position - eye_, v[i].position - eye_, v[i + 1].position - eye_);
        }
        return turns;
    }
    double turnsOf(const rows::Quadric& q, Bounds& box) const {
        const dvec3 y = eyeIn(q, box);
        for (int i = 0; i < 3; ++i)
            if (y[i] < q.lo[i] || y[i] > q.hi[i]) return 0;
        const double value = glm::dot(y, symmetric(q.squares, q.products) * y + 2.0 * q.linear) + q.constant;
        return value < 0 ? 1 : 0;
    }
    double turnsOf(const rows::Cuboid& c, Bounds& box) const {
        const dvec3 y = eyeIn(c, box);
        return glm::all(glm::lessThan(c.lo, y)) && glm::all(glm::lessThan(y, c.hi)) ? 1 : 0;
    }

    // The eye in the solid's own coordinates.
    template <class Solid>
    dvec3 eyeIn(const Solid& solid, Bounds& box) const {
        const glm::dmat3 toLocal = glm::transpose(glm::dmat3(solid.toLocal0, solid.toLocal1, solid.toLocal2));
        const glm::dmat3 back = glm::inverse(toLocal);
        Bounds local;
        local.include(solid.lo);
        local.include(solid.hi);
        for (int i = 0; i < 8; ++i) box.include(solid.point + back * local.corner(i));
        return toLocal * (eye_ - solid.point);
    }

    dvec3 eye_;
    const Model& model_;
    std::vector<double> turns_;
    std::vector<Bounds> boxes_;
};

}  // namespace

void addMediaAtEye(const dvec3& eye, Model& model) {
    if (model.optics.empty()) return;
    const std::vector<uint32_t> media = MediaAround(eye, model).find();
    rows::Environment& e = model.environment;
    uint32_t* const places[] = {&e.eyeMedium0, &e.eyeMedium1, &e.eyeMedium2, &e.eyeMedium3};
    for (size_t i = 0; i < shared::kMaxMedia; ++i) *places[i] = i < media.size() ? media[i] : 0;
}

}  // namespace glint::reference::truth
