#include "verify/explain.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <unordered_map>
#include <vector>

namespace glint::verify {

namespace {

constexpr double kUnit = 0x1p-24;
constexpr size_t kEnoughMembers = 8;
constexpr int kJittersForOneLookedAround = 21;
constexpr double kHullStretch = 1;
constexpr int kJittersPerLevel = 64;
// Behind half a dozen bounces between curved mirrors and facets one jitter in hundreds takes the same path.
constexpr int kJittersOfThePersistent = 4096;
// Where one of so many of these, or more, took a path that no other took, as many of further ones would take
// a new path (Good, Biometrika 40(3/4), 1953), which may be the device's: then so many are tried.
constexpr int kSeldom = 512, kJittersOfTheChaotic = 1 << 17;
// Of so many jitters of the camera ray alone the few that come nearest to the device's first hit are
// followed, each with so many of what comes after it.
constexpr uint64_t kAimed = 4096, kKept = 16, kJittersForOneKept = 64;

double maxComponent(const glm::dvec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

// Two first hits on different primitives at one t. The bound on |t - t'|: each t is good to about gamma_16
// (Woop's t with its weights' errors, sec. 6.8.7 of PBRT), relative to the largest t involved.
bool isTie(const DifferingPixel& pixel) {
    if (!pixel.reference.hit || !pixel.reference.surface || pixel.device.object == PixelData::kNoIndex)
        return false;
    const bool same = pixel.reference.surface->object == pixel.device.object &&
                      pixel.reference.surface->primitive == pixel.device.primitive;
    const double t = pixel.reference.hit->t;
    return !same && std::abs(t - pixel.device.depth) <= 2 * 16 * kUnit * std::max(t, pixel.device.depth);
}

// Jitters that are tried, up to the bound. Steps of 8 at most: of much wider ones hardly any jitter is as
// small as what happened.
std::vector<double> levelsTo(double bound) {
    std::vector<double> levels = {1.0};
    const double first = std::min(8.0, bound);
    const int steps = std::max(2, static_cast<int>(std::ceil(std::log(bound / first) / std::log(8.0))));
    for (int i = 0; i <= steps; ++i) levels.push_back(first * std::pow(bound / first, 1.0 * i / steps));
    return levels;
}

}  // namespace

// What the device's float arithmetic can do to a ray, as a turn of its direction in units of 2^-24:
// - the camera ray: 3 roundings for center + x stepX + y stepY and a normalisation good to 2.7 ulp: below 8
//   units of the numbers summed (Ray::directionScale, which the jitter knows);
// - its origin, where it moves with the pixel: 3 roundings of eye + x originStepX + y originStepY: 3 C / t,
//   less than a secondary one's;
// - the triangle test: it sees the edges moved sideways by gamma_5 (|x| + |z|) of the sheared corners (PBRT
//   sec. 6.8.7), that is by up to 10 units times the greatest distance M from the ray's origin to a corner,
//   on each of two axes; seen from the distance t of the hit that is 10 M / t;
// - a secondary origin: gamma_7 of the coordinates, twice for the offset: 14 C / t, C the greatest
//   coordinate. M and C are bounded by the scene's box and the points of the path; t is the shortest
//   distance along the path;
// - in an instance: what is off by so much in its coordinates is off by K times as much in the world, K the
//   greatest row sum of |A| |A^-1|; and the ray is off by gamma_4 |A^-1| |o - T| at its origin and by
//   gamma_3 |A^-1| |d| t at the hit, together no more than 10 K C (pack/instances.cpp), and its next origin
//   by as much.
// What a textbook's sphere test loses is no turn of a ray: the formula itself errs, and with it every jitter
// here (Jitter::formulas).
double roundingBound(const PackedScene& scene, const reference::PixelRecord& record, bool instances) {
    double extent = std::max(maxComponent(scene.boundsLo), maxComponent(scene.boundsHi));
    double shortest = std::numeric_limits<double>::infinity();
    for (const reference::Bounce& bounce : record.path) {
        extent = std::max({extent, maxComponent(bounce.ray.origin), bounce.ray.originScale});
        if (bounce.surface) extent = std::max(extent, maxComponent(bounce.surface->position));
        if (bounce.hit) shortest = std::min(shortest, bounce.hit->t);
    }
    if (!std::isfinite(shortest) || shortest <= 0) return 8;
    double bound = 8 + (10 * 2 + 14) * extent / shortest;
    if (instances) bound = 8 + (10 * 2 + 14 + 2 * 10) * std::max(scene.instanceGain, 1.0) * extent / shortest;
    return bound;
}

namespace {

// Whether the answer lies within the predicted error of the path that `moved` took under `jitter`. What is
// predicted without one knows nothing of what a textbook's formula loses: that has to be explained.
bool isNear(const reference::Tracer& tracer, const reference::Ray& cameraRay, const reference::Jitter& jitter,
            const reference::PixelRecord& moved, const PackedScene& scene, const Quantities& device) {
    const Quantities floors = floorsOf(scene, moved, cameraRay);
    const Quantities middle = quantitiesOf(moved, scene.origin);
    const double gain = kResponseGain * (moved.meetsInstance ? 1 + scene.instanceGain : 1);
    // Of a chaotic path few moves of one unit decide nothing otherwise: then smaller ones tell the slope.
    for (const double units : {1.0, 1.0 / 16, 1.0 / 256}) {
        size_t members = 0;
        Hull hull(middle);
        for (uint64_t seed = 1; seed <= kResponseMoves; ++seed) {
            const reference::Jitter near =
                jitter.ulps == 0 ? reference::Jitter{seed, units}
                                 : reference::Jitter{jitter.seed,         jitter.ulps, seed,
                                                     units / jitter.ulps, true,        jitter.laterSeed};
            const reference::PixelRecord next = tracer.trace(cameraRay, near);
            if (next.decisions != moved.decisions) continue;
            ++members;
            hull.include(quantitiesOf(next, scene.origin));
            if (hull.contains(device, floors, gain / units)) return true;
        }
        if (members >= kEnoughMembers) break;
    }
    return false;
}

}  // namespace

bool isPredicted(const reference::Tracer& tracer, const reference::Ray& cameraRay,
                 const reference::PixelRecord& still, const PackedScene& scene, const Quantities& device) {
    const Quantities floors = floorsOf(scene, still, cameraRay);
    return Hull(quantitiesOf(still, scene.origin)).contains(device, floors, 0) ||
           isNear(tracer, cameraRay, {}, still, scene, device);
}

namespace {

// What one search knows.
class Search {
  public:
    Search(const reference::Tracer& tracer, const reference::Ray& ray, const PackedScene& scene,
           const Quantities& device, DifferingPixel& pixel, bool persistently)
        : tracer_(tracer),
          ray_(ray),
          scene_(scene),
          device_(device),
          pixel_(pixel),
          persistently_(persistently),
          jitters_(persistently ? kJittersOfThePersistent : kJittersPerLevel) {}

