// The rays of one path in the order in which a tracer followed them.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace glint {

// Local coordinates.
struct TrailRay {
    glm::dvec3 origin{0}, direction{0};
    bool hit = false;
    double t = 0;
    uint32_t id = 0;           // of the primitive
    glm::dvec3 throughput{1};  // before the ray, with the sample's weight
    glm::dvec3 sum{0};         // radiance of all earlier rays, with the sample's weight
};
using Trail = std::vector<TrailRay>;

// A ray of the path of one pixel, an index into arrays of the region's size.
struct PixelRay {
    size_t pixel;
    TrailRay ray;
};

}  // namespace glint
