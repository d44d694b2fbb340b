// How many paths a slice may have, how many rows each, and how many loop trips a ray may make in a dispatch.
#pragma once

#include <cstdint>

#include "gpu/compute.h"
#include "gpu/device.h"
#include "pack/packed_scene.h"
#include "render/kernels.h"
#include "trace/picture.h"

namespace glint::render {

// True if paths may have further rays after the camera's: by a pipeline with these features, and by a request
// with this environment.
bool goesOnAfterHits(const SceneFeatures& features);
bool goesOnAfterHits(const SceneFeatures& features, const shared::Environment& environment);

// Paths of a slice, as many as asked for or as the device can bind and hold in a quarter of its memory.
uint32_t fittingPaths(const gpu::DeviceInfo& device, gpu::Access access, uint32_t wanted, uint32_t rows);

// One slice's paths at most; they fill any GPU.
inline constexpr uint32_t kMaxSlicePaths = 1u << 20;

// Tiles of a slice that go side by side.
inline uint32_t interleaveOf(const gpu::DeviceInfo& device) {
    return device.llvmpipe ? 16 : 1;
}

// Rays that whole.comp follows of a path after the camera's: all that there can be, or where they are a tree
// as many as hardly any path has.
uint32_t mostRaysAfterFirst(const SceneFeatures& features, const shared::Environment& environment);

// All rays of a path, shadow rays too.
uint64_t mostRaysOfPath(const SceneFeatures& features, const shared::Environment& environment);

// Loop trips that the rays of a path may make in one dispatch of a pipeline with these features.
uint32_t deriveTripBudget(const gpu::DeviceInfo& device, const SceneFeatures& features,
                          uint32_t polygonTripsPerLeaf = 0);

// Loop trips that all rays of a path may make in whole.comp.
uint32_t wholeTripBudget(const gpu::DeviceInfo& device, const SceneFeatures& features,
                         uint32_t polygonTripsPerLeaf, const shared::Environment& environment);

// Lights that a dispatch of light.comp may go through: few enough that most paths finish in the trips of one
// ray, and that its planes are not met more often than once each is allowed.
uint32_t lightsAtOnce(uint32_t tripBudget, uint32_t planeCount);

// Rows of the path state that every picture of these modes has; where those of the tree (kTreeRow...) begin,
// behind the instances' and the lists'; and all of them.
uint32_t commonRows(const TraceModes& modes);
uint32_t firstTreeRow(const SceneFeatures& features, const TraceModes& modes);
uint32_t pathRows(const SceneFeatures& features, const TraceModes& modes,
                  const shared::Environment& environment);

// The state of the paths that a picture's slices have room for.
struct PathRoom {
    uint32_t paths = 0, rows = 0;
    uint64_t bytes() const;
};
// `most`: paths of a slice, 0: as many as do good.
PathRoom roomFor(const gpu::DeviceInfo& device, gpu::Access access, const SceneFeatures& features,
                 const TraceModes& modes, const shared::Environment& environment, const Region& region,
                 uint32_t most = 0);

}  // namespace glint::render
