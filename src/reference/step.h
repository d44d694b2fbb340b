// One ray of a path by itself: what it hits, the light that the hit adds, and the rays that leave it.
#pragma once

#include <vector>

#include "reference/optics.h"
#include "reference/tracer.h"

namespace glint::reference {

// A ray of the tree, and what the path so far determines.
struct Branch {
    Ray ray;
    Source source;
    glm::dvec3 throughput{1};
    glm::dvec3 slack{0};  // of the throughput, see rounding.h
    RayClass kind = RayClass::Primary;
    uint32_t depth = 0;    // rays before it
    uint32_t waiting = 0;  // branches that are followed only after all that comes of this one
    Media media;
    // Start on a surface: the point, the unit normal on the ray's side (0 for camera rays), the distance from
    // the point at which the device's ray begins, and the greatest number that a coordinate of the point is a
    // sum of.
    glm::dvec3 start{0}, out{0};
    double clearance = 0, scale = 0;
};

// `record` describes the branch's ray as if it were a camera ray; its color is the light that the hit adds.
struct Step {
    PixelRecord record;
    std::vector<Branch> next;
};

}  // namespace glint::reference
