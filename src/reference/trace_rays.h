// Rays of the caller's by the CPU reference.
#pragma once

#include <vector>

#include "pack/packed_scene.h"
#include "reference/tracer.h"
#include "trace/ray_batch.h"

namespace glint::reference {

// The nearest hit of each ray, or whether there is one. Does not depend on the number of threads.
std::vector<WorldHit> trace(const PackedScene& scene, const RayBatch& batch, const Context& context = {});
// The same by a tracer that was made for the batch's methods.
std::vector<WorldHit> trace(const Tracer& tracer, const RayBatch& batch, const Context& context = {});

// The nearest hit of one local ray, or whether there is one.
WorldHit trace(const Tracer& tracer, const Ray& ray, HitDetail detail = HitDetail::Surface);

// A hit of a local ray, with the surface's point, normal and names. `t` stays in units of the ray's
// direction.
WorldHit worldHit(const Tracer& tracer, const Ray& ray, const Hit& hit);

}  // namespace glint::reference
