// Which kernels a picture takes.
#pragma once

#include <cstdint>
#include <vector>

#include "render/pipelines.h"
#include "trace/request.h"

namespace glint::render {

// Those that draw the request, with packets for camera rays or without.
std::vector<KernelId> kernelsOf(const PackedScene& scene, const Request& request, bool packets);

// The same where whole.comp draws it.
std::vector<KernelId> wholeKernelsOf(const Request& request);

// A packet stops where one of its rays does, and so takes few lights at once; where there are very many, rays
// go to them by themselves (lightsNext in path_limits.h).
bool lightsGoInPackets(uint64_t lights);

}  // namespace glint::render
