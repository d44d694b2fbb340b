// The tree of rays below a camera ray (docs/reference/shading.md). Lights and the scattering at a surface are
// in scatter.h.
#include <algorithm>
#include <cmath>
#include <utility>

#include "core/device_layout.h"
#include "core/vectors.h"
#include "reference/intersect.h"
#include "reference/material.h"
#include "reference/numbers.h"
#include "reference/rounding.h"
#include "reference/scatter.h"
#include "reference/tracer.h"

namespace glint::reference {
namespace {

using glm::dvec3;

// Moves rays by random amounts, as struct Jitter describes.
class RayMover {
  public:
    explicit RayMover(const Jitter& jitter)
        : jitter_(jitter), state_(jitter.seed), step_(jitter.ulps * kFloatUnit) {}

    bool moves() const { return step_ != 0; }
    double slips() const { return jitter_.slips; }
    // The distance from its surface at which a ray begins; the device's rays begin within `clearance`.
    double cleared(double clearance) const {
        return (jitter_.clears ? jitter_.ulps : jitter_.slips > 1 ? jitter_.slips : 0) * clearance;
    }

    // A random number of up to a step of `scale`.
    double shift(double scale) { return moves() ? step_ * scale * uniform(state_) : 0; }
    // A value after `roundings` roundings.
    double sway(double value, double roundings) { return value * (1 + shift(roundings)); }
    void turn(dvec3& direction, double scale) {
        if (!moves()) return;
        const double length = scale * glm::length(direction);
        for (int i = 0; i < 3; ++i) direction[i] += shift(length);
    }
    void move(Ray& ray, double scale) {
        if (!moves()) return;
        // A certificate needs enough rays on both sides of a mask.
        constexpr std::optional<uint32_t> kSolid[] = {std::nullopt, shared::kNone, RayNoise::kAll};
        ray.noise = {state_, step_, jitter_.formulas, kSolid[jitter_.lookup == 0 ? 0 : state_ % 3],
                     jitter_.seed / 2 % 2 == 1};
        for (int i = 0; i < 3; ++i) ray.origin[i] += shift(scale);
        turn(ray.direction, ray.directionScale);
    }

  private:
    const Jitter& jitter_;
    uint64_t state_;
    double step_;
};

// One camera ray followed to its end.
class PathTracer {
  public:
    PathTracer(const Tracer& tracer, const Jitter& jitter, bool keepPath)
        : tracer_(tracer),
          scene_(tracer.model()),
          mover_(jitter),
          jitter_(jitter),
          hit_(jitter.hit),
          keepPath_(keepPath) {}

    PixelRecord run(const Ray& cameraRay);
    Step step(Branch branch);

