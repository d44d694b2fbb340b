// Whitted's shading (docs/reference/shading.md; T. Whitted, "An Improved Illumination Model for Shaded
// Display", CACM 23(6), 1980; J. Blinn, "Models of Light Reflection for Computer Synthesized Pictures",
// SIGGRAPH 1977).
#include <algorithm>
#include <cmath>
#include <utility>

#include "reference/instance.h"
#include "reference/intersect.h"
#include "reference/material.h"
#include "reference/optics.h"
#include "reference/primitives.h"
#include "reference/quadric.h"
#include "reference/ray_mover.h"
#include "reference/rounding.h"
#include "reference/tracer.h"

namespace glint::reference {
namespace {

using glm::dvec3;

constexpr double kPointLightEnd = 1 - 0x1p-16;  // a shadow ray stops short of the surface a light lies on
constexpr double kLightTooClose = 1e-15;
constexpr double kFloatUnit = 0x1p-24;  // of fp32; kUnitRoundoff is that of double
uint32_t kindOf(uint32_t primitive) {
    return primitive >> shared::kPrimitiveKindShift;
}
uint32_t indexOf(uint32_t primitive) {
    return primitive & shared::kPrimitiveIndexMask;
}

constexpr uint32_t kHashStart = 2166136261u, kHashPrime = 16777619u;  // FNV-1a, 32 bits

double greatestCoordinate(const dvec3& v) {
    return std::max(std::max(std::abs(v.x), std::abs(v.y)), std::abs(v.z));
}

// The greatest magnitude among the coordinates that the hit point is computed from.
double geometryScale(const PackedScene& scene, const Methods& methods, const Hit& hit) {
    const double own = visitHit(scene, hit.primitive,
                                [&](const auto& primitive) { return reachOf(scene, methods, primitive); });
    if (hit.instance == shared::kNone) return own;
    return InstanceFrame(scene.instances[hit.instance]).scaleInWorld(own);
}

// One camera ray followed to its end.
class PathTracer {
  public:
    PathTracer(const Tracer& tracer, const PackedScene& scene, const Jitter& jitter, bool keepPath)
        : tracer_(tracer), scene_(scene), mover_(jitter), keepPath_(keepPath) {}

    PixelRecord run(const Ray& cameraRay);

  private:
    // A hit as shading sees it: normals turned against the ray.
    struct Site {
        Source source;
        dvec3 position;
        dvec3 n, s;          // geometric and shading normal, unit
        dvec3 view;          // towards where the ray came from, unit
        double originScale;  // greatest coordinate of the ray's origin
        double scale;        // greatest number that a coordinate of the position is a sum of
        double offset;       // bound on the error of `position` along n
        double normalError;  // see rounding.h
        bool entering;       // the ray comes from the outer side
    };

    // A ray of the tree and what is known of its way.
    struct Branch {
        Ray ray;
        Source source;
        dvec3 throughput{1};
        dvec3 slack{0};  // of the throughput, see rounding.h
        RayClass kind = RayClass::Primary;
        uint32_t depth = 0;    // rays before it
        uint32_t waiting = 0;  // branches that are followed only after all that comes of this one
        Media media;
    };

    // Light, and what rounding may add to it, see rounding.h.
    struct Light {
        dvec3 radiance{0}, error{0};
    };
    // What is left of a light behind what it shines through; `fade`: the sum of the magnitudes that its
    // optical depth is made of.
    struct Passed {
        dvec3 part{1};
        double fade = 0;
    };

