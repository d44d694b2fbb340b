// Limits of a dispatch: paths of a slice, rows of a path, and loop trips of a ray.
#pragma once

#include <cstdint>

#include "gpu/compute.h"
#include "gpu/device.h"
#include "pack/packed_scene.h"
#include "render/kernels.h"
#include "trace/picture.h"

namespace glint::render {

// True if paths may have reflected or refracted rays: by the features, and by the environment of a request
// too.
bool goesOnAfterHits(const SceneFeatures& features);
bool goesOnAfterHits(const SceneFeatures& features, const shared::Environment& environment);

// Paths of a slice: `wanted`, halved until the path state fits a binding, a quarter of the device's memory
// and 256 MiB (32 MiB on llvmpipe).
uint32_t fittingPaths(const gpu::DeviceInfo& device, gpu::Access access, uint32_t wanted, uint32_t rows);

// Most paths of a slice; they fill any GPU.
inline constexpr uint32_t kMaxSlicePaths = 1u << 20;

// Runs of a slice's tiles (Slice::interleave). llvmpipe gives each of its threads a run of the workgroups.
inline uint32_t interleaveOf(const gpu::DeviceInfo& device) {
    return device.llvmpipe ? 16 : 1;
}

// Most reflected and refracted rays of a path in whole.comp: the limit by depth, and for a tree of rays at
// most a number that few paths reach.
uint32_t mostRaysAfterFirst(const SceneFeatures& features, const shared::Environment& environment);

// All rays of a path, with shadow rays.
uint64_t mostRaysOfPath(const SceneFeatures& features, const shared::Environment& environment);

// Trips that one pass through the loops around a leaf takes: those loops, and each loop in them, of which a
// subgroup makes one trip even if no lane has work there.
uint32_t tripsOfPass(const SceneFeatures& features);

// Loop trips of a ray in one dispatch of kernels with these features.
uint32_t deriveTripBudget(const gpu::DeviceInfo& device, const SceneFeatures& features,
                          uint32_t polygonTripsPerLeaf = 0);

// Loop trips of all rays of a path in whole.comp.
uint32_t wholeTripBudget(const gpu::DeviceInfo& device, const SceneFeatures& features,
                         uint32_t polygonTripsPerLeaf, const shared::Environment& environment);

// Lights of one dispatch of light.comp, so that most paths finish within the trips of one ray, and planes are
// tested at most kMaxPlanes times.
uint32_t lightsAtOnce(uint32_t tripBudget, uint32_t planeCount);

// Rows of the path state: those of every image with these modes; the first of the tree (kTreeRow...), after
// those of instances and lists; and the number of all rows.
uint32_t commonRows(const TraceModes& modes);
uint32_t firstTreeRow(const SceneFeatures& features, const TraceModes& modes);
uint32_t pathRows(const SceneFeatures& features, const TraceModes& modes,
                  const shared::Environment& environment);

// Paths of the largest slice of a region. most: upper limit, or 0.
uint32_t slicePaths(const gpu::DeviceInfo& device, gpu::Access access, uint32_t rows, const Region& region,
                    uint32_t most);

}  // namespace glint::render