  private:
    std::optional<Hit> closest(const Ray& ray, const Source& source, RayClass kind);
    void decide(uint32_t word) { record_.decisions = addDecisions(record_.decisions, word); }
    void decide(const Hit& hit) {
        decide(hit.primitive);
        decide(hit.instance);
        record_.meetsInstance = record_.meetsInstance || hit.instance != shared::kNone;
    }
    // Decides quantities that change in steps.
    void decideCells(const Surface& textured) {
        if (!scene_.textures.empty()) decide(cellsAt(scene_, textured, jitter_.lookup != 0));
    }
    void addLight(const RoundedColor& light);
    // Counts a ray; returns the counter of its tests.
    uint64_t* countRay(RayClass kind) {
        RayTally& tally = record_.tally[static_cast<size_t>(kind)];
        ++tally.rays;
        return &tally.tests;
    }
    Interaction interactionAt(const Ray& ray, const Hit& hit, const Surface& surface, const Media& media);
    Ray rayFrom(const Interaction& at, const dvec3& direction, double tMax);
    RoundedColor shadeLights(const Interaction& at, bool first);
    RoundedColor shadeLight(const Interaction& at, size_t index, bool first);
    std::optional<RoundedColor> lightThrough(const Ray& ray, const Interaction& at, bool directional);
    bool masksDecide(Ray shadow, const Interaction& at, bool directional);
    void follow(const Branch& branch) {
        const uint32_t before = std::exchange(record_.decisions, 0);
        const std::vector<Branch> next = visit(branch);
        record_.decisions = addDecisions(before, record_.decisions);
        for (const Branch& b : next) {
            ++record_.bounces;
            follow(b);
        }
    }
    // Adds the light of one ray's hit, and returns the rays that leave it.
    std::vector<Branch> visit(const Branch& branch);
    std::vector<Branch> branchesOf(const Branch& branch, const Interaction& at,
                                   const RoundedColor& throughput);
    // Each contribution is added with a rounding of the sum so far.
    void finishRounding() {
        record_.rounding += static_cast<double>(contributions_) * record_.color;
        record_.rounding *= kFloatUnit;
    }
    // Drops the weaker of two branches if there is no room for one to wait.
    void dropOne(std::vector<Branch>& next) {
        const bool keepSecond = contribution(next[1]) > contribution(next[0]);
        record_.lost.room.add(1, contribution(next[keepSecond ? 0 : 1]));
        next.erase(next.begin() + (keepSecond ? 0 : 1));
    }
    bool isFollowed(const Branch& next);
    double contribution(const Branch& next) const {
        const dvec3& t = next.throughput.value;
        const double most = std::max({t.x, t.y, t.z});
        const bool tells = most >= static_cast<double>(shared::kLeastThroughput);
        return tells ? most * tracer_.environment().radianceBound : 0;
    }
    // The surface with texture coordinates moved by rounding; mapShift() moves those of the environment map.
    Surface texturedAt(const Hit& hit, const Surface& surface);
    // The surface of the unmoved ray at Jitter::t, with the texture coordinates of Jitter::lookup.
    Surface lookedUpAt(const Hit& hit) const;
    glm::dvec2 mapShift() {
        if (tracer_.environment().map == 0) return glm::dvec2(0);
        const double u = mover_.shift(1);
        return {u, mover_.shift(1)};
    }

