#include "render/whole_paths.h"

#include <algorithm>

namespace glint::render {

namespace {

// A ray seldom takes more than a hundred, and paths are short.
constexpr uint32_t kFewestTrips = 1500;
// From where on what packets save pays for their longer start: between 0.7 million rays (scenes/arcade.json)
// and two.
constexpr uint64_t kManyRays = 1'000'000;

}  // namespace

uint32_t firstWholeTiles(uint64_t mostRays) {
    constexpr uint64_t kRays = 1 << 14, kLeast = 64, kMost = 256;
    return static_cast<uint32_t>(std::clamp(kRays / mostRays, kLeast, kMost));
}

bool wholePathsKnow(const TraceModes& modes) {
    const bool robust = modes.methods.triangles == TriangleMethod::Watertight &&
                        modes.methods.spheres == SphereMethod::Robust;
    return robust && !modes.aovs && !modes.cost && !modes.tally;
}

bool wholePathsPay(const gpu::DeviceInfo& device, const TraversalChoice& choice, const WholePathsWork& work) {
    if (!device.llvmpipe || work.tripBudget < kFewestTrips) return false;
    const bool many = work.rays == 0 || work.rays >= kManyRays;
    return !(choice.packets && !work.furtherRays && many);
}

}  // namespace glint::render
