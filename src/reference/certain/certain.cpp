#include "reference/certain/certain.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/vectors.h"
#include "pack/primitives.h"
#include "pack/scene_arrays.h"
#include "reference/certain/decide.h"
#include "reference/rounding.h"
#include "reference/traverse.h"
#include "scene/transform.h"

namespace glint::reference::certain {

using glm::dmat3;
using glm::dvec3;
using shared::kNone;

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool isInvalid(const WorldRay& ray) {
    return !isFinite(ray.origin) || !isFinite(ray.direction) ||
           greatestMagnitude(ray.direction) < kShortestDirection || !(ray.tMin < ray.tMax) || !(ray.tMax > 0);
}

Answer miss() {
    Answer answer;
    answer.sure = true;
    answer.hit.t = answer.lower = answer.upper = kInfinity;
    return answer;
}

double greatestRowSum(const dmat3& m) {
    return greatestMagnitude(magnitudes(m) * dvec3(1));
}

// A ray in the coordinates of a tree, for the tests of boxes. pad: how far it, and the surfaces, may be off
// on each axis.
struct BoxRay {
    dvec3 origin, direction;
    double pad;
    dvec3 inverse = 1.0 / direction;
};

// Into an instance. Its matrix and place are rounded to fp32, which moves the points of the ray by up to 32 u
// of its origin, 16 u of the scene's size and 20 u of the place; ray.pad has the last two.
BoxRay entered(const BoxRay& ray, const shared::Instance& instance) {
    const dmat3 w = glm::transpose(
        dmat3(dvec3(instance.toObjectX), dvec3(instance.toObjectY), dvec3(instance.toObjectZ)));
    return {w * (ray.origin - dvec3(instance.place)), w * ray.direction,
            greatestRowSum(w) * (ray.pad + 32 * kFloatUnit * greatestMagnitude(ray.origin))};
}

// Bound on how far rounding to fp32 moves a surface, times two. Centres, corners, radii and factors of unit
// vectors: u of the scene's size each. Rows D R A^-1 of a quadric or box under a transform A (R turns to its
// axis, D holds its sizes, which cancel): u |A R^T| |R A^-1| of twice that size; the sums of |R^T| |R| are at
// most 3.
double greatestMove(const Scene& scene, const PackedScene& packed, double size) {
    bool areExact = true;  // all surfaces are triangles and planes, also in instances
    visitPrimitiveArrays(packed, [&](shared::PrimitiveKind kind, const auto& array) {
        areExact &= array.empty() || kind == shared::PrimitiveKind::Triangle ||
                    kind == shared::PrimitiveKind::Plane || kind == shared::PrimitiveKind::Instance;
    });
    if (areExact) return 0;
    double gain = 1;
    for (const Object& object : scene.objects) {
        if (!object.transform || std::holds_alternative<MeshShape>(object.shape)) continue;
        gain = std::max(gain, greatestRowSum(magnitudes(object.transform->linear) *
                                             magnitudes(inverse(*object.transform).linear)));
    }
    return 2 * kFloatUnit * (4 + 6 * gain) * size;
}

}  // namespace

// One ray's.
class Search {
  public:
    Search(const Tracer& tracer, const WorldRay& ray)
        : tracer_(tracer), packed_(tracer.packed_), ray_(ray), end_(ray.tMax) {}

    Answer run() {
        for (uint32_t i = 0; i < packed_.planes.size(); ++i)
            flat(shared::kKindPlane << shared::kPrimitiveKindShift | i, kNone, packed_.planes[i].material, 0);
        const dvec3 origin = ray_.ray().origin - packed_.origin;
        const auto& environment = packed_.environment;
        if (environment.root == kNone || packed_.nodes.empty()) return decide();
        const double reach = greatestMagnitude(origin);
        const double instances = static_cast<double>(environment.instancePad) * reach +
                                 static_cast<double>(environment.instancePadAtOrigin);
        const double pad = tracer_.slack_ + 0x1p-49 * reach + instances;
        search(environment.root, {origin, ray_.ray().direction, pad}, kNone);
        return decide();
    }

