// The device's side of the comparisons with Embree.
#pragma once

#include <cstdint>
#include <vector>

#include "pack/packed_scene.h"
#include "rays.h"
#include "render/ray_queries.h"
#include "trace/ray_batch.h"

namespace glint::bench {

// Compiled kernels instead of the program's own, to try variants without building it.
struct Replacements {
    std::vector<uint32_t> intersect, intersectAny, packetIntersect, packetIntersectAny;
};

// The library's batches of rays, by one way to find hits.
class DeviceRays {
  public:
    // Keeps references to `device` and `scene`.
    DeviceRays(const gpu::Device& device, const PackedScene& scene, render::Traversal traversal,
               const Replacements& replaced = {});

    Timing trace(const std::vector<BenchRay>& rays, bool any, std::vector<BenchHit>& hits);
    // Points and normals too.
    std::vector<WorldHit> surfaces(const std::vector<BenchRay>& rays);

  private:
    // Rounded to fp32 they are what they were.
    RayBatch batchOf(const std::vector<BenchRay>& rays, HitDetail detail) const;
    uint32_t idOf(uint32_t primitive) const;

    const PackedScene& scene_;
    render::KernelCode code_;
    render::RayQueries queries_;
};

// The camera rays of the picture, 8x8 tiles one after the other and in each the Morton curve, as the paths of
// a picture run on llvmpipe.
std::vector<BenchRay> cameraRays(const PackedScene& scene, const shared::Camera& camera, int width,
                                 int height);

// From where rays hit, moved off the surface by 1e-4 of the distance, to the light.
std::vector<BenchRay> shadowRays(const std::vector<BenchRay>& rays, const std::vector<BenchHit>& hits,
                                 const shared::Light& light);

// True if packets can trace rays of this scene.
bool hasPackets(const gpu::Device& device, const PackedScene& scene);

}  // namespace glint::bench
