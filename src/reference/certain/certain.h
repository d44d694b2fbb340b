// Certain closest hits, as in exact arithmetic: the scene is not packed and the rays are not rounded.
// Computes in double with bounds first. If the bounds leave several answers, it computes in fractions
// (Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates", Discrete &
// Computational Geometry 18(3), 1997, goes the same way with longer and longer numbers).
//
// Fractions decide every hit of a triangle or plane; spheres are decided in double. Any other surface, or a
// surface with holes, that a ray may hit leaves the answer uncertain. Triangles that packing drops because
// rounding to fp32 takes their area are not part of the scene.
#pragma once

#include <vector>

#include "pack/packed_scene.h"
#include "reference/tracer.h"
#include "scene/scene.h"
#include "trace/ray_batch.h"

namespace glint::reference::certain {

struct Answer {
    bool sure = false;
    // sure: the hit, its t (in units of the ray's direction), u and v as rounded; primitive kNone: a miss, t
    // infinite. Among surfaces that are hit at the same t, the one with the lowest id.
    Hit hit;
    // The exact t lies between them. Not sure: the first hit is not before `lower`, and some hit is at most
    // at `upper`, which is infinite if no hit is certain.
    double lower = 0, upper = 0;
};

class Tracer {
  public:
    // `scene`: placed, and what `packed` was made of. Both must outlive the tracer.
    Tracer(const Scene& scene, const PackedScene& packed);

    // The closest hit of a ray in world coordinates. A ray that is not finite or has no direction misses.
    Answer closest(const WorldRay& ray) const;

  private:
    friend class Search;

    const Scene& scene_;
    const PackedScene& packed_;
    std::vector<uint32_t> firstIds_;  // by object
    double slack_ = 0;  // how far surfaces may lie beyond the tree's boxes, in local coordinates
};

}  // namespace glint::reference::certain
