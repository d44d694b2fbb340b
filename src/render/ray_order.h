// A caller's rays as the kernels read them, and their order on the device. Similar rays side by side make the
// lanes coherent; the order does not affect answers.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <memory>
#include <span>

#include "core/context.h"
#include "core/device_layout.h"
#include "trace/ray_batch.h"

namespace glint::render {

// A ray as the kernels read it: local and fp32.
struct RayInput {
    glm::vec3 origin{0};
    glm::vec3 direction{0, 0, -1};
    float tMin = 0;
    float tMax = shared::kInfinity;
};

// Rays that callbacks receive at a time.
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

// The numbers of consecutive rays on the device in the caller's batch.
struct RayNumbers {
    uint64_t first = 0;
    const uint32_t* order = nullptr;  // counted from `first`; null: the caller's order
    // Each run of this many rays of `order`, from its beginning, is consecutive in the caller's order.
    size_t run = 1;

    uint64_t operator[](size_t i) const { return first + (order != nullptr ? order[i] : i); }
    RayNumbers from(size_t i) const {
        if (order == nullptr) return {first + i, nullptr, 1};
        return {first, order + i, i % run == 0 ? run : 1};
    }
};
using ReadRays = std::function<void(const RayNumbers&, std::span<RayInput>)>;

struct RayOrder {
    size_t count = 0;       // of leading rays that it covers
    bool coherent = false;  // packets are faster
    // A permutation of the rays; null: the caller's order. Not a vector, which one thread would zero first.
    std::unique_ptr<uint32_t[]> numbers;
    size_t run = 1;  // RayNumbers::run

    const uint32_t* data() const { return numbers.get(); }
    RayNumbers from(uint64_t first) const { return {first, data(), run}; }
};

struct Space {
    glm::vec3 lower{0}, upper{0};
};

// Order of rays `first` to `first + count - 1`, or of a leading part of them. Rows of an image become blocks
// of 8 x 4, which packets trace. Incoherent rays are sorted by the cells in which they enter and leave the
// space. told: the caller declares the rays coherent. Reads from several threads.
RayOrder orderRays(const ReadRays& read, uint64_t first, size_t count, const Space& space, bool told,
                   const Context& context = {});

}  // namespace glint::render
