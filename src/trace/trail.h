// The rays of one path in the order in which a tracer followed them.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "core/device_layout.h"

namespace glint {

// Local coordinates.
struct TrailRay {
    glm::dvec3 origin{0}, direction{0};
    double t = 0;                 // of the hit
    uint32_t id = shared::kNone;  // of the primitive; kNone: a miss
    glm::dvec3 throughput{1};     // before the ray, with the sample's weight
    glm::dvec3 sum{0};            // radiance of all earlier rays, with the sample's weight
};
using Trail = std::vector<TrailRay>;

}  // namespace glint
