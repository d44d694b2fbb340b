#include <algorithm>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "pack/dielectric_rank.h"
#include "reference/instance.h"
#include "reference/intersect.h"
#include "reference/material.h"
#include "reference/tracer.h"
#include "reference/traverse.h"

namespace glint::reference {
namespace {

using shared::kNone;

// Slab planes: t = (b - o) * (1 / d) rounds three times, so a true far t may be computed short by gamma_3,
// and a near one long by as much; scaling the far one by 1 + 2 gamma_3 = 1 + 6 u makes up for both (Pharr,
// Jakob and Humphreys, Physically Based Rendering, 4th ed., section 6.8.2). Rounded up to 8 u.
constexpr double kFarPad = 1 + 8 * kUnitRoundoff;

// A box is entered if its near t is at most this times the best t. A hit's t is computed in long double and
// errs by 2^-64 times the cancellation in n.(v0 - o); 2^-30 covers a cancellation of 2^34, far beyond any ray
// that fp32 inputs can aim, and costs no visits. With less, an equal t with a lower id could hide in a box
// that is left out.
constexpr double kCullPad = 1 + 0x1p-30;

// Entry t into the box of a child (0 or 1) of a node; NaN-free. A comparison with NaN is false, so a plane
// that a parallel ray runs in (0 * inf) constrains nothing: boxes are closed.
inline double enterBox(const rows::Node& node, int child, const PreparedRay& ray) {
    const glm::dvec3 &lo = loOf(node, child), &hi = hiOf(node, child);
    double tNear = ray.tMin * (2 - kCullPad), tFar = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
        const bool isDown = ray.inverse[i] < 0;
        const double t0 = ((isDown ? hi : lo)[i] - ray.origin[i]) * ray.inverse[i];
        const double t1 = ((isDown ? lo : hi)[i] - ray.origin[i]) * ray.inverse[i];
        tNear = t0 > tNear ? t0 : tNear;
        tFar = t1 < tFar ? t1 : tFar;
    }
    return tNear <= tFar * kFarPad ? tNear : kNotEntered;
}

// One query: the closest hit, or any.
template <bool kAny>
class Search {
  public:
    Search(const Tracer& tracer, const Ray& ray, const Source& source)
        : end(ray.tMax), tracer_(tracer), scene_(tracer.model()), ray_(ray), source_(source) {}

    double end;                       // of the ray's interval: at most the least t + slip so far
    bool behind = false;              // boxes that begin behind `end` are entered, too
    std::vector<Hit>* all = nullptr;  // collects every hit; the result is then empty

    // cost: a counter of boxes and primitives, or null.
    std::optional<Hit> run(uint64_t* cost) {
        Space world{PreparedRay(ray_), source_.instance == kNone ? source_.primitive : kNone};
        if (!world.ray.valid) return std::nullopt;
        world.ray.leaves = source_.primitive != kNone;
        setLimit(behind ? ray_.tMax : end);
        const Leaf planes{shared::PrimitiveKind::Plane, 0, static_cast<uint32_t>(scene_.planes.size())};
        if (!testLeaf(world, planes) && scene_.environment.root != kNone)
            testTree(world, scene_.environment.root);
        if (cost) *cost += cost_;
        return best_;
    }

  private:
    // The world, or an instance with its own coordinates.
    struct Space {
        PreparedRay ray;
        uint32_t source;  // the primitive on which the ray starts, if in this space
        uint32_t instance = kNone, idBase = 0;
    };

    // The functions below return true if an any-hit search is over.
    bool testTree(const Space& space, uint32_t root) {
        return traverse(
            *scene_.nodes, root,
            [&](const rows::Node& node, int child) {
                ++cost_;
                return enterBox(node, child, space.ray);
            },
            [&] { return limit_; }, [&](const Leaf& leaf, double) { return testLeaf(space, leaf); });
    }

    // No box begins at infinity: a parallel ray outside a slab has its near t there.
    void setLimit(double t) { limit_ = std::min(t * kCullPad, std::numeric_limits<double>::max()); }

