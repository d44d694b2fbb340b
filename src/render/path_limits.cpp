#include "render/path_limits.h"

#include <algorithm>

#include "render/path_state.h"
#include "render/renderer.h"

namespace glint::render {

namespace {

// lavapipe ends all loops of a subgroup after this many trips in all (LP_MAX_TGSI_LOOP_ITERATIONS,
// lp_bld_limits.h of Mesa 22.3).
constexpr uint32_t kLlvmpipeTrips = 65535;
// Of path state: 2^20 paths of 176 bytes (208 with mirrors), or fewer where each has a tree of branches to
// keep.
constexpr uint64_t kMaxPathBytes = 256ull << 20;

// See deriveTripBudget.
#define GLINT_LOOPS(A, ROLE, number, Kind, kinds, binding, ROWS, FEATURE, ID, one, many, crossings, loops, \
                    uv)                                                                                    \
    +loops
constexpr uint32_t kLoops = 1 GLINT_PRIMITIVES(GLINT_LOOPS, 0);
#undef GLINT_LOOPS
#define GLINT_MASK_LOOPS(A, ROLE, number, Kind, kinds, binding, ROWS, FEATURE, ID, one, many, crossings, \
                         loops, uv)                                                                      \
    +(loops == 0 ? 0 : 3 * std::min(crossings, 2))
constexpr uint32_t kMaskLoops = 0 GLINT_PRIMITIVES(GLINT_MASK_LOOPS, 0);
#undef GLINT_MASK_LOOPS

}  // namespace

uint32_t fittingPaths(const gpu::DeviceInfo& device, gpu::Access access, uint32_t wanted, uint32_t rows) {
    const uint64_t pathBytes = static_cast<uint64_t>(rows) * sizeof(RowEntry);
    while (wanted > shared::kWorkgroupSize &&
           (!gpu::fits(wanted * pathBytes, access, device.limits) ||
            wanted * pathBytes > std::min<uint64_t>(device.limits.memory / 4, kMaxPathBytes))) {
        wanted /= 2;
    }
    return wanted;
}

gpu::Access chooseAccess(const gpu::DeviceInfo& device, uint64_t largestArrayBytes) {
    const bool storageFits = gpu::fits(largestArrayBytes, gpu::Access::StorageBuffer, device.limits);
    const bool texelFits = gpu::fits(largestArrayBytes, gpu::Access::TexelBuffer, device.limits);
    const bool enoughImages = device.limits.maxStorageImagesPerStage >= GLINT_BINDING_COUNT;
    if (enoughImages && texelFits && (device.llvmpipe || !storageFits)) return gpu::Access::TexelBuffer;
    return gpu::Access::StorageBuffer;
}

bool looksUpTextures(const SceneFeatures& features) {
    return features.alphaMask || (features.coloredShadows && (features.textures || features.checkers));
}

// Trips of a subgroup of S lanes whose lanes give up after B trips each. Every trip of a loop in which some
// lane is live counts in that lane's own B, so there are at most S (B + slack) of them, where slack = (1 +
// kQuadricHits) kMaxLeafSize + 4 + polygonTripsPerLeaf is what one pass of the outer loop can add after the
// last check, and the way back into an instance before the first. Besides, lavapipe enters each inner loop
// once in every trip of the one around it even with no lane live, and the outer loop's trips are those of its
// longest lane: L (B + 2) more, where L counts the loop of the nodes, those of each kind in leaves (of
// polygons also their edges', of quadrics their further hits') and the way into an instance. The planes' loop
// comes on top. So S (B + slack)
// + L (B + 2) + kMaxPlanes <= 65535, and one more beside L leaves room for the compiler's own. With alpha
// masks each test, of a plane too, holds loops of kMaskTrips trips at most, which each lane counts; those in
// the leaves' loops, three for each hit that is asked about (two places in the code where a line may meet a
// primitive more than once), are entered once more in every trip of the outer loop.
uint32_t deriveTripBudget(const gpu::DeviceInfo& device, uint32_t polygonTripsPerLeaf, bool alphaMask) {
    if (!device.llvmpipe) return 1u << 16;
    const uint32_t lanes = std::max(device.limits.subgroupSize, 8u);
    const uint32_t mask = alphaMask ? shared::kMaskTrips : 0;
    const uint32_t slack =
        (1 + shared::kQuadricHits) * (1 + mask) * shared::kMaxLeafSize + 4 + polygonTripsPerLeaf;
    const uint32_t entered = kLoops + 1 + (alphaMask ? kMaskLoops : 0);
    const uint32_t fixed =
        shared::kMaxPlanes * (1 + mask) + shared::kTextureTrips + lanes * slack + 2 * entered;
    return fixed < kLlvmpipeTrips ? (kLlvmpipeTrips - fixed) / (lanes + entered) : 1;
}

uint32_t commonRows(const TraceModes& modes) {
    if (modes.adaptive) return shared::kPathRowsAdaptive;
    return modes.aovs ? shared::kPathRowsWithAovs : shared::kPathRows;
}

bool goesOnAfterHits(const SceneFeatures& features) {
    return features.mirrors || features.transmission;
}

uint32_t firstTreeRow(const SceneFeatures& features, const TraceModes& modes) {
    return commonRows(modes) + (features.instances ? 1 : 0) +
           (goesOnAfterHits(features) ? shared::kListRows : 0);
}

// At most one branch waits for each ray from the eye to the one at hand.
uint32_t pathRows(const SceneFeatures& features, const TraceModes& modes, uint32_t maxDepth) {
    const uint32_t first = firstTreeRow(features, modes);
    if (features.transmission)
        return first + shared::kTreeRowWaiting +
               std::clamp(maxDepth, 1u, shared::kMaxWaiting) * shared::kWaitingRows;
    return first + (modes.ledger ? shared::kLedgerRows : 0);
}

}  // namespace glint::render
