#include "reference/certain/certain.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

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

// A ray in the coordinates of a tree, for the tests of boxes.
struct BoxRay {
    dvec3 origin, direction;
    double pad;     // what its origin is off, on each axis
    double spread;  // and its direction, as a part of the distance from the origin
    dvec3 inverse = 1.0 / direction;
    double reach = greatestMagnitude(origin);
};

double greatestRowSum(const dmat3& m) {
    return greatestMagnitude(magnitudes(m) * dvec3(1));
}

// Into an instance, whose matrix and place are rounded to fp32: W (x - place) errs by that.
BoxRay entered(const BoxRay& ray, const shared::Instance& instance) {
    const dmat3 w = glm::transpose(
        dmat3(dvec3(instance.toObjectX), dvec3(instance.toObjectY), dvec3(instance.toObjectZ)));
    const dvec3 place(instance.place), away = ray.origin - place, direction = w * ray.direction;
    const double rows = greatestRowSum(w), size = greatestMagnitude(direction);
    return {w * away, direction,
            rows * (ray.pad + kFloatUnit * (4 * greatestMagnitude(place) + 16 * greatestMagnitude(away))),
            size > 0 ? 16 * kFloatUnit * rows * greatestMagnitude(ray.direction) / size : 1};
}

// Bound on how far rounding to fp32 moves a surface, times two. Centres, corners, radii and factors of unit
// vectors: u of the scene's size each. Rows D R A^-1 of a quadric or box under a transform A (R turns to its
// axis, D holds its sizes, which cancel): u |A R^T| |R A^-1| of twice that size; the sums of |R^T| |R| are at
// most 3.
double greatestMove(const Scene& scene, const PackedScene& packed) {
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
    const double size =
        std::max(greatestMagnitude(dvec3(packed.boundsLo)), greatestMagnitude(dvec3(packed.boundsHi)));
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
            flat(shared::kKindPlane << shared::kPrimitiveKindShift | i, kNone, packed_.planes[i].material);
        const dvec3 origin = ray_.ray().origin - packed_.origin;
        BoxRay local{origin, ray_.ray().direction,
                     2 * tracer_.slack_ + tracer_.boxSlack_ + 0x1p-50 * greatestMagnitude(origin), 0x1p-50};
        if (packed_.environment.root != kNone && !packed_.nodes.empty()) {
            const double instances =
                static_cast<double>(packed_.environment.instancePad) * greatestMagnitude(origin) +
                static_cast<double>(packed_.environment.instancePadAtOrigin);
            local.pad += instances;
            search(packed_.environment.root, local, kNone);
        }
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

    // Entry t of the box, or infinity. The box contains the fp32 geometry and may lie a unit of its
    // coordinates outside.
    double enter(const BoxRay& ray, const dvec3& lo, const dvec3& hi) const {
        const double size = std::max(greatestMagnitude(lo), greatestMagnitude(hi));
        const double pad = ray.pad + ray.spread * (ray.reach + size) + 2 * kFloatUnit * size;
        double near = std::max(ray_.ray().tMin, 0.0) * (1 - 0x1p-48), far = end_ * (1 + 0x1p-48);
        for (int i = 0; i < 3; ++i) {
            const double t0 = (lo[i] - pad - ray.origin[i]) * ray.inverse[i];
            const double t1 = (hi[i] + pad - ray.origin[i]) * ray.inverse[i];
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
                flat(primitive, instance, materialOf(i, instance));
            else if (leaf.kind == shared::PrimitiveKind::Sphere && instance == kNone)
                sphere(i, primitive);
            else
                add({{near, kInfinity}, primitive, instance, kNone, false}, kNone);
        }
    }

    // A triangle or plane.
    void flat(uint32_t primitive, uint32_t instance, uint32_t material) {
        const ExactSurface surface = exactly(primitive, instance);
        if (const auto span = ray_.span(surface))
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
        const auto* shape = std::get_if<SphereShape>(&tracer_.scene_.objects[packed.object].shape);
        if (shape == nullptr) {
            add({{0, kInfinity}, primitive, kNone, packed.id, false}, kNone);
            return;
        }
        for (const auto& span : ray_.spans(*shape))
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
        contenders_.push_back(contender);
    }

    // Split triangles stand in the tree more than once.
    void dropTwins() {
        const auto key = [](const Contender& c) { return std::tuple(kindOfPrimitive(c.primitive), c.id); };
        std::ranges::sort(contenders_, {}, key);
        const auto twins = [&](const Contender& a, const Contender& b) {
            return a.exact && b.exact && key(a) == key(b);
        };
        contenders_.erase(std::unique(contenders_.begin(), contenders_.end(), twins), contenders_.end());
    }

    Answer decide() {
        std::erase_if(contenders_, [&](const Contender& c) { return c.span.lower > end_; });
        if (packed_.features.splitTriangles && contenders_.size() > 1) dropTwins();
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
// those of an instance to and fro.
Tracer::Tracer(const Scene& scene, const PackedScene& packed) : scene_(scene), packed_(packed) {
    const PrimitiveNumbers numbers(scene);
    double size = greatestMagnitude(packed.origin);
    // A plane's point is moved to where the scene and the eye are.
    if (!packed.planes.empty())
        size = std::max(
            {size + greatestMagnitude(dvec3(packed.boundsLo)) + greatestMagnitude(dvec3(packed.boundsHi)),
             greatestMagnitude(scene.camera.eye)});
    for (uint32_t i = 0; i < scene.objects.size(); ++i) {
        const Object& object = scene.objects[i];
        firstIds_.push_back(numbers.firstId(i));
        if (const auto* plane = std::get_if<PlaneShape>(&object.shape))
            size = std::max(size, greatestMagnitude(plane->point));
        const auto* mesh = std::get_if<MeshShape>(&object.shape);
        if (mesh == nullptr || !object.transform) continue;
        double reach = 0;
        for (const dvec3& p : mesh->mesh->positions)
            reach = std::max(reach, isFinite(p) ? greatestMagnitude(p) : 0);
        size = std::max(size, greatestRowSum(object.transform->linear) * reach +
                                  greatestMagnitude(object.transform->offset));
    }
    boxSlack_ = greatestMove(scene, packed);
    slack_ =
        packed.origin == dvec3(0) && packed.instances.empty() && packed.planes.empty() ? 0 : 0x1p-48 * size;
}

Answer Tracer::closest(const WorldRay& ray) const {
    return isInvalid(ray) ? miss() : Search(*this, ray).run();
}

}  // namespace glint::reference::certain