    // Tries jitters from more than `from` units up to the bound of `record`. True once one explains the
    // pixel.
    bool upTo(const reference::PixelRecord& record, double from);
    // The bound of the device's path as a jitter has shown it, the reference's own where none has.
    const std::optional<reference::PixelRecord>& likeDevice() const { return likeDevice_; }

  private:
    // Answers that all decisions have led to alike: the colour is continuous between them.
    struct Class {
        uint32_t decisions;
        size_t members;
        Hull hull;
    };
    bool tryLevel(double ulps, bool beyondPlain);
    bool tryOne(const reference::Jitter& jitter, bool beyondPlain, uint32_t& path);
    bool tryAimed(double ulps, bool beyondPlain);
    Class& classOf(const reference::PixelRecord& moved, const Quantities& q);

    const reference::Tracer& tracer_;
    const reference::Ray& ray_;
    const PackedScene& scene_;
    const Quantities& device_;
    DifferingPixel& pixel_;
    bool persistently_;
    int jitters_;  // for each level
    std::vector<Class> classes_;
    std::optional<reference::PixelRecord> likeDevice_;
    uint64_t seed_ = 1;
};

Search::Class& Search::classOf(const reference::PixelRecord& moved, const Quantities& q) {
    for (Class& c : classes_)
        if (c.decisions == moved.decisions) return c;
    classes_.push_back({moved.decisions, 0, Hull(q)});
    return classes_.back();
}

// beyondPlain: more than the bound of paths that meet no instance.
// path: receives the hash of the one taken.
bool Search::tryOne(const reference::Jitter& jitter, bool beyondPlain, uint32_t& path) {
    const reference::PixelRecord moved = tracer_.trace(ray_, jitter, false);
    path = moved.pathHash;
    if (moved.pathHash != pixel_.device.pathHash) return false;
    if (beyondPlain && !moved.meetsInstance && !pixel_.reference.meetsInstance) return false;
    const Quantities q = quantitiesOf(moved, scene_.origin);
    Class& c = classOf(moved, q);
    ++c.members;
    c.hull.include(q);
    if (!likeDevice_) likeDevice_ = tracer_.trace(ray_, jitter, true);
    // The extremes of a box are seldom among few random moves.
    const bool within = c.hull.contains(device_, floorsOf(scene_, moved, ray_),
                                        c.members >= kEnoughMembers ? kHullStretch : 0);
    // Where hardly any jitter takes the device's path, what lies around the one that does decides.
    const bool alone = c.members <= static_cast<size_t>(jitters_ / kJittersForOneLookedAround);
    if (!within && !(alone && isNear(tracer_, ray_, jitter, moved, scene_, device_))) return false;
    const bool same = moved.decisions == pixel_.reference.decisions;
    pixel_.reason = isTie(pixel_) ? Reason::Tie : same ? Reason::Rounding : Reason::Edge;
    pixel_.ulps = jitter.ulps;
    return true;
}

// At a limb one jitter in a thousand hits where the device does, and of those one in a hundred goes on as it
// does; the device says where it hits.
bool Search::tryAimed(double ulps, bool beyondPlain) {
    if (pixel_.device.object == PixelData::kNoIndex) return false;
    std::vector<std::pair<double, reference::Jitter>> nearest;
    for (uint64_t i = 0; i < kAimed; ++i) {
        const reference::Jitter jitter = {seed_++, ulps, 0, 0, true};
        const std::optional<reference::Hit> hit = tracer_.firstHit(ray_, jitter);
        if (hit) nearest.emplace_back(std::abs(hit->t - pixel_.device.depth), jitter);
    }
    const auto kept = nearest.begin() + static_cast<std::ptrdiff_t>(std::min(nearest.size(), size_t{kKept}));
    std::partial_sort(nearest.begin(), kept, nearest.end(),
                      [](const auto& a, const auto& b) { return a.first < b.first; });
    for (auto at = nearest.begin(); at != kept; ++at) {
        for (uint64_t i = 0; i < kJittersForOneKept; ++i) {
            at->second.laterSeed = seed_++;
            uint32_t path = 0;
            if (tryOne(at->second, beyondPlain, path)) return true;
        }
    }
    return false;
}

bool Search::tryLevel(double ulps, bool beyondPlain) {
    std::unordered_map<uint32_t, int> taken;
    int once = 0;
    for (int i = 0; i < kJittersOfTheChaotic; ++i) {
        if (i == jitters_ && (!persistently_ || once * kSeldom < jitters_)) return false;
        uint32_t path = 0;
        if (tryOne({seed_++, ulps, 0, 0, true}, beyondPlain, path)) return true;
        if (!persistently_ || i >= jitters_) continue;
        const int times = ++taken[path];
        once += times == 1 ? 1 : (times == 2 ? -1 : 0);
    }
    return false;
}

bool Search::upTo(const reference::PixelRecord& record, double from) {
    const double plain = roundingBound(scene_, record, false);
    const double bound = scene_.instances.empty() ? plain : roundingBound(scene_, record, true);
    pixel_.ulps = std::max(pixel_.ulps, record.meetsInstance ? bound : plain);
    std::vector<double> levels = levelsTo(plain);
    if (bound > plain)
        for (const double ulps : levelsTo(bound))
            if (ulps > plain) levels.push_back(ulps);
    // Between them, too.
    if (persistently_) levels.insert(levels.begin() + 1, {2.0, 4.0});
    for (const double ulps : levels) {
        if (ulps <= from) continue;
        if (tryLevel(ulps, ulps > plain)) return true;
        if (persistently_ && tryAimed(ulps, ulps > plain)) return true;
    }
    return false;
}

}  // namespace

void explain(const reference::Tracer& tracer, const reference::Ray& cameraRay, const PackedScene& scene,
             const Quantities& device, DifferingPixel& pixel, bool persistently) {
    Search search(tracer, cameraRay, scene, device, pixel, persistently);
    pixel.ulps = 0;
    if (search.upTo(pixel.reference, 0)) return;
    // Where a jitter within the bound takes the device's path, that path has a bound of its own: it may be
    // longer or shorter than the reference's.
    const double from = pixel.ulps;
    if (search.likeDevice() && search.upTo(*search.likeDevice(), from)) return;
    pixel.reason = Reason::Unexplained;
}

}  // namespace glint::verify