    std::optional<Hit> closest(const Ray& ray, const Source& source, RayClass kind);
    bool isTied(const Hit& hit, const Hit& other) const;
    void decide(uint32_t word) { record_.decisions = (record_.decisions ^ word) * kHashPrime; }
    void decide(const Hit& hit);
    void decideCells(const Surface& textured);
    void addLight(const dvec3& throughput, const dvec3& slack, const Light& light);
    void count(RayClass kind, uint64_t costBefore);
    Site siteOf(const Ray& ray, const Hit& hit, const Surface& surface) const;
    Ray rayFrom(const Site& site, const dvec3& direction, double tMax);
    double spotFactor(const shared::Light& light, dvec3 toLight);
    Light shadeLights(const Site& site, const shared::Material& material, const Media& media, bool first);
    std::optional<Passed> lightThrough(const Ray& ray, const Site& site, const Media& media,
                                       bool directional);
    Light reflected(const Site& site, const shared::Material& material, const shared::Light& light,
                    const dvec3& l, double distance, double part);
    dvec3 reflect(const Site& site) const;
    void follow(Branch branch);
    void followOn(const Branch& branch, const Site& site, const Surface& textured,
                  const shared::Material& material, const Passing& passing, const dvec3& throughput,
                  const dvec3& slack);
    bool isFollowed(const Branch& next);
    double contribution(const Branch& next) const;
    // The surface as textures see it, and the environment map's coordinates, moved by rounding.
    Surface texturedAt(const Hit& hit, const Surface& surface);
    glm::dvec2 mapShift();