    bool testLeaf(const Space& space, const Leaf& leaf) {
        switch (leaf.kind) {
#define GLINT_TEST(number, Kind, KINDS, kinds, one, many) \
    case shared::PrimitiveKind::Kind:                     \
        return testArray(space, scene_.kinds, leaf);
            GLINT_PRIMITIVES(GLINT_TEST, GLINT_NO_KIND)
#undef GLINT_TEST
            case shared::PrimitiveKind::Instance:
                for (uint32_t i = leaf.first; i < leaf.end; ++i)
                    if (testInstance(i)) return true;
        }
        return false;
    }

    bool testInstance(uint32_t index) {
        const rows::Instance& instance = scene_.instances[index];
        const InstanceFrame frame(instance);
        Space inside{PreparedRay(frame.enterInstance(ray_)),
                     source_.instance == index ? source_.primitive : kNone, index, instance.idBase};
        if (!inside.ray.valid) return false;
        inside.ray.leaves = source_.primitive != kNone;
        inside.ray.slip = frame.slipOfWayIn(ray_.origin);
        return testTree(inside, instance.root);
    }

    template <class Primitive>
    bool testArray(const Space& space, const std::vector<Primitive>& array, const Leaf& leaf) {
        for (uint32_t i = leaf.first; i < leaf.end; ++i) {
            ++cost_;
            Hit hit;
            const uint32_t primitive = static_cast<uint32_t>(leaf.kind) << shared::kPrimitiveKindShift | i;
            if (!testPrimitive(space, array[i], primitive, hit)) continue;
            if constexpr (!kAny) {
                const bool closer = !best_ || hit.t + hit.slip < best_->t - best_->slip;
                end = std::min(end, hit.t + hit.slip);
                if (!behind) setLimit(end);
                if (!closer && hit.id > best_->id) continue;
            }
            best_ = hit;
            if constexpr (kAny) return true;
        }
        return false;
    }

    // Tries several lookups within their rounding for the answer that RayNoise::solid prefers.
    bool isHole(const Hit& hit) const {
        constexpr int kLookups = 16;
        const Surface surface = tracer_.surfaceAt(ray_, hit);
        RayNoise noise = ray_.noise;
        const bool inside = glm::dot(surface.geometricNormal, ray_.direction) > 0;
        const bool solid =
            noise.solid == RayNoise::kAll || (noise.solid == hit.id && (inside || !noise.solidInside));
        bool hole = holeAt(scene_, surface, noise);
        for (int i = 1; i < kLookups && noise.solid; ++i) {
            if (hole != solid) break;
            noise.seed += kUniformStride;
            hole = holeAt(scene_, surface, noise);
        }
        return hole;
    }

    // Finds the first hit of a primitive that is no hole of its surface, or stores all of them. True if a hit
    // counts for the search.
    template <class Primitive>
    bool testPrimitive(const Space& space, const Primitive& one, uint32_t primitive, Hit& hit) {
        Root root;
        const Methods& methods = tracer_.methods();
        if (!intersect(one, {scene_, methods, space.ray, primitive, space.source, end}, root)) return false;
        PreparedRay further = space.ray;
        do {
            if (std::is_same_v<Primitive, rows::Triangle> && isMirrored(scene_, space.instance))
                std::swap(root.u, root.v);
            hit = {root.t,
                   root.u,
                   root.v,
                   primitive | root.part << shared::kPartShift,
                   idInInstance(space.idBase, one.id),
                   space.instance,
                   space.ray.ties ? root.slip : 0};
            const bool hole = scene_.alphaMask && isHole(hit);
            if (!hole && !all) return true;
            if (!hole) all->insert(all->end(), root.twice ? 2 : 1, hit);
            // Search again behind a root, for surfaces that are hit more than once.
            further.tMin = root.t;
        } while (intersect(one, {scene_, methods, further, primitive, space.source, end}, root));
        return false;
    }

    const Tracer& tracer_;
    const Model& scene_;
    const Ray& ray_;
    const Source& source_;
    uint64_t cost_ = 0;
    double limit_ = 0;  // boxes that begin beyond it are culled
    std::optional<Hit> best_;
};

// The device's least contribution is a float.
Tracing roundedTracing(const Tracing& tracing) {
    Tracing rounded = tracing;
    double& least = rounded.limits.minContribution;
    least = static_cast<double>(static_cast<float>(least));
    return rounded;
}

}  // namespace

