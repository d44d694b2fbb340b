// The media that the eye is inside of: those whose surfaces go round it by their solid angle
// (docs/reference/shading.md).
#include <cmath>
#include <numbers>

#include "reference/instance.h"
#include "reference/truth/part.h"
#include "reference/truth/shading.h"

namespace glint::reference::truth {
namespace {

using glm::dvec3;

// Solid angle of a triangle seen from 0, in whole spheres (A. van Oosterom, J. Strackee 1983).
double turnsOf(const dvec3& a, const dvec3& b, const dvec3& c) {
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
        for (const rows::Plane& p : model_.planes) {
            const uint32_t medium = mediumOf(p.material);
            if (medium == 0) continue;
            turns_[medium] += glm::dot(p.normal, eye_ - p.point) < 0 ? 1 : 0;
            boxes_[medium].include(dvec3(std::numeric_limits<double>::max()));
            boxes_[medium].include(dvec3(-std::numeric_limits<double>::max()));
        }
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
        std::vector<uint32_t> waiting{root};
        while (!waiting.empty()) {
            const uint32_t child = waiting.back();
            waiting.pop_back();
            if (child == shared::kNone) continue;
            if ((child & shared::kLeafFlag) == 0) {
                waiting.push_back((*model_.nodes)[child].child0);
                waiting.push_back((*model_.nodes)[child].child1);
                continue;
            }
            const uint32_t first = child & shared::kLeafFirstMask;
            const uint32_t end = first + (child >> shared::kLeafCountShift & shared::kLeafCountMask) + 1;
            for (uint32_t i = first; i < end; ++i)
                addPrimitive(child >> shared::kLeafKindShift & shared::kLeafKindMask, i, instance);
        }
    }

    void addPrimitive(uint32_t kind, uint32_t i, const rows::Instance* instance) {
        switch (static_cast<shared::PrimitiveKind>(kind)) {
            case shared::PrimitiveKind::Triangle:
                return addTriangle(i, instance);
            case shared::PrimitiveKind::Sphere:
                return addSphere(model_.spheres[i]);
            case shared::PrimitiveKind::Polygon:
                return addPolygon(model_.polygons[i]);
            case shared::PrimitiveKind::Quadric:
                return addQuadric(model_.quadrics[i]);
            case shared::PrimitiveKind::Cuboid:
                return addCuboid(model_.cuboids[i]);
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
        const double turns = turnsOf(v[0] - eye_, v[1] - eye_, v[2] - eye_);
        turns_[medium] += mirrored ? -turns : turns;
    }
    void addSphere(const rows::Sphere& s) {
        const uint32_t medium = mediumOf(s.material);
        if (medium == 0) return;
        const dvec3 center = s.point - s.radius * s.anchorNormal;
        boxes_[medium].include(center - s.radius);
        boxes_[medium].include(center + s.radius);
        turns_[medium] += glm::distance(eye_, center) < s.radius ? 1 : 0;
    }
    void addPolygon(const rows::Polygon& p) {
        const uint32_t medium = mediumOf(p.material);
        if (medium == 0) return;
        const rows::PolygonVertex* v = &model_.polygonVertices[p.firstVertex];
        for (uint32_t i = 0; i < p.trips * shared::kPolygonEdgesPerTrip; ++i) {
            boxes_[medium].include(v[i].position);
            if (i > 0)
                turns_[medium] +=
                    turnsOf(v[0].position - eye_, v[i].position - eye_, v[i + 1].position - eye_);
        }
    }

    // The eye in the solid's own coordinates; the medium's box grows by the solid's.
    template <typename Solid>
    dvec3 eyeIn(const Solid& solid, uint32_t medium) {
        const glm::dmat3 toLocal = glm::transpose(glm::dmat3(solid.toLocal0, solid.toLocal1, solid.toLocal2));
        const glm::dmat3 back = glm::inverse(toLocal);
        Bounds local;
        local.include(solid.lo);
        local.include(solid.hi);
        for (int i = 0; i < 8; ++i) boxes_[medium].include(solid.point + back * local.corner(i));
        return toLocal * (eye_ - solid.point);
    }

    void addQuadric(const rows::Quadric& q) {
        const uint32_t medium = mediumOf(q.material);
        if (medium == 0) return;
        const dvec3 y = eyeIn(q, medium);
        for (int i = 0; i < 3; ++i)
            if (y[i] < q.lo[i] || y[i] > q.hi[i]) return;
        const double value = glm::dot(q.squares, y * y) +
                             2 * (q.products.x * y.y * y.z + q.products.y * y.x * y.z +
                                  q.products.z * y.x * y.y + glm::dot(q.linear, y)) +
                             q.constant;
        turns_[medium] += value < 0 ? 1 : 0;
    }
    void addCuboid(const rows::Cuboid& c) {
        const uint32_t medium = mediumOf(c.material);
        if (medium == 0) return;
        const dvec3 y = eyeIn(c, medium);
        const bool inside = glm::all(glm::lessThan(c.lo, y)) && glm::all(glm::lessThan(y, c.hi));
        turns_[medium] += inside ? 1 : 0;
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