  private:
    struct Contender {
        Span span;
        uint32_t primitive = kNone, instance = kNone, id = 0;
        bool exact = false;  // decided by nearestExactly
    };

    void search(uint32_t root, const BoxRay& ray, uint32_t instance) {
        traverse(
            packed_.nodes, root,
            [&](const shared::Node& node, int child) {
                return enter(ray, dvec3(loOf(node, child)), dvec3(hiOf(node, child)));
            },
            [&] { return std::min(end_, std::numeric_limits<double>::max()); },
            [&](const Leaf& leaf, double near) {
                testLeaf(leaf, ray, instance, near);
                return false;
            });
    }

    // Entry t of the box, or infinity.
    double enter(const BoxRay& ray, const dvec3& lo, const dvec3& hi) const {
        double near = std::max(ray_.ray().tMin, 0.0) * (1 - 0x1p-48), far = end_ * (1 + 0x1p-48);
        for (int i = 0; i < 3; ++i) {
            const double t0 = (lo[i] - ray.pad - ray.origin[i]) * ray.inverse[i];
            const double t1 = (hi[i] + ray.pad - ray.origin[i]) * ray.inverse[i];
            if (std::isnan(t0) || std::isnan(t1)) continue;
            near = std::max(near, std::min(t0, t1) * (1 - 0x1p-48));
            far = std::min(far, std::max(t0, t1) * (1 + 0x1p-48));
        }
        return near <= far ? near : kNotEntered;
    }

    void testLeaf(const Leaf& leaf, const BoxRay& ray, uint32_t instance, double near) {
        for (uint32_t i = leaf.first; i < leaf.end; ++i) {
            const uint32_t primitive = static_cast<uint32_t>(leaf.kind) << shared::kPrimitiveKindShift | i;
            if (leaf.kind == shared::PrimitiveKind::Instance)
                search(packed_.instances[i].root, entered(ray, packed_.instances[i]), i);
            else if (leaf.kind == shared::PrimitiveKind::Triangle)
                flat(primitive, instance, materialOf(i, instance), near);
            else if (leaf.kind == shared::PrimitiveKind::Sphere && instance == kNone)
                sphere(i, primitive);
            else
                add({{near, kInfinity}, primitive, instance, kNone, false}, kNone);
        }
    }

    // A triangle or plane, which is hit at `near` or later.
    void flat(uint32_t primitive, uint32_t instance, uint32_t material, double near) {
        const ExactSurface surface = exactly(primitive, instance);
        auto span = ray_.span(surface);
        if (!span) return;
        if (!span->isHit) span->lower = std::max(span->lower, near);
        add({*span, primitive, instance, surface.id, true}, material);
    }

    // The scene's own numbers, before packing.
    ExactSurface exactly(uint32_t primitive, uint32_t instance) const {
        const uint32_t index = primitive & shared::kPrimitiveIndexMask;
        const Scene& scene = tracer_.scene_;
        ExactSurface surface;
        if (kindOfPrimitive(primitive) == shared::PrimitiveKind::Plane) {
            const shared::Plane& plane = packed_.planes[index];
            surface.plane = std::get_if<PlaneShape>(&scene.objects[plane.object].shape);
            surface.id = plane.id;
            return surface;
        }
        const bool placed = instance != kNone;
        const uint32_t object =
            placed ? packed_.instances[instance].object : packed_.triangleSurfaces[index].object;
        surface.id = (packed_.triangles[index].id & ~shared::kDielectricRank) +
                     (placed ? packed_.instances[instance].idBase & ~shared::kDielectricRank : 0);
        const Object& source = scene.objects[object];
        surface.corners = TriangleSource(source).vertices(surface.id - tracer_.firstIds_[object]);
        if (placed && source.transform) surface.place = &*source.transform;
        return surface;
    }

