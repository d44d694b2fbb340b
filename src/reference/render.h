// Whole pictures from the CPU reference.
#pragma once

#include "pack/packed_scene.h"
#include "reference/tracer.h"
#include "trace/picture.h"
#include "trace/request.h"

namespace glint::reference {

// The picture that is asked for. Does not depend on the number of threads. A cancelled render holds
// the rows that were finished.
Picture render(const PackedScene& scene, const shared::Camera& camera, const Request& request,
               const Context& context = {});
// The same by a tracer that was made for the request.
Picture render(const Tracer& tracer, const rows::Camera& camera, const Request& request,
               const Context& context = {});

}  // namespace glint::reference