    const Tracer& tracer_;
    const PackedScene& scene_;
    RayMover mover_;
    bool keepPath_;
    PixelRecord record_;
    uint32_t contributions_ = 0;
};

void PathTracer::count(RayClass kind, uint64_t costBefore) {
    RayTally& tally = record_.tally[static_cast<size_t>(kind)];
    ++tally.rays;
    tally.tests += record_.cost - costBefore;
}

void PathTracer::decide(const Hit& hit) {
    decide(hit.primitive);
    decide(hit.instance);
    record_.meetsInstance = record_.meetsInstance || hit.instance != shared::kNone;
}

// Of what changes in steps, not continuously.
void PathTracer::decideCells(const Surface& textured) {
    if (!scene_.textures.empty()) decide(cellsAt(scene_, textured));
}

// False where both have the same numbers in the same order: then fp32 gives the same t, and the rule for
// equal t says which is first.
bool PathTracer::isTied(const Hit& hit, const Hit& other) const {
    if (kindOf(hit.primitive) != kindOf(other.primitive)) return true;
    if (hit.instance != other.instance) return true;
    const uint32_t a = indexOf(hit.primitive), b = indexOf(other.primitive);
    switch (kindOf(hit.primitive)) {
        case shared::kKindTriangle: {
            const shared::Triangle &s = scene_.triangles[a], &t = scene_.triangles[b];
            return !(s.v0 == t.v0 && s.v1 == t.v1 && s.v2 == t.v2);
        }
        case shared::kKindSphere: {
            const shared::Sphere &s = scene_.spheres[a], &t = scene_.spheres[b];
            return !(s.point == t.point && s.radius == t.radius && s.anchorNormal == t.anchorNormal);
        }
        case shared::kKindPlane: {
            const shared::Plane &s = scene_.planes[a], &t = scene_.planes[b];
            return !(s.point == t.point && s.normal == t.normal);
        }
        case shared::kKindDisc: {
            const shared::Disc &s = scene_.discs[a], &t = scene_.discs[b];
            return !(s.center == t.center && s.normal == t.normal && s.radius == t.radius);
        }
        default:
            return true;
    }
}

// Under jitter, which of two primitives at one t comes first is open too: coincident surfaces tie for every
// moved ray, and double always breaks the tie in the same way.
std::optional<Hit> PathTracer::closest(const Ray& ray, const Source& source, RayClass kind) {
    const uint64_t before = record_.cost;
    const std::optional<Hit> hit = tracer_.closest(ray, source, &record_.cost);
    count(kind, before);
    if (!hit || mover_.tieWidth() == 0 || !mover_.coin()) return hit;
    Ray narrow = ray;
    narrow.tMin = std::max(ray.tMin, hit->t * (1 - mover_.tieWidth()));
    narrow.tMax = std::min(ray.tMax, hit->t * (1 + mover_.tieWidth()));
    const std::optional<Hit> other = tracer_.closest(narrow, sourceOf(*hit));
    return other && isTied(*hit, *other) ? other : hit;
}

PathTracer::Site PathTracer::siteOf(const Ray& ray, const Hit& hit, const Surface& surface) const {
    Site site;
    const dvec3 d = glm::normalize(ray.direction);
    const double side = glm::dot(surface.geometricNormal, d) > 0 ? -1 : 1;
    site.source = sourceOf(hit);
    site.position = surface.position;
    site.entering = side > 0;
    site.n = side * surface.geometricNormal;
    site.s = side * surface.shadingNormal;
    site.view = -d;
    site.originScale = std::max(greatestCoordinate(ray.origin), ray.originScale);
    // Each coordinate of the position is a sum of products of numbers no greater than `scale`, or a point
    // moved onto its primitive, and errs by at most 9 u scale (weights 2 u, products and sums 7 u for a
    // triangle; less for the others): 16 u scale along n. Twice that, as the origin of the next ray is
    // rounded again.
    const double scale =
        std::max(greatestCoordinate(site.position), geometryScale(scene_, tracer_.methods(), hit));
    // An instance's transform there and back makes more of each rounding.
    const double gain = hit.instance == shared::kNone ? 1 : 1 + scene_.instanceGain;
    site.scale = scale;
    site.normalError = normalError(surface.bend, site.originScale + scale, gain - 1);
    site.offset = 32 * kUnitRoundoff * scale * gain;
    return site;
}

Ray PathTracer::rayFrom(const Site& site, const dvec3& direction, double tMax) {
    Ray ray;
    // Off the surface, to the side it leaves to: through it where it points against n.
    ray.origin = site.position + (glm::dot(direction, site.n) < 0 ? -site.offset : site.offset) * site.n;
    ray.direction = direction;
    ray.tMax = tMax;
    mover_.move(ray, std::max(site.originScale, site.scale));
    return ray;
}

bool isSpot(const shared::Light& light) {
    return light.kind == shared::kLightSpot || light.kind == shared::kLightSpotInverseSquare;
}

double falloffDivisor(const shared::Light& light, double distance) {
    const bool fades =
        light.kind == shared::kLightPointInverseSquare || light.kind == shared::kLightSpotInverseSquare;
    return fades ? distance * distance : 1;
}

// smoothstep(cos(angle + penumbra), cos(angle), c), c the cosine at the light between its axis and the way to
// the surface; without a penumbra a step.
double PathTracer::spotFactor(const shared::Light& light, dvec3 toLight) {
    mover_.turn(toLight, 1);
    const double c = -glm::dot(glm::normalize(dvec3(light.axis)), glm::normalize(toLight));
    const double full = 1 - static_cast<double>(light.inner), none = 1 - static_cast<double>(light.outer);
    if (c >= full || full <= -1) return 1;  // a cone of 180 degrees is everything
    if (c <= none) return 0;
    const double x = (c - none) / (full - none);
    return (3 - 2 * x) * x * x;
}

// What comes through of the light at the end of a shadow ray: nothing if an opaque surface is in the way,
// else the product of the transmissions of all surfaces there, and Beer's law on the way between them, in
// every medium that the ray is inside of by its count of crossings.
std::optional<PathTracer::Passed> PathTracer::lightThrough(const Ray& ray, const Site& site,
                                                           const Media& media, bool directional) {
    if (!tracer_.shadows()) return Passed();
    const uint64_t before = record_.cost;
    if (!scene_.features.coloredShadows) {
        const bool occluded = tracer_.occluded(ray, site.source, &record_.cost);
        count(RayClass::Shadow, before);
        if (occluded && !scene_.instances.empty() && !record_.meetsInstance && mover_.tieWidth() > 0) {
            const std::optional<Hit> hit = tracer_.closest(ray, site.source);
            record_.meetsInstance = hit && hit->instance != shared::kNone;
        }
        if (occluded) return std::nullopt;
        return Passed();
    }
    std::vector<Hit> hits = tracer_.allHits(ray, site.source, &record_.cost);
    count(RayClass::Shadow, before);
    dvec3 left(1), sigma(0), fade(0);
    for (uint32_t medium : media) sigma += attenuationOf(scene_, medium);
    std::vector<dvec3> change;
    // What is opaque blocks with its edges too.
    for (const Hit& hit : hits)
        if (scene_.materials[tracer_.surface(ray, hit).material].medium == 0) return std::nullopt;
    std::erase_if(hits, [&](const Hit& hit) { return !tracer_.crosses(ray, hit); });
    for (const Hit& hit : hits) {
        decide(hit);
        const Surface surface = tracer_.surface(ray, hit);
        const uint32_t medium = scene_.materials[surface.material].medium;
        left *= transmissionAt(scene_, medium, surface);
        const bool leaves = glm::dot(surface.geometricNormal, ray.direction) > 0;
        change.push_back((leaves ? -1.0 : 1.0) * attenuationOf(scene_, medium));
    }
    if (directional) {
        // Infinitely far away there is no medium, so what the ray starts in is what it leaves.
        sigma = dvec3(0);
        for (const dvec3& c : change) sigma -= c;
    }
    double from = 0, terms = 0;
    const double length = glm::length(ray.direction);
    for (size_t i = 0; i < hits.size(); ++i) {
        terms += 1 + greatestCoordinate(change[i]) * length * std::max(hits[i].t, std::abs(1 - hits[i].t));
        fade += (hits[i].t - from) * sigma;
        sigma += change[i];
        from = hits[i].t;
    }
    if (!directional) fade += (1 - from) * sigma;
    terms += length * greatestCoordinate(fade);
    return Passed{glm::min(left * glm::exp(-length * fade), dvec3(1)), terms};
}

// Lambert's and Blinn's terms, without shadow. Where the light's cosine is too small for its sign to be
// known, the error is all that the light could bring.
PathTracer::Light PathTracer::reflected(const Site& site, const shared::Material& material,
                                        const shared::Light& light, const dvec3& l, double distance,
                                        double part) {
    const bool directional = light.kind == shared::kLightDirectional;
    const double turn =
        lightTurn(site.scale, directional ? std::numeric_limits<double>::infinity() : distance);
    const double cosine = glm::dot(site.s, l), slip = cosineError(turn, site.normalError);
    const double least = std::min(cosine, glm::dot(site.n, l));
    if (least <= -slip * kFloatUnit) return {};
    const dvec3 incoming = part / falloffDivisor(light, distance) * dvec3(light.intensity);
    const dvec3 middle = l + site.view;
    const double length = glm::length(middle);
    const double highlight = length > 0 ? glm::dot(site.s, middle) / length : 0;
    Light result;
    dvec3 specular(0);
    if (highlight > 0) {
        const double n = material.shininess, power = std::pow(highlight, n);
        specular = power * dvec3(material.specular);
        result.error =
            powerError(highlight, n, power, length, turn, site.normalError) * dvec3(material.specular);
    }
    if (!(least > 0)) {
        result.error = incoming * (slip * dvec3(material.diffuse) + 0x1p24 * specular);
        return result;
    }
    decide(highlight > 0 ? 2 : 1);
    const dvec3 factor = cosine * dvec3(material.diffuse) + specular;
    if (least < slip * kFloatUnit) result.error += 0x1p24 * specular;
    result.radiance = incoming * factor;
    result.error = incoming * (result.error + slip * dvec3(material.diffuse)) +
                   (kProductRoundings + 2 * turn) * result.radiance;
    if (part < 1) {
        // 1 - cos of an angle a errs by a times what the directions are off, the smoothstep by 3/2 of that
        // over the width of the penumbra.
        const double cone = 1 + glm::dot(glm::normalize(dvec3(light.axis)), l);
        const double width = std::max(static_cast<double>(light.outer - light.inner), 1e-30);
        const double blur = 1.5 * (std::sqrt(2 * cone) * (turn + 4) + 4 * cone) / width;
        result.error += std::min(blur, 0x1p24) / part * result.radiance;
    }
    return result;
}

PathTracer::Light PathTracer::shadeLights(const Site& site, const shared::Material& material,
                                          const Media& media, bool first) {
    Light sum;
    for (size_t i = 0; i < tracer_.lights().size(); ++i) {
        const shared::Light& light = tracer_.lights()[i];
        const bool directional = light.kind == shared::kLightDirectional;
        const dvec3 toLight = directional ? dvec3(light.position) : dvec3(light.position) - site.position;
        const double distance = glm::length(toLight);
        decide(0);
        if (!directional && distance < kLightTooClose) continue;
        const dvec3 l = toLight / distance;
        const double part = isSpot(light) ? spotFactor(light, l) : 1;
        if (part == 0) continue;
        const Light one = reflected(site, material, light, l, distance, part);
        if (!(glm::dot(site.n, l) > 0 && glm::dot(site.s, l) > 0)) {
            sum.error += one.error;
            continue;
        }
        const double end = directional ? std::numeric_limits<double>::infinity() : kPointLightEnd;
        const std::optional<Passed> through =
            lightThrough(rayFrom(site, toLight, end), site, media, directional);
        if (!through) {
            decide(3);
            if (first && i < 32) record_.shadowBits |= 1u << i;
            if (keepPath_) record_.path.back().occluded[i] = 1;
            continue;
        }
        sum.radiance += through->part * one.radiance;
        sum.error += through->part * (one.error + exponentialRoundings(through->fade) * one.radiance);
    }
    sum.error += static_cast<double>(tracer_.lights().size()) * sum.radiance;
    return sum;
}

dvec3 PathTracer::reflect(const Site& site) const {
    const dvec3 d = -site.view;
    dvec3 r = d - 2 * glm::dot(d, site.s) * site.s;
    if (glm::dot(r, site.n) <= 0) r = d - 2 * glm::dot(d, site.n) * site.n;
    return glm::normalize(r);
}

Surface PathTracer::texturedAt(const Hit& hit, const Surface& surface) {
    if (scene_.textures.empty()) return surface;
    Surface moved = surface;
    const double scale = std::max({1.0, std::abs(surface.uv.x), std::abs(surface.uv.y)});
    const double reach =
        std::max(greatestCoordinate(surface.position), geometryScale(scene_, tracer_.methods(), hit));
    for (int i = 0; i < 2; ++i) moved.uv[i] += mover_.shift(scale);
    for (int i = 0; i < 3; ++i) moved.position[i] += mover_.shift(reach);
    keepHeight(scene_, moved);
    return moved;
}

glm::dvec2 PathTracer::mapShift() {
    if (tracer_.environment().map == 0) return glm::dvec2(0);
    const double u = mover_.shift(1);
    return {u, mover_.shift(1)};
}

double PathTracer::contribution(const Branch& next) const {
    const dvec3& t = next.throughput;
    return std::max({t.x, t.y, t.z}) * static_cast<double>(tracer_.environment().radianceBound);
}

// A throughput is a product of weights, each of them good to 8 roundings.
bool PathTracer::isFollowed(const Branch& next) {
    const double most = contribution(next);
    const bool inDepth = next.depth <= tracer_.environment().maxDepth;
    const double seen = mover_.sway(most, 8.0 * next.depth);
    if (inDepth && !(seen < static_cast<double>(tracer_.environment().minContribution))) return true;
    Lost& lost = inDepth ? record_.lost.cut : record_.lost.depth;
    ++lost.count;
    lost.bound += most;
    return false;
}

// The branches of a surface: reflected, and for a dielectric refracted, or straight on where the surface does
// not count. The one on the outer side comes first.
void PathTracer::followOn(const Branch& branch, const Site& site, const Surface& textured,
                          const shared::Material& material, const Passing& passing, const dvec3& throughput,
                          const dvec3& slack) {
    const bool dielectric = material.medium != 0;
    const double ratio = iorOf(scene_, passing.mediumBefore) / iorOf(scene_, passing.mediumAfter);
    const dvec3 d = -site.view;
    std::vector<Branch> next;
    double fresnelError = 0;
    const auto add = [&](RayClass kind, const dvec3& weight, const dvec3& direction, const Media& media) {
        Branch b;
        b.kind = kind;
        b.throughput = throughput * weight;
        b.slack = slack * weight + throughput * (kProductRoundings * weight + fresnelError);
        b.depth = branch.depth + 1;
        if (!isFollowed(b)) return;
        b.ray = rayFrom(site, direction, std::numeric_limits<double>::infinity());
        b.source = site.source;
        b.media = media;
        next.push_back(b);
    };
    Interface interface;
    interface.refracted = d;
    const bool splits = dielectric && passing.real && ratio != 1;
    if (splits) interface = meetInterface(d, site.n, site.s, ratio);
    if (splits && !interface.total) fresnelError = kReflectanceError;
    if (passing.real && (splits || material.mirror != glm::vec3(0)))
        add(RayClass::Mirrored, glm::min(dvec3(material.mirror) + interface.reflectance, dvec3(1)),
            splits ? interface.reflected : reflect(site), passing.before);
    if (dielectric && !interface.total) {
        const dvec3 part = passing.real ? transmissionAt(scene_, material.medium, textured) : dvec3(1);
        add(RayClass::Refracted, (1 - interface.reflectance) * part, interface.refracted, passing.after);
    }
    for (Branch& b : next) b.waiting = branch.waiting;
    if (next.size() == 2) {
        if (!site.entering) std::swap(next[0], next[1]);
        if (branch.waiting >= shared::kMaxWaiting) {
            const bool keepSecond = contribution(next[1]) > contribution(next[0]);
            ++record_.lost.room.count;
            record_.lost.room.bound += contribution(next[keepSecond ? 0 : 1]);
            next.erase(next.begin() + (keepSecond ? 0 : 1));
        } else {
            ++next[0].waiting;
        }
    }
    for (Branch& b : next) {
        ++record_.bounces;
        follow(std::move(b));
    }
}

void PathTracer::follow(Branch branch) {
    const shared::Environment& environment = tracer_.environment();
    const Ray& ray = branch.ray;
    const bool first = record_.bounces == 0;
    const std::optional<Hit> hit = closest(ray, branch.source, branch.kind);
    if (hit) decide(*hit);
    record_.pathHash = (record_.pathHash ^ (hit ? hit->id + 1 : 0)) * kHashPrime;
    if (keepPath_)
        record_.path.push_back({ray, hit, std::nullopt, std::vector<uint8_t>(tracer_.lights().size())});
    if (!hit) {
        const double endless = std::numeric_limits<double>::infinity();
        const dvec3 left = beer(scene_, rulingMedium(scene_, branch.media), endless);
        const dvec3 seen = surroundings(scene_, tracer_.environment(), ray.direction, mapShift());
        addLight(branch.throughput * left, branch.slack * left, {seen, kProductRoundings * seen});
        return;
    }
    const Surface surface = tracer_.surface(ray, *hit);
    if (keepPath_) record_.path.back().surface = surface;
    if (first) {
        record_.alpha = 1;
        record_.hit = hit;
        record_.surface = surface;
    }
    const Surface textured = texturedAt(*hit, surface);
    const shared::Material material = materialAt(scene_, textured);
    const Site site = siteOf(ray, *hit, surface);
    const Passing passing = passingAt(scene_, branch.media, material.medium, site.entering);
    record_.lost.crowdedMedia += passing.crowded ? 1 : 0;
    const double way = hit->t * glm::length(ray.direction);
    const dvec3 left = beer(scene_, passing.mediumBefore, way);
    const dvec3 throughput = branch.throughput * left;
    dvec3 slack = branch.slack * left;
    if (passing.mediumBefore != 0) {
        const dvec3 depth = way * attenuationOf(scene_, passing.mediumBefore);
        for (int i = 0; i < 3; ++i) slack[i] += throughput[i] * exponentialRoundings(depth[i]);
    }
    decideCells(textured);
    if (passing.real) {
        const dvec3 ambient = dvec3(material.ambient) * dvec3(environment.ambient);
        Light light = shadeLights(site, material, passing.before, first);
        light.radiance += ambient;
        light.error += kProductRoundings * ambient;
        addLight(throughput, slack, light);
    }
    followOn(branch, site, textured, material, passing, throughput, slack);
}

void PathTracer::addLight(const dvec3& throughput, const dvec3& slack, const Light& light) {
    record_.color += throughput * light.radiance;
    record_.rounding += throughput * light.error + slack * light.radiance;
    ++contributions_;
}

PixelRecord PathTracer::run(const Ray& cameraRay) {
    Branch branch;
    branch.ray = cameraRay;
    branch.media = mediaAtEye(tracer_.environment());
    mover_.move(branch.ray, std::max(greatestCoordinate(cameraRay.origin), cameraRay.originScale));
    record_.pathHash = kHashStart;
    follow(std::move(branch));
    // Each contribution is added with a rounding of the sum so far.
    record_.rounding += static_cast<double>(contributions_) * record_.color;
    record_.rounding *= kFloatUnit;
    return std::move(record_);
}

}  // namespace

Ray Tracer::cameraRay(const shared::Camera& camera, double x, double y, const glm::dvec2& lens) const {
    // From the middle of the film.
    const double right = x - camera.halfWidth, down = y - camera.halfHeight;
    const auto reach = [&](const glm::vec3& middle, const glm::vec3& stepX, const glm::vec3& stepY) {
        return greatestCoordinate(glm::abs(dvec3(middle)) + glm::abs(right * dvec3(stepX)) +
                                  glm::abs(down * dvec3(stepY)));
    };
    const dvec3 direction = dvec3(camera.center) + right * dvec3(camera.stepX) + down * dvec3(camera.stepY);
    Ray ray;
    ray.origin = dvec3(camera.eye) + right * dvec3(camera.originStepX) + down * dvec3(camera.originStepY);
    ray.direction = glm::normalize(direction);
    ray.originScale = reach(camera.eye, camera.originStepX, camera.originStepY);
    ray.directionScale =
        std::max(1.0, reach(camera.center, camera.stepX, camera.stepY) / glm::length(direction));
    if (camera.inverseFocus != 0) {
        const dvec3 aside = lens.x * dvec3(camera.lensX) + lens.y * dvec3(camera.lensY);
        const double focus = 1 / static_cast<double>(camera.inverseFocus);
        const dvec3 pinhole = ray.origin;
        ray.origin += aside;
        ray.direction = glm::normalize(pinhole + focus * direction - ray.origin);
        // Twice a pinhole's roundings (explain.cpp): those of the lens point and its way to the focus.
        const double radius = glm::length(dvec3(camera.lensX));
        ray.originScale = 2 * (ray.originScale + radius);
        const double reached = glm::length(direction - aside / focus);
        ray.directionScale =
            2 * std::max(1.0, (reach(camera.center, camera.stepX, camera.stepY) + radius / focus) / reached);
    }
    ray.tMin = camera.nearT;
    if (camera.farT < shared::kInfinity) ray.tMax = camera.farT;
    return ray;
}

PixelRecord Tracer::trace(const Ray& cameraRay, const Jitter& jitter, bool keepPath) const {
    return PathTracer(*this, scene_, jitter, keepPath).run(cameraRay);
}

}  // namespace glint::reference
