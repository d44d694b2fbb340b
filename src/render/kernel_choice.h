// Which kernels a picture takes.
#pragma once

#include <vector>

#include "render/pipelines.h"
#include "trace/request.h"

namespace glint::render {

// Those that draw the request, with packets for camera rays or without.
std::vector<KernelId> kernelsOf(const PackedScene& scene, const Request& request, bool packets);

// The same where whole.comp draws it.
std::vector<KernelId> wholeKernelsOf(const Request& request);

}  // namespace glint::render
