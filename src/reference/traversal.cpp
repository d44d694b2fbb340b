#include <algorithm>
#include <array>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include "pack/dielectric_rank.h"
#include "reference/instance.h"
#include "reference/material.h"
#include "reference/primitives.h"
#include "reference/tracer.h"
#include "reference/widened.h"

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

// The best hit so far, or in `all` every one, a counter of boxes and primitives, and where the search is: the
// instance and what its ids count from, kNone and 0 in the world.
struct Search {
    Hit best;
    double end = 0;  // of the ray's interval: at most the least t + slip so far
    uint64_t cost = 0;
    bool found = false;
    uint32_t instance = kNone;
    uint32_t idBase = 0;
    bool everywhere = false;  // every box is entered
    bool behind = false;      // boxes that begin behind `end` are entered, too
    std::vector<Hit>* all = nullptr;
    const Ray* world = nullptr;      // as it was given
    const Tracer* tracer = nullptr;  // whose search it is

    // Boxes that begin beyond it are left out. No box begins at infinity: a parallel ray outside a slab has
    // its near t there.
    double cullLimit() const {
        return std::min((behind ? world->tMax : end) * kCullPad, std::numeric_limits<double>::max());
    }
};

// The world, as a ray was given to it.
struct World {
    const Model& scene;
    const Ray& ray;
    const Source& source;
};

// Entry t into the box of a child (0 or 1) of a node; NaN-free. > limit: not within [0, limit]. A comparison
// with NaN is false, so a plane that a parallel ray runs in (0 * inf) constrains nothing: boxes are closed.
inline double enterBox(const double* node, int child, const PreparedRay& ray, double limit) {
    const double* box = node + 8 * child;
    double tNear = ray.tMin * (2 - kCullPad), tFar = std::numeric_limits<double>::infinity();
    for (int i = 0; i < 3; ++i) {
        const double t0 = (box[ray.nearPlane[i]] - ray.origin[i]) * ray.inverse[i];
        const double t1 = (box[ray.farPlane[i]] - ray.origin[i]) * ray.inverse[i];
        tNear = t0 > tNear ? t0 : tNear;
        tFar = t1 < tFar ? t1 : tFar;
    }
    return tNear <= tFar * kFarPad && tNear <= limit ? tNear : std::numeric_limits<double>::infinity();
}

bool isHole(const Model& scene, const Search& search, const Hit& hit) {
    return scene.alphaMask && holeAt(scene, search.tracer->surfaceAt(*search.world, hit));
}

// The hits of one primitive that count for the search: the first that is no hole of the surface, or all of
// them. True if there is one.
template <class Primitive>
bool testPrimitive(const Model& scene, const PreparedRay& ray, const Primitive& one, uint32_t primitive,
                   uint32_t source, Search& search, Hit& hit) {
    Root root;
    uint32_t part = 0;
    const Methods& methods = search.tracer->methods();
    if (!meets(one, {scene, methods, ray, primitive, source, search.end}, root, part)) return false;
    PreparedRay further = ray;
    do {
        if (std::is_same_v<Primitive, rows::Triangle> && isMirrored(scene, search.instance))
            std::swap(root.u, root.v);
        const uint32_t id = idInInstance(search.idBase, one.id);
        hit = {root.t, root.u, root.v, primitive | part << shared::kPartShift, id, search.instance};
        hit.slip = ray.ties ? root.slip : 0;
        const bool hole = isHole(scene, search, hit);
        if (!hole && !search.all) return true;
        if (!hole) search.all->insert(search.all->end(), root.twice ? 2 : 1, hit);
        // Search again behind a root, for surfaces that are hit more than once.
        further.tMin = root.t;
    } while (meets(one, {scene, methods, further, primitive, source, search.end}, root, part));
    return false;
}

