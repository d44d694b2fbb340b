// The intersection functions one by one: ray i against primitive i. On the device by primitive_probe.comp, on
// the reference through scenes of one primitive.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "core/device_layout.h"
#include "gpu/compute.h"
#include "gpu/device.h"
#include "render/scene_buffers.h"

namespace glint::stability {

// The subject of a check: a device, or without one the double-precision reference. mutant: a name from
// mutants.cmake, whose kernels then replace the sound ones; empty for none.
struct Subject {
    const gpu::Device* device = nullptr;
    std::string mutant;
};

// How the subject's kernels load: as the device does best. Mutants are of one kind.
gpu::Access accessOf(const Subject& subject, const render::ArraySizes& sizes);

struct FloatRay {
    glm::vec3 origin{0};
    glm::vec3 direction{0, 0, -1};
    // Device only.
    float tMin = 0, tMax = shared::kInfinity;
    uint32_t source = shared::kNone;
};

inline shared::Triangle triangleOf(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    return {.v0 = a, .v1 = b, .v2 = c};
}

struct Answer {
    bool hit = false;
    double t = 0, u = 0, v = 0;
};

struct Box {
    glm::vec3 lo, hi;
};

// `vertices`: of polygons. Quadrics and boxes on the device only: the reference traces the packed scene that
// they come from.
template <class Primitive>
std::vector<Answer> probe(const Subject& subject, const std::vector<FloatRay>& rays,
                          const std::vector<Primitive>& primitives,
                          const std::vector<shared::PolygonVertex>& vertices = {});
// Device only. Intervals are open at tMin and closed at tMax, so that a ray that continues from a hit misses
// it: counts hits that a ray up to their t does not repeat, and hits at or before t by rays from there.
// Beyond tMax hits within the bound of t's error are right; the traversal keeps the end of a caller's ray
// (AnalyticTest.IntervalIsOpenBelowAndClosedAbove).
template <class... Arrays>
size_t countWrongEnds(const Subject& subject, const std::vector<FloatRay>& rays,
                      const std::vector<Answer>& hits, const Arrays&... arrays) {
    std::vector<FloatRay> to = rays, from = rays;
    for (size_t i = 0; i < rays.size(); ++i)
        if (hits[i].hit) to[i].tMax = from[i].tMin = static_cast<float>(hits[i].t);
    const std::vector<Answer> closed = probe(subject, to, arrays...), open = probe(subject, from, arrays...);
    size_t wrong = 0;
    for (size_t i = 0; i < rays.size(); ++i)
        if (hits[i].hit)
            wrong += !closed[i].hit || closed[i].t != hits[i].t || (open[i].hit && open[i].t <= hits[i].t);
    return wrong;
}
// Device only: accepted hits of rays that leave a surface, less triangles that lie behind them.
std::vector<Answer> probeAhead(const Subject& subject, const std::vector<FloatRay>& rays,
                               const std::vector<shared::Triangle>& triangles);
// Device only: hits as they are shaded, slivers settled. exchanged: corners as of a mirrored instance.
std::vector<Answer> probeSettled(const Subject& subject, const std::vector<FloatRay>& rays,
                                 const std::vector<shared::Triangle>& triangles, bool exchanged);
// Device only: the normals at hits of quadrics, as t, u, v.
std::vector<Answer> probeNormals(const Subject& subject, const std::vector<FloatRay>& rays,
                                 const std::vector<shared::Quadric>& quadrics);
// Device only. Answer::hit: the box would be entered, which the reference decides in its own way.
std::vector<Answer> probe(const Subject& subject, const std::vector<FloatRay>& rays,
                          const std::vector<Box>& boxes);

}  // namespace glint::stability
