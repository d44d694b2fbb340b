// Rays that the host brings instead of a camera, as the kernels read them, and what they hit.
#pragma once

#include <algorithm>
#include <cstddef>
#include <glm/glm.hpp>

#include "shared/layout.h"
#include "trace/picture.h"
#include "trace/ray_batch.h"

namespace glint::render {

// A ray as the kernels read it: local and fp32. Nothing is done to it on the way.
struct RayInput {
    glm::vec3 origin{0};
    glm::vec3 direction{0, 0, -1};
    float tMin = 0;
    float tMax = shared::kInfinity;
};

struct RayHit {
    bool hit = false;
    float t = 0;
    uint32_t kindAndIndex = shared::kNone;
    PixelData data;
};

// Rays that are read, written and put in order at a time.
inline constexpr size_t kRayBlock = 1024;

// The ray as the kernels read it. t that fp32 cannot hold becomes kInfinity; NaN stays NaN and misses. tMin
// is clamped to 0: kernels may otherwise report hits behind the origin.
inline RayInput roundedRay(const LocalRay& ray) {
    const auto bound = [](double t) {
        constexpr double kLimit = static_cast<double>(shared::kInfinity);
        return static_cast<float>(std::clamp(t, -kLimit, kLimit));
    };
    return {glm::vec3(ray.origin), glm::vec3(ray.direction), std::max(bound(ray.tMin), 0.0f),
            bound(ray.tMax)};
}

}  // namespace glint::render