    const Tracer& tracer_;
    const Model& scene_;
    RayMover mover_;
    const Jitter& jitter_;
    uint32_t hit_;  // Jitter::hit, until the first ray is followed
    Ray unmoved_;   // of a step
    Step own_;      // the answer of step()
    bool keepPath_;
    PixelRecord record_;
    uint32_t contributions_ = 0;
};

std::optional<Hit> PathTracer::closest(const Ray& ray, const Source& source, RayClass kind) {
    Ray seen = ray;
    seen.ties = true;
    seen.slips = mover_.slips();
    std::optional<Hit> hit = tracer_.closest(seen, source, countRay(kind));
    if (hit && hit_ != shared::kNone && hit_ != hit->id)
        if (const std::optional<Hit> other = tracer_.possibleHit(ray, source, hit_)) hit = other;
    hit_ = shared::kNone;
    return hit;
}

Interaction PathTracer::interactionAt(const Ray& ray, const Hit& hit, const Surface& surface,
                                      const Media& media) {
    const Surface textured = texturedAt(hit, surface);
    decideCells(textured);
    Interaction at;
    const dvec3 d = glm::normalize(ray.direction);
    const double side = glm::dot(surface.geometricNormal, d) > 0 ? -1 : 1;
    at.source = sourceOf(hit);
    at.position = surface.position;
    at.entering = side > 0;
    at.n = side * surface.geometricNormal;
    at.s = side * surface.shadingNormal;
    at.view = -d;
    at.originScale = std::max(greatestMagnitude(ray.origin), ray.originScale);
    // Each coordinate of the position is a sum of products of numbers no greater than `scale`, or a point
    // moved onto its primitive, and errs by at most 9 u scale (weights 2 u, products and sums 7 u for a
    // triangle; less for the others): 16 u scale along n. Twice that, as the origin of the next ray is
    // rounded again.
    at.scale = surface.scale;
    // An instance's transform there and back makes more of each rounding.
    const double gain = hit.instance == shared::kNone ? 1 : 1 + scene_.instanceGain;
    at.normalError = normalError(surface.bend, at.originScale + at.scale, gain - 1);
    at.offset = 32 * kUnitRoundoff * at.scale * gain;
    const double clearance = clearanceOf(surface.error, surface.geometricNormal);
    at.clearance = std::isnan(clearance) ? 0 : clearance;
    at.material = materialAt(scene_, textured);
    const uint32_t medium = at.material.medium;
    if (medium != 0) at.transmission = transmissionAt(scene_, medium, textured);
    at.crossing = crossingAt(scene_, media, medium, at.entering);
    return at;
}

Ray PathTracer::rayFrom(const Interaction& at, const dvec3& direction, double tMax) {
    Ray ray;
    ray.origin = offsetOrigin(at, direction);
    ray.direction = direction;
    ray.tMax = tMax;
    ray.slips = mover_.slips();
    mover_.move(ray, std::max(at.originScale, at.scale));
    // Rounding never takes the origin through the surface: that is what offsets are for.
    const dvec3 out = glm::dot(direction, at.n) < 0 ? -at.n : at.n;
    const double height = glm::dot(ray.origin - at.position, out);
    if (height < 0) ray.origin -= 2 * height * out;
    ray.origin += mover_.cleared(at.clearance) * out;
    return ray;
}

// Light from the end of a shadow ray: 0 if an opaque surface blocks it, else the product of all transmissions
// and Beer's law in every medium that contains the ray by its count of crossings.
std::optional<RoundedColor> PathTracer::lightThrough(const Ray& ray, const Interaction& at,
                                                     bool directional) {
    const RoundedColor all = roundedColor(dvec3(1), exponentialRoundings(0, 0));
    if (!tracer_.shadows()) return all;
    uint64_t* const tests = countRay(RayClass::Shadow);
    if (!scene_.coloredShadows) {
        const bool occluded = tracer_.occluded(ray, at.source, tests);
        if (occluded && !scene_.instances.empty() && !record_.meetsInstance && mover_.moves()) {
            const std::optional<Hit> hit = tracer_.closest(ray, at.source);
            record_.meetsInstance = hit && hit->instance != shared::kNone;
        }
        if (occluded) return std::nullopt;
        return all;
    }
    std::vector<Hit> hits = tracer_.allHits(ray, at.source, tests);
    // Opaque surfaces block with their edges too.
    for (const Hit& hit : hits)
        if (scene_.materials[tracer_.surfaceAt(ray, hit).material].medium == 0) return std::nullopt;
    std::erase_if(hits, [&](const Hit& hit) { return !tracer_.crosses(ray, hit); });
    dvec3 sigma(0), left(1);
    for (uint32_t medium : at.crossing.before) sigma += attenuationOf(scene_, medium);
    // The media absorb along the way to the surface where each is left, less that to where it is entered. A
    // directional light is outside of all media; others may lie in some, whose sum is sigma at last.
    dvec3 fade(0);
    // Magnitudes of the optical depth, and of the points between its parts, each times its medium's
    // attenuation, and of the sum of attenuations.
    double terms = 0, ends = at.scale * greatestMagnitude(sigma), media = greatestMagnitude(sigma);
    const double length = glm::length(ray.direction);
    bool leaves = false;
    for (size_t i = 0; i < hits.size(); ++i) {
        const Hit& hit = hits[i];
        decide(hit);
        const Surface surface = tracer_.surfaceAt(ray, hit);
        const uint32_t medium = scene_.materials[surface.material].medium;
        left *= transmissionAt(scene_, medium, surface);
        // The same hit twice is a tangent, where rounding decides the cosine's sign.
        const bool again = i > 0 && hit == hits[i - 1];
        leaves = again ? !leaves : glm::dot(surface.geometricNormal, ray.direction) > 0;
        const dvec3 change = (leaves ? -1.0 : 1.0) * attenuationOf(scene_, medium);
        fade -= hit.t * change;
        sigma += change;
        media += greatestMagnitude(change);
        terms += 1 + greatestMagnitude(change) * length * hit.t;
        ends += surface.scale * greatestMagnitude(change);
    }
    if (!directional && greatestMagnitude(sigma) > 0x1p-40 * media) {
        fade += sigma;
        terms += 2 * length * media;  // 16 roundings of the sum
    }
    terms += length * greatestMagnitude(fade);
    return roundedColor(glm::min(left * glm::exp(-length * fade), dvec3(1)),
                        exponentialRoundings(terms, ends));
}

// True if rounding of lookups decides which masks a shadow ray passes. Any part of its light may then arrive.
bool PathTracer::masksDecide(Ray shadow, const Interaction& at, bool directional) {
    if (jitter_.lookup == 0 || !scene_.alphaMask) return false;
    const uint32_t before = record_.decisions;
    shadow.noise.solid = shared::kNone;
    const bool arrives = lightThrough(shadow, at, directional).has_value();
    const uint32_t byHoles = std::exchange(record_.decisions, before);
    shadow.noise.solid = RayNoise::kAll;
    const bool arrivesBySolids = lightThrough(shadow, at, directional).has_value();
    return std::exchange(record_.decisions, before) != byHoles || arrives != arrivesBySolids;
}

// Returns no light if the light is occluded, lies on the surface or shines elsewhere.
RoundedColor PathTracer::shadeLight(const Interaction& at, size_t index, bool first) {
    const rows::Light& light = tracer_.lights()[index];
    const LightSample sample = sampleLight(light, at.position);
    decide(0);
    if (!sample.valid) return {};
    dvec3 seen = sample.direction;
    if (isSpot(light)) mover_.turn(seen, 1);
    const double part = spotFactor(light, seen);
    if (part == 0) return {};
    const double turn = lightTurn(at.scale, sample.distance);
    const Reflection reflection = evaluate(at, sample.direction, turn);
    const dvec3 incoming = intensityAt(light, sample.distance, part);
    if (!reflection.faces) return RoundedColor{incoming} * reflection;
    decide(reflection.highlight ? 2 : 1);
    const double units = kProductRoundings + 2 * turn + spotError(light, sample.direction, part, turn);
    const bool directional = light.kind == shared::kLightDirectional;
    const double end =
        directional ? std::numeric_limits<double>::infinity() : static_cast<double>(shared::kShadowEnd);
    Ray shadow = rayFrom(at, sample.toLight, end);
    const RoundedColor most = roundedColor(incoming, units) * reflection;
    if (masksDecide(shadow, at, directional)) {
        decide(4);
        if (first && index < shared::kShadowBits) record_.shadowBits |= jitter_.hidden & 1u << index;
        return {0.5 * most.value, 0.5 / kFloatUnit * most.value + most.error};
    }
    const auto through = lightThrough(shadow, at, directional);
    if (!through) {
        decide(3);
        if (first && index < shared::kShadowBits) record_.shadowBits |= 1u << index;
        if (keepPath_) record_.path.back().occluded[index] = 1;
        return {};
    }
    return most * *through;
}

RoundedColor PathTracer::shadeLights(const Interaction& at, bool first) {
    RoundedColor sum;
    for (size_t i = 0; i < tracer_.lights().size(); ++i) sum += shadeLight(at, i, first);
    sum.error += static_cast<double>(tracer_.lights().size()) * sum.value;
    return sum;
}

Surface PathTracer::texturedAt(const Hit& hit, const Surface& surface) {
    if (scene_.textures.empty()) return surface;
    if (jitter_.t != 0 && hit.instance == shared::kNone && !hit.isTriangle()) return lookedUpAt(hit);
    Surface moved = surface;
    const double scale = std::max(1.0, std::max(surface.uvScale.x, surface.uvScale.y));
    const double reach = mover_.moves() ? solidReach(scene_, surface) : 0;
    for (int i = 0; i < 2; ++i) moved.uv[i] += mover_.shift(scale);
    for (int i = 0; i < 3; ++i) moved.position[i] += mover_.shift(reach);
    keepWithinImage(scene_, moved);
    return moved;
}

// Most errors are a small part of their bound, where few fp32 numbers lie: half of the seeds stay below 1/16
// of it.
Surface PathTracer::lookedUpAt(const Hit& hit) const {
    Surface seen = tracer_.surfaceAt(unmoved_, hit);
    seen.lookup = jitter_.lookup;
    uint64_t state = jitter_.lookup;
    const double units = kUvRoundings * kFloatUnit * std::pow(uniform(state), 4);
    for (int i = 0; i < 2; ++i) seen.uv[i] += units * std::max(1.0, seen.uvScale[i]) * uniform(state);
    const double reach = solidReach(scene_, seen);
    for (int i = 0; i < 3; ++i) seen.position[i] += units * reach * uniform(state);
    keepWithinImage(scene_, seen);
    return seen;
}

// A throughput is a product of weights, each of them good to 8 roundings.
bool PathTracer::isFollowed(const Branch& next) {
    const double most = contribution(next);
    const bool inDepth = next.depth <= tracer_.environment().maxDepth;
    const double seen = mover_.sway(most, 8.0 * next.depth);
    if (inDepth && !(seen < tracer_.environment().minContribution)) return true;
    (inDepth ? record_.lost.cut : record_.lost.depth).add(1, most);
    return false;
}

// The branch on the outer side comes first.
std::vector<Branch> PathTracer::branchesOf(const Branch& branch, const Interaction& at,
                                           const RoundedColor& throughput) {
    const Scattering s = scatteringAt(scene_, at, at.material.medium == 0 ? 0 : mover_.shift(1));
    std::vector<Branch> next;
    const auto add = [&](RayClass kind, const RoundedColor& weight, const dvec3& direction,
                         const Media& media) {
        Branch b;
        b.kind = kind;
        b.throughput = throughput * weight;
        b.depth = branch.depth + 1;
        b.waiting = branch.waiting;
        if (!isFollowed(b)) return;
        b.ray = rayFrom(at, direction, std::numeric_limits<double>::infinity());
        b.source = at.source;
        b.media = media;
        b.start = at.position;
        b.out = glm::dot(direction, at.n) < 0 ? -at.n : at.n;
        b.clearance = at.clearance;
        b.scale = std::max(at.originScale, at.scale);
        next.push_back(b);
    };
    if (s.reflects) add(RayClass::Mirrored, s.reflectedWeight, s.reflected, at.crossing.before);
    if (s.refracts) add(RayClass::Refracted, s.refractedWeight, s.refracted, at.crossing.after);
    if (next.size() == 2) {
        if (!at.entering) std::swap(next[0], next[1]);
        if (branch.waiting >= shared::kMaxWaiting)
            dropOne(next);
        else
            ++next[0].waiting;
    }
    for (const Branch& b : next) decide(static_cast<uint32_t>(b.kind) + 1);
    return next;
}

std::vector<Branch> PathTracer::visit(const Branch& branch) {
    const rows::Environment& environment = tracer_.environment();
    const Ray& ray = branch.ray;
    const bool first = record_.bounces == 0;
    std::optional<Hit> hit = closest(ray, branch.source, branch.kind);
    if (hit) decide(*hit);
    record_.pathHash = (record_.pathHash ^ (hit ? hit->id + 1 : 0)) * shared::kHashPrime;
    if (keepPath_)
        record_.path.push_back({ray, hit, std::nullopt, std::vector<uint8_t>(tracer_.lights().size()),
                                branch.kind, branch.depth, dvec3(0), branch.throughput.value});
    if (!hit) {
        const double endless = std::numeric_limits<double>::infinity();
        const dvec3 left = transmittance(scene_, rulingMedium(scene_, branch.media), endless);
        const dvec3 seen = surroundings(scene_, environment, ray.direction, mapShift());
        addLight(branch.throughput * RoundedColor{left} * roundedColor(seen, kProductRoundings));
        return {};
    }
    own_.t = hit->t;
    if (jitter_.t != 0) {
        own_.enters = glm::dot(tracer_.surfaceAt(ray, *hit).geometricNormal, ray.direction) < 0;
        decide(own_.enters);
        hit->t = jitter_.t;
    }
    const Surface surface = tracer_.surfaceAt(ray, *hit);
    if (keepPath_) record_.path.back().surface = surface;
    if (first) {
        record_.alpha = 1;
        record_.hit = hit;
        record_.surface = surface;
    }
    const Interaction at = interactionAt(ray, *hit, surface, branch.media);
    decide(at.entering);
    record_.lost.crowdedMedia += at.crossing.crowded ? 1 : 0;
    const double way = hit->t * glm::length(ray.direction);
    RoundedColor left{transmittance(scene_, at.crossing.mediumBefore, way)};
    if (at.crossing.mediumBefore != 0) {
        const dvec3 sigma = attenuationOf(scene_, at.crossing.mediumBefore);
        for (int i = 0; i < 3; ++i)
            left.error[i] = left.value[i] * exponentialRoundings(way * sigma[i], at.scale * sigma[i]);
    }
    const RoundedColor throughput = branch.throughput * left;
    if (at.crossing.counts) {
        RoundedColor light = shadeLights(at, first);
        light += roundedColor(at.material.ambient * environment.ambient, kProductRoundings);
        addLight(throughput * light);
    }
    return branchesOf(branch, at, throughput);
}

void PathTracer::addLight(const RoundedColor& light) {
    record_.color += light.value;
    // Called before the branches of this hit are followed.
    if (keepPath_) record_.path.back().light += light.value;
    record_.rounding += light.error;
    ++contributions_;
}

PixelRecord PathTracer::run(const Ray& cameraRay) {
    Branch branch = tracer_.firstBranch(cameraRay);
    mover_.move(branch.ray, std::max(greatestMagnitude(cameraRay.origin), cameraRay.originScale));
    record_.pathHash = shared::kHashStart;
    follow(branch);
    finishRounding();
    return std::move(record_);
}

Step PathTracer::step(Branch branch) {
    Ray& ray = branch.ray;
    unmoved_ = ray;
    mover_.move(ray, std::max({greatestMagnitude(ray.origin), ray.originScale, branch.scale}));
    if (jitter_.lookup != 0) ray.noise.solid = jitter_.hit;
    const double height = glm::dot(ray.origin - branch.start, branch.out);
    if (height < 0) ray.origin -= 2 * height * branch.out;
    record_.pathHash = shared::kHashStart;
    own_.next = visit(branch);
    finishRounding();
    own_.record = std::move(record_);
    return std::move(own_);
}

}  // namespace

PixelRecord Tracer::trace(const Ray& cameraRay, const Jitter& jitter, bool keepPath) const {
    return PathTracer(*this, jitter, keepPath).run(cameraRay);
}

Step Tracer::step(const Branch& branch, const Jitter& jitter) const {
    return PathTracer(*this, jitter, false).step(branch);
}

Branch Tracer::firstBranch(const Ray& cameraRay) const {
    Branch branch;
    branch.ray = cameraRay;
    branch.media = mediaAtEye(environment_);
    return branch;
}

}  // namespace glint::reference