Tracer::Tracer(std::shared_ptr<const Model> model, const Tracing& tracing, double radianceBound)
    : model_(std::move(model)),
      scene_(*model_),
      tracing_(tracing),
      environment_(scene_.environment),
      lights_(scene_.lights) {
    environment_.radianceBound = radianceBound;
    environment_.minContribution = tracing.limits.minContribution;
    if (tracing.limits.depth) environment_.maxDepth = *tracing.limits.depth;
    if (!tracing.lighting) return;
    environment_.background = glm::dvec3(tracing.lighting->background);
    lights_.assign(tracing.lighting->lights.begin(), tracing.lighting->lights.end());
}

Tracer::Tracer(const PackedScene& scene, const Tracing& tracing)
    : Tracer(std::make_shared<const Model>(widened(scene)), roundedTracing(tracing),
             radianceBoundOf(scene, tracing)) {}

Tracer::Tracer(const PackedScene& scene, const Request& request)
    : Tracer(scene, static_cast<const Tracing&>(request)) {
    const double bound = environment_.radianceBound;
    environment_ = cameraEnvironment(scene, request);
    environment_.radianceBound = bound;
}

// The order of the traversal may decide whether a surface in the place of the closest hit is tested: it is
// not tested if it comes after the closest hit and its box begins behind the hit. The bounds of the rule hold
// for every order. A second search tests the fewest surfaces (slips 0), or the most.
std::optional<Hit> Tracer::closest(const Ray& ray, const Source& source, uint64_t* cost) const {
    Search<false> search(*this, ray, source);
    const std::optional<Hit> hit = search.run(cost);
    if (!hit || !ray.ties || ray.slips == 1) return hit;
    Search<false> bound(*this, ray, source);
    bound.end = search.end;
    bound.behind = ray.slips > 1;
    return bound.run(cost);
}

bool Tracer::occluded(const Ray& ray, const Source& source, uint64_t* cost) const {
    return Search<true>(*this, ray, source).run(cost).has_value();
}

std::vector<Hit> Tracer::allHits(const Ray& ray, const Source& source, uint64_t* cost) const {
    std::vector<Hit> hits;
    Search<false> search(*this, ray, source);
    search.all = &hits;
    search.run(cost);
    std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) {
        const uint32_t ofFile = ~shared::kDielectricRank;
        return std::pair(a.t, a.id & ofFile) < std::pair(b.t, b.id & ofFile);
    });
    return hits;
}

// The device errs in each t by at most the arithmetic part of its slip. Without that part, the closest hit is
// one that fp32 certainly finds in the place, so that no higher id is hit; with twice the part, no hit is
// left out that fp32 may find there. A higher id is hit only if the traversal found a third surface between,
// in whose place both are, with a lower id than both, before a closer one put that behind.
std::optional<Hit> Tracer::possibleHit(const Ray& ray, const Source& source, uint32_t id) const {
    Ray seen = ray;
    seen.ties = true;
    seen.slips = 0;
    const std::optional<Hit> certain = closest(seen, source);
    seen.slips = kMostSlips;
    const std::vector<Hit> hits = allHits(seen, source);
    double end = ray.tMax;
    for (const Hit& hit : hits) end = std::min(end, hit.t + hit.slip);
    const auto find = [&](uint32_t wanted) {
        return std::find_if(hits.begin(), hits.end(), [=](const Hit& hit) { return hit.id == wanted; });
    };
    const auto claimed = find(id);
    if (claimed == hits.end() || claimed->t - claimed->slip > end) return std::nullopt;
    const auto least = certain ? find(certain->id) : hits.end();
    if (least == hits.end() || id <= least->id) return *claimed;
    const bool isOrderOpen = std::any_of(hits.begin(), hits.end(), [&](const Hit& hit) {
        const double near = hit.t - hit.slip;
        return hit.id < least->id && near > end && near <= least->t + least->slip;
    });
    return isOrderOpen ? std::optional<Hit>(*claimed) : std::nullopt;
}

bool Tracer::crosses(const Ray& ray, const Hit& hit) const {
    if (!hit.isTriangle() || tracing_.methods.triangles != TriangleMethod::Watertight) return true;
    const PreparedRay seen(
        hit.instance == kNone ? ray : InstanceFrame(scene_.instances[hit.instance]).enterInstance(ray));
    return crossesTriangle(scene_.triangles[hit.primitive & shared::kPrimitiveIndexMask], seen);
}

}  // namespace glint::reference