    void sphere(uint32_t index, uint32_t primitive) {
        const shared::Sphere& packed = packed_.spheres[index];
        for (const auto& span :
             ray_.spans(std::get<SphereShape>(tracer_.scene_.objects[packed.object].shape)))
            if (span) add({*span, primitive, kNone, packed.id, false}, packed.material);
    }

    uint32_t materialOf(uint32_t triangle, uint32_t instance) const {
        const uint32_t own = packed_.triangleSurfaces[triangle].material;
        return instance != kNone && packed_.instances[instance].material != kNone
                   ? packed_.instances[instance].material
                   : own;
    }

    bool hasHoles(uint32_t material) const {
        return material != kNone && packed_.features.alphaMask && packed_.materials[material].alphaCutoff > 0;
    }

    void add(Contender contender, uint32_t material) {
        if (hasHoles(material)) contender.exact = contender.span.isHit = false;
        if (contender.span.isHit) end_ = std::min(end_, contender.span.upper);
        // Split triangles stand in the tree more than once.
        const bool known = std::ranges::any_of(contenders_, [&](const Contender& c) {
            return c.exact && contender.exact && c.id == contender.id;
        });
        if (known) return;
        contenders_.push_back(contender);
    }

    Answer decide() {
        std::erase_if(contenders_, [&](const Contender& c) { return c.span.lower > end_; });
        if (contenders_.empty()) return miss();
        if (contenders_.size() == 1 && contenders_[0].span.isHit) return sure(contenders_[0]);
        if (std::ranges::all_of(contenders_, &Contender::exact)) return decideExactly();
        Answer answer;
        answer.lower = answer.upper = kInfinity;
        for (const Contender& c : contenders_) {
            answer.lower = std::min(answer.lower, c.span.lower);
            if (c.span.isHit) answer.upper = std::min(answer.upper, c.span.upper);
        }
        return answer;
    }

    static Answer sure(const Contender& c) {
        return {
            true, {c.span.t, c.span.u, c.span.v, c.primitive, c.id, c.instance}, c.span.lower, c.span.upper};
    }

    Answer decideExactly() const {
        std::vector<ExactSurface> surfaces;
        for (const Contender& c : contenders_) surfaces.push_back(exactly(c.primitive, c.instance));
        const auto hit = nearestExactly(ray_.ray(), surfaces);
        if (!hit) return miss();
        const Contender& c = contenders_[hit->surface];
        return {true, {hit->lower, hit->u, hit->v, c.primitive, c.id, c.instance}, hit->lower, hit->upper};
    }

    const Tracer& tracer_;
    const PackedScene& packed_;
    SpanRay ray_;
    double end_;  // something is hit before that
    std::vector<Contender> contenders_;
};

// Positions are rounded to double where the scene's origin is taken away, and where a transform moves them:
// those of an instance to and fro. Boxes are of what fp32 holds.
Tracer::Tracer(const Scene& scene, const PackedScene& packed) : scene_(scene), packed_(packed) {
    const PrimitiveNumbers numbers(scene);
    double size = greatestMagnitude(packed.origin);
    for (uint32_t i = 0; i < scene.objects.size(); ++i) {
        const Object& object = scene.objects[i];
        firstIds_.push_back(numbers.firstId(i));
        const auto* mesh = std::get_if<MeshShape>(&object.shape);
        if (mesh == nullptr || !object.transform) continue;
        double reach = 0;
        for (const dvec3& p : mesh->mesh->positions)
            reach = std::max(reach, isFinite(p) ? greatestMagnitude(p) : 0);
        size = std::max(size, greatestRowSum(object.transform->linear) * reach +
                                  greatestMagnitude(object.transform->offset));
    }
    const double local =
        std::max(greatestMagnitude(dvec3(packed.boundsLo)), greatestMagnitude(dvec3(packed.boundsHi)));
    slack_ = 0x1p-47 * size + 32 * kFloatUnit * local + greatestMove(scene, packed, local);
}

Answer Tracer::closest(const WorldRay& ray) const {
    return isInvalid(ray) ? miss() : Search(*this, ray).run();
}

}  // namespace glint::reference::certain
