// Renders images and traces the caller's rays with the CPU reference. Results do not depend on the number of
// threads.
#pragma once

#include <vector>

#include "pack/packed_scene.h"
#include "reference/tracer.h"
#include "trace/picture.h"
#include "trace/ray_batch.h"
#include "trace/request.h"

namespace glint::reference {

// The requested image. A cancelled render holds the finished rows.
Picture render(const PackedScene& scene, const Request& request, const Context& context = {});
// Uses a tracer that was made for the request.
Picture render(const Tracer& tracer, const rows::Camera& camera, const Request& request,
               const Context& context = {});

// The closest hit of each ray, or for Any only whether it hits.
std::vector<WorldHit> trace(const PackedScene& scene, const RayBatch& batch, const Context& context = {});
// Uses a tracer that was made for the batch's methods.
std::vector<WorldHit> trace(const Tracer& tracer, const RayBatch& batch, const Context& context = {});

// The closest hit of one local ray, or whether there is one.
WorldHit trace(const Tracer& tracer, const Ray& ray, HitDetail detail = HitDetail::Surface);

// A hit of a local ray, with the surface's point, normal and names. `t` stays in units of the ray's
// direction.
WorldHit worldHit(const Tracer& tracer, const Ray& ray, const Hit& hit);

}  // namespace glint::reference