// Tests `count` primitives of a kind. True if an any-hit search is over.
template <bool kAny, class Primitive>
bool testArray(const Model& scene, const PreparedRay& ray, const std::vector<Primitive>& array, uint32_t kind,
               uint32_t first, uint32_t count, uint32_t source, Search& search) {
    for (uint32_t i = first; i < first + count; ++i) {
        Hit hit;
        ++search.cost;
        const uint32_t primitive = kind << shared::kPrimitiveKindShift | i;
        if (!testPrimitive(scene, ray, array[i], primitive, source, search, hit)) continue;
        if constexpr (!kAny) {
            const bool closer = !search.found || hit.t + hit.slip < search.best.t - search.best.slip;
            search.end = std::min(search.end, hit.t + hit.slip);
            if (!closer && hit.id > search.best.id) continue;
            search.best = hit;
        }
        search.found = true;
        if constexpr (kAny) return true;
    }
    return false;
}

template <bool kAny>
bool testPrimitives(const Model& scene, const PreparedRay& ray, shared::PrimitiveKind kind, uint32_t first,
                    uint32_t count, uint32_t source, Search& search) {
    switch (kind) {
#define GLINT_TEST(number, Kind, kinds, one, many) \
    case shared::PrimitiveKind::Kind:              \
        return testArray<kAny>(scene, ray, scene.kinds, shared::kKind##Kind, first, count, source, search);
        GLINT_PRIMITIVES(GLINT_TEST, GLINT_NO_KIND)
#undef GLINT_TEST
        case shared::PrimitiveKind::Instance:
            return false;
    }
    return false;
}

template <bool kAny>
void searchTree(const World& world, const PreparedRay& ray, uint32_t source, uint32_t root, Search& search);

// Everything of an instance that the ray may hit. True if an any-hit search is over.
template <bool kAny>
bool searchInstance(const World& world, uint32_t index, Search& search) {
    const rows::Instance& instance = world.scene.instances[index];
    PreparedRay inside(InstanceFrame(instance).enterInstance(world.ray));
    if (!inside.valid) return false;
    inside.leaves = world.source.primitive != kNone;
    inside.slip = InstanceFrame(instance).slipOfWayIn(world.ray.origin);
    search.instance = index;
    search.idBase = instance.idBase;
    const uint32_t source = world.source.instance == index ? world.source.primitive : kNone;
    searchTree<kAny>(world, inside, source, instance.root, search);
    search.instance = kNone;
    search.idBase = 0;
    return kAny && search.found;
}

template <bool kAny>
bool testLeaf(const World& world, const PreparedRay& ray, uint32_t leaf, uint32_t source, Search& search) {
    const shared::PrimitiveKind kind = kindOfLeaf(leaf);
    const uint32_t first = leaf & shared::kLeafFirstMask;
    const uint32_t count = (leaf >> shared::kLeafCountShift & shared::kLeafCountMask) + 1;
    if (kind != shared::PrimitiveKind::Instance)
        return testPrimitives<kAny>(world.scene, ray, kind, first, count, source, search);
    for (uint32_t i = first; i < first + count; ++i)
        if (searchInstance<kAny>(world, i, search)) return true;
    return false;
}

// search.end holds the end of the ray's interval on entry.
template <bool kAny>
void searchTree(const World& world, const PreparedRay& ray, uint32_t source, uint32_t root, Search& search) {
    const Model& scene = world.scene;
    const rows::Node* nodes = scene.nodes->data();
    struct Entry {
        double t;
        uint32_t child;
    };
    std::array<Entry, kMaxTreeDepth + 1> stack;
    size_t size = 0;
    uint32_t child = root;
    for (;;) {
        if (child & shared::kLeafFlag) {
            if (testLeaf<kAny>(world, ray, child, source, search)) return;
        } else {
            const rows::Node& node = nodes[child];
            const auto* planes = reinterpret_cast<const double*>(&node);
            const double limit = search.cullLimit();
            const bool has0 = node.child0 != kNone, has1 = node.child1 != kNone;
            const auto enter = [&](bool has, int side) {
                if (!has) return std::numeric_limits<double>::infinity();
                return search.everywhere ? 0 : enterBox(planes, side, ray, limit);
            };
            const double t0 = enter(has0, 0), t1 = enter(has1, 1);
            search.cost += static_cast<uint64_t>(has0) + static_cast<uint64_t>(has1);
            const bool enter0 = t0 <= limit, enter1 = t1 <= limit;
            if (enter0 && enter1) {
                const bool swap = t1 < t0;
                stack[size++] = swap ? Entry{t0, node.child0} : Entry{t1, node.child1};
                child = swap ? node.child1 : node.child0;
                continue;
            }
            if (enter0 || enter1) {
                child = enter0 ? node.child0 : node.child1;
                continue;
            }
        }
        const double limit = search.cullLimit();
        do {
            if (size == 0) return;
            --size;
        } while (stack[size].t > limit);
        child = stack[size].child;
    }
}

template <bool kAny>
void searchScene(const Model& scene, const Source& from, Search& search) {
    const World world{scene, *search.world, from};
    const uint32_t source = from.instance == kNone ? from.primitive : kNone;
    PreparedRay prepared(world.ray);
    if (!prepared.valid) return;
    prepared.leaves = from.primitive != kNone;
    const auto planes = static_cast<uint32_t>(scene.planes.size());
    if (!testPrimitives<kAny>(scene, prepared, shared::PrimitiveKind::Plane, 0, planes, source, search) &&
        scene.environment.root != kNone)
        searchTree<kAny>(world, prepared, source, scene.environment.root, search);
}

Search searchOf(const Tracer& tracer, const Ray& ray) {
    Search search;
    search.tracer = &tracer;
    search.world = &ray;
    search.end = ray.tMax;
    return search;
}

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

// The order of the traversal may decide whether a surface in the place of the closest hit is tested: not if
// it is found after the closest hit, and its box begins behind that. The bounds of the rule are those of
// every order. A second search tests the fewest surfaces (slips 0), or the most.
std::optional<Hit> Tracer::closest(const Ray& ray, const Source& source, uint64_t* cost) const {
    Search search = searchOf(*this, ray);
    searchScene<false>(scene_, source, search);
    if (search.found && ray.ties && ray.slips != 1) {
        Search bound = searchOf(*this, ray);
        bound.end = search.end;
        bound.behind = ray.slips > 1;
        searchScene<false>(scene_, source, bound);
        bound.cost += search.cost;
        search = bound;
    }
    if (cost) *cost += search.cost;
    return search.found ? std::optional<Hit>(search.best) : std::nullopt;
}

bool Tracer::occluded(const Ray& ray, const Source& source, uint64_t* cost) const {
    Search search = searchOf(*this, ray);
    searchScene<true>(scene_, source, search);
    if (cost) *cost += search.cost;
    return search.found;
}

std::vector<Hit> Tracer::allHits(const Ray& ray, const Source& source, uint64_t* cost) const {
    std::vector<Hit> hits;
    Search search = searchOf(*this, ray);
    search.all = &hits;
    searchScene<false>(scene_, source, search);
    if (cost) *cost += search.cost;
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
    if (hit.primitive >> shared::kPrimitiveKindShift != shared::kKindTriangle ||
        tracing_.methods.triangles != TriangleMethod::Watertight)
        return true;
    const PreparedRay seen(
        hit.instance == kNone ? ray : InstanceFrame(scene_.instances[hit.instance]).enterInstance(ray));
    return crossesTriangle(scene_.triangles[hit.primitive & shared::kPrimitiveIndexMask], seen);
}

std::optional<Hit> Tracer::closestBruteForce(const Ray& ray, const Source& source) const {
    Search search = searchOf(*this, ray);
    search.everywhere = true;
    searchScene<false>(scene_, source, search);
    return search.found ? std::optional<Hit>(search.best) : std::nullopt;
}

}  // namespace glint::reference
