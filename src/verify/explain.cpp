#include "verify/explain.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace glint::verify {

namespace {

constexpr double kUnit = 0x1p-24;
constexpr int kJittersPerLevel = 64;
// A textbook's sphere test takes rays for hits that pass far outside: few jitters meet the limb as it saw it.
constexpr int kJittersOfTextbooks = 1024;

double maxComponent(const glm::dvec3& v) {
    return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

double colorDifference(const glm::dvec3& a, const glm::vec3& b) {
    const glm::dvec3 d = glm::abs(a - glm::dvec3(b));
    return std::max({d.x, d.y, d.z});
}

// Smallest box of colours seen.
struct ColorHull {
    glm::dvec3 lo, hi;
    void include(const glm::dvec3& c) {
        lo = glm::min(lo, c);
        hi = glm::max(hi, c);
    }
    bool contains(const glm::vec3& c, double tolerance) const {
        const glm::dvec3 p(c);
        return glm::all(glm::greaterThanEqual(p, lo - tolerance)) &&
               glm::all(glm::lessThanEqual(p, hi + tolerance));
    }
};

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
// small as what happened, and the bound of a textbook's sphere test goes up to 1e7.
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
// - a textbook's sphere test: w.w - r^2, or w.w less the square of the way along the ray, errs by 4 units of
//   w.w, as if the ray passed the centre by 2 |w|^2 / r units more or less: 2 |w|^2 / (r t), |w| at most
//   twice the greater of the extent and r.
double roundingBound(const PackedScene& scene, const reference::PixelRecord& record, const PixelData& device,
                     const Methods& methods) {
    double extent = std::max(maxComponent(scene.boundsLo), maxComponent(scene.boundsHi));
    double shortest =
        device.object != PixelData::kNoIndex ? device.depth : std::numeric_limits<double>::infinity();
    for (const reference::Bounce& bounce : record.path) {
        extent = std::max({extent, maxComponent(bounce.ray.origin), bounce.ray.originScale});
        if (bounce.surface) extent = std::max(extent, maxComponent(bounce.surface->position));
        if (bounce.hit) shortest = std::min(shortest, bounce.hit->t);
    }
    if (!std::isfinite(shortest) || shortest <= 0) return 8;
    double bound = 8 + (10 * 2 + 14) * extent / shortest;
    if (scene.features.instances)
        bound = 8 + (10 * 2 + 14 + 2 * 10) * std::max(scene.instanceGain, 1.0) * extent / shortest;
    if (methods.spheres == SphereMethod::Robust) return bound;
    for (const shared::Sphere& sphere : scene.spheres) {
        const double radius = sphere.radius, far = 2 * std::max(extent, radius);
        bound = std::max(bound, 2 * far * far / (radius * shortest));
    }
    return bound;
}

void explain(const reference::Tracer& tracer, const reference::Ray& cameraRay, const PackedScene& scene,
             double tolerance, DifferingPixel& pixel) {
    const double bound = roundingBound(scene, pixel.reference, pixel.device, tracer.methods());
    ColorHull hull = {pixel.reference.color, pixel.reference.color};
    const int jitters =
        tracer.methods().spheres == SphereMethod::Robust ? kJittersPerLevel : kJittersOfTextbooks;
    bool changed = false;
    uint64_t seed = 1;
    for (const double ulps : levelsTo(bound)) {
        for (int i = 0; i < jitters; ++i) {
            const reference::PixelRecord moved = tracer.trace(cameraRay, {seed++, ulps}, false);
            hull.include(moved.color);
            changed = changed || moved.pathHash != pixel.reference.pathHash ||
                      colorDifference(moved.color, glm::vec3(pixel.reference.color)) > tolerance;
            const bool same = moved.pathHash == pixel.device.pathHash &&
                              colorDifference(moved.color, pixel.deviceColor) <= tolerance;
            // The reference hangs on rounding here, and the device's colour is among those it can take.
            const bool between = changed && hull.contains(pixel.deviceColor, tolerance);
            if (same || (i == jitters - 1 && between)) {
                pixel.reason = isTie(pixel) ? Reason::Tie : Reason::Edge;
                pixel.ulps = ulps;
                return;
            }
        }
    }
    pixel.reason = Reason::Unexplained;
    pixel.ulps = bound;
}

}  // namespace glint::verify
