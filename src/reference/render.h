// Whole pictures, and rays of the caller's, from the CPU reference. Results do not depend on the number of
// threads.
#pragma once

#include <vector>

#include "pack/packed_scene.h"
#include "reference/tracer.h"
#include "trace/picture.h"
#include "trace/ray_batch.h"
#include "trace/request.h"

namespace glint::reference {

// The picture that is asked for. A cancelled render holds the rows that were finished.
Picture render(const PackedScene& scene, const shared::Camera& camera, const Request& request,
               const Context& context = {});
// The same by a tracer that was made for the request.
Picture render(const Tracer& tracer, const rows::Camera& camera, const Request& request,
               const Context& context = {});

// The nearest hit of each ray, or whether there is one.
std::vector<WorldHit> trace(const PackedScene& scene, const RayBatch& batch, const Context& context = {});
// The same by a tracer that was made for the batch's methods.
std::vector<WorldHit> trace(const Tracer& tracer, const RayBatch& batch, const Context& context = {});

// The nearest hit of one local ray, or whether there is one.
WorldHit trace(const Tracer& tracer, const Ray& ray, HitDetail detail = HitDetail::Surface);

// A hit of a local ray, with the surface's point, normal and names. `t` stays in units of the ray's
// direction.
WorldHit worldHit(const Tracer& tracer, const Ray& ray, const Hit& hit);

}  // namespace glint::reference
