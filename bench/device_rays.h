// The device's side of the comparison: rays in, hits out, one kernel at a time.
#pragma once

#include <memory>
#include <vector>

#include "rays.h"
#include "render/path_state.h"
#include "render/pipelines.h"
#include "render/renderer.h"
#include "render/scene_buffers.h"

namespace glint::bench {

// Compiled kernels instead of the program's own, to try variants without building it.
struct Replacements {
    std::vector<uint32_t> intersect, intersectAny, packetIntersect, packetIntersectAny;
};

class DeviceRays {
  public:
    // Room for the rays of a picture of width x height pixels.
    DeviceRays(const gpu::Device& device, const PackedScene& scene, int width, int height,
               const Replacements& replaced);

    // The camera rays of the picture, in the order of the paths: 8x8 tiles, in each the Morton curve.
    std::vector<BenchRay> cameraRays(const shared::Camera& camera);
    // Traces what it is given, at most a picture's worth. Only the kernel that traces is timed.
    Timing trace(const std::vector<BenchRay>& rays, bool any, render::KernelId kernel,
                 std::vector<BenchHit>& hits);
    // Boxes and primitives tested in all, by the kernel's own count.
    uint64_t countTests(const std::vector<BenchRay>& rays, render::KernelId kernel);
    bool packets() const { return packets_; }

  private:
    void write(const std::vector<BenchRay>& rays);
    Timing run(render::KernelId kernel, const render::TraceModes& modes, uint32_t groups);

    const gpu::Device& device_;
    const PackedScene& scene_;
    gpu::Access access_;
    render::Slice slice_;
    render::SceneBuffers buffers_;
    render::PathState paths_;
    gpu::Buffer counters_;
    render::KernelCode code_;
    render::Pipelines pipelines_;
    gpu::Submission submission_;
    bool packets_ = false;
};

}  // namespace glint::bench
