#include "render/path_limits.h"

#include <algorithm>

#include "render/path_state.h"

namespace glint::render {

namespace {

// lavapipe ends all loops of a subgroup after this many trips in total (LP_MAX_TGSI_LOOP_ITERATIONS,
// lp_bld_limits.h of Mesa 22.3).
constexpr uint32_t kLlvmpipeTrips = 65535;
// Memory of the path state: 2^20 paths of 112 to 240 bytes, or fewer with trees of branches.
constexpr uint64_t kMaxPathBytes = 256ull << 20;
// On llvmpipe, whose first touch of each page costs as much as tracing some rays (docs/lab/speed.md).
constexpr uint64_t kMaxPathBytesOfLlvmpipe = 32ull << 20;

// Loop trips of a lane so that its subgroup stays within kLlvmpipeTrips; docs/design/traversal.md derives the
// formula. rays: that a path traces one after the other. uncounted: trips that no lane counts.
enum class Kernels { Any, Whole };
uint32_t budgetOf(Kernels kernels, const gpu::DeviceInfo& device, const SceneFeatures& features,
                  uint32_t polygonTripsPerLeaf, uint64_t rays, uint64_t uncounted) {
    const uint64_t lanes = std::max(device.limits.subgroupSize, 8u);
    const uint64_t leaves = kernels == Kernels::Any ? shared::kCountLeaves : 1;
    const uint64_t slack =
        2 * (1 + shared::kQuadricHits) * shared::kMaxLeafSize * leaves + 4 + polygonTripsPerLeaf;
    const uint64_t pass = tripsOfPass(features), loops = pass - 1;
    const auto left = [](uint64_t fixed, uint64_t each) {
        return fixed < kLlvmpipeTrips ? static_cast<uint32_t>((kLlvmpipeTrips - fixed) / each) : 1;
    };
    const uint32_t waiting = left(uncounted + lanes * (slack + 2 * pass + 1) + rays * (pass + 2), lanes);
    if (kernels == Kernels::Whole && features.instances) return waiting;
    const uint32_t outer = left(uncounted + lanes * slack + (2 + rays) * loops + rays, lanes + loops);
    return features.instances ? std::min(outer, waiting) : outer;
}

// Most rays of a tree; scenes/glass.json follows up to 82.
constexpr uint32_t kMostOfTree = 200;
constexpr uint32_t kTripsElsewhere = 1u << 16;
// In whole.comp: most trips for a ray over a material's textures and over bounces, and for a path in
// shading/camera.glsl.
constexpr uint32_t kTripsOfShading = 5;
constexpr uint32_t kTripsOfSample = 64;

// kPacketTurns consecutive packets share the trips of a subgroup.
constexpr uint32_t kMostTrips = 3000;
// Lights share a dispatch's trips: 8 lights at lavapipe's full budget, where 11 are no faster (knot with 400
// lights), 174 elsewhere. A shadow ray seldom takes as many.
constexpr uint32_t kTripsOfALight = 375;

}  // namespace

uint32_t fittingPaths(const gpu::DeviceInfo& device, gpu::Access access, uint32_t wanted, uint32_t rows) {
    const uint64_t pathBytes = static_cast<uint64_t>(rows) * sizeof(RowEntry);
    const uint64_t most =
        std::min(device.limits.memory / 4, device.llvmpipe ? kMaxPathBytesOfLlvmpipe : kMaxPathBytes);
    while (wanted > shared::kWorkgroupSize &&
           (!gpu::fits(wanted * pathBytes, access, device.limits) || wanted * pathBytes > most)) {
        wanted /= 2;
    }
    return wanted;
}

uint32_t mostRaysAfterFirst(const SceneFeatures& features, const shared::Environment& environment) {
    if (!goesOnAfterHits(features)) return 0;
    if (!features.transmission) return environment.maxDepth;
    return environment.maxDepth < 7 ? (2u << environment.maxDepth) - 2 : kMostOfTree;
}

uint64_t mostRaysOfPath(const SceneFeatures& features, const shared::Environment& environment) {
    const uint64_t hits = uint64_t{mostRaysAfterFirst(features, environment)} + 1;
    return hits * (uint64_t{std::max(environment.lightCount, 1u)} + 1);
}

// The middle loop; inner loops over nodes, over each kind of primitive with code, over polygons' edges and
// quadrics' further hits; and one for the compiler.
uint32_t tripsOfPass(const SceneFeatures& features) {
    uint32_t sum = 3 + features.polygons + features.quadrics - features.planes;
#define GLINT_ADD(number, Kind, KINDS, kinds, one, many) sum += features.kinds;
    GLINT_PRIMITIVES(GLINT_ADD, GLINT_ADD)
#undef GLINT_ADD
    return sum;
}

uint32_t deriveTripBudget(const gpu::DeviceInfo& device, const SceneFeatures& features,
                          uint32_t polygonTripsPerLeaf) {
    if (!device.llvmpipe) return kTripsElsewhere;
    return std::min(budgetOf(Kernels::Any, device, features, polygonTripsPerLeaf, kMostTrips / kTripsOfALight,
                             shared::kMaxPlanes),
                    kMostTrips);
}

uint32_t wholeTripBudget(const gpu::DeviceInfo& device, const SceneFeatures& features,
                         uint32_t polygonTripsPerLeaf, const shared::Environment& environment) {
    if (!device.llvmpipe) return kTripsElsewhere;
    const uint64_t rays = mostRaysOfPath(features, environment);
    const uint64_t beside = rays * std::max(environment.planeCount, 1u) + rays * kTripsOfShading;
    return budgetOf(Kernels::Whole, device, features, polygonTripsPerLeaf, rays, beside + kTripsOfSample);
}

uint32_t lightsAtOnce(uint32_t tripBudget, uint32_t planeCount) {
    return std::max(std::min(tripBudget / kTripsOfALight, shared::kMaxPlanes / (planeCount + 1)), 1u);
}

uint32_t commonRows(const TraceModes& modes) {
    if (modes.adaptive) return shared::kPathRowsAdaptive;
    return modes.aovs ? shared::kPathRowsWithAovs : shared::kPathRows;
}

bool goesOnAfterHits(const SceneFeatures& features) {
    return features.mirrors || features.transmission;
}

bool goesOnAfterHits(const SceneFeatures& features, const shared::Environment& environment) {
    return goesOnAfterHits(features) && environment.maxDepth > 0;
}

uint32_t firstTreeRow(const SceneFeatures& features, const TraceModes& modes) {
    return commonRows(modes) + (features.instances ? 1 : 0) +
           (goesOnAfterHits(features) ? shared::kListRows : 0);
}

// At most one branch waits for each ray from the eye to the one at hand.
uint32_t pathRows(const SceneFeatures& features, const TraceModes& modes,
                  const shared::Environment& environment) {
    const uint32_t first = firstTreeRow(features, modes);
    if (features.transmission)
        return first + shared::kTreeRowWaiting +
               std::clamp(environment.maxDepth, 1u, shared::kMaxWaiting) * shared::kWaitingRows;
    return first + (modes.ledger ? shared::kLedgerRows : 0);
}

uint32_t slicePaths(const gpu::DeviceInfo& device, gpu::Access access, uint32_t rows, const Region& region,
                    uint32_t most) {
    const uint32_t limit = fittingPaths(device, access, most > 0 ? most : kMaxSlicePaths, rows);
    const uint32_t wanted =
        std::min({Slice::tilesIn(region), limit / shared::kWorkgroupSize, device.limits.maxWorkgroupCountX});
    const uint32_t interleave = interleaveOf(device);
    return std::max(wanted / interleave, 1u) * interleave * shared::kWorkgroupSize;
}

}  // namespace glint::render
