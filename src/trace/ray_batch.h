// Rays that the caller brings, in world coordinates, and their hits: app::traceBatch on a device,
// reference::trace in double.
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <string>
#include <vector>

#include "trace/methods.h"
#include "trace/picture.h"

namespace glint {

// The points origin + t direction with tMin < t <= tMax; t = 0 is excluded. A ray that is not finite, or has
// no direction, misses.
struct WorldRay {
    glm::dvec3 origin{0};
    glm::dvec3 direction{0, 0, -1};  // of any length; t is in units of it
    double tMin = 0;
    double tMax = std::numeric_limits<double>::infinity();
};

// Extent of the answer about a hit. The rest is neither computed nor read back.
enum class HitDetail {
    Any,      // whether anything is hit: WorldHit::hit alone
    Nearest,  // the closest hit: t and `packed`
    Surface   // everything
};

struct RayBatch {
    std::vector<WorldRay> rays;
    HitDetail detail = HitDetail::Surface;
    Methods methods;  // see Tracing::methods
};

// On a miss all but `hit` and `cost` are as they are here.
struct WorldHit {
    bool hit = false;
    double t = std::numeric_limits<double>::infinity();
    double u = 0, v = 0;   // triangle: the point is (1 - u - v) a + u b + v c
    glm::dvec3 point{0};   // world
    glm::dvec3 normal{0};  // geometric, outward, unit
    uint32_t object = PixelData::kNoIndex;
    uint32_t face = PixelData::kNoIndex;  // of the object, in the file's order
    uint32_t material = PixelData::kNoIndex;
    uint32_t packed = PixelData::kNoIndex;  // the primitive's kind and index, as in shared/layout.h
    uint64_t cost = 0;                      // boxes and primitives tested, of the reference
};

// Seconds for finding hits, without preparing rays, compiling kernels or the surfaces of HitDetail::Surface.
// `processor`: of all threads of the process, the measure that other processes disturb least.
struct BatchTimes {
    double wall = 0, processor = 0;
};

// A ray as tracers follow it: relative to the scene's origin, which is subtracted in double before rounding,
// and with a direction whose square neither overflows nor vanishes in fp32.
struct LocalRay {
    glm::dvec3 origin{0};
    glm::dvec3 direction{0};
    double tMin = 0, tMax = 0;
    int exponent = 0;  // the direction is 2^-exponent times the caller's, exactly

    double worldT(double t) const;  // in units of the caller's direction
};
LocalRay rescaledRay(const LocalRay& ray, double greatest);

// Least value of a direction's largest component. For shorter directions t would exceed double; such rays
// miss.
inline constexpr double kShortestDirection = 1e-290;

// Squares of directions far from unit length overflow or vanish, in fp32 at 2^64 already: they are rescaled
// where their greatest component is not harmless.
inline bool isHarmless(double greatest) {
    return greatest >= 0x1p-32 && greatest < 0x1p33;
}
inline LocalRay localRay(const WorldRay& ray, const glm::dvec3& sceneOrigin) {
    const LocalRay local = {ray.origin - sceneOrigin, ray.direction, ray.tMin, ray.tMax};
    const glm::dvec3 size = glm::abs(ray.direction);
    const double greatest = std::max(std::max(size.x, size.y), size.z);
    return isHarmless(greatest) ? local : rescaledRay(local, greatest);
}

// The lines of `glint trace`: a heading, and a hit with so many significant digits, or with `anyOnly` no more
// than whether there is one.
inline constexpr const char* kHitCsvHeading = "hit,t,u,v,object,primitive,px,py,pz,nx,ny,nz\n";
inline constexpr int kDeviceDigits = 9, kReferenceDigits = 17;  // enough to distinguish all numbers of each
std::string hitCsv(const WorldHit& hit, int digits, bool anyOnly = false);

// The hit of a pixel's first sample.
WorldHit hitOf(const PixelData& data);

}  // namespace glint
