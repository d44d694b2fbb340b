// Whole pictures from the CPU reference.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "pack/pack_samples.h"
#include "reference/tracer.h"

namespace glint::reference {

struct RenderOptions {
    // The pixels [x0, x1) x [y0, y1) of the picture; x1 or y1 negative: up to its edge. Clipped to the
    // picture.
    int x0 = 0, y0 = 0, x1 = -1, y1 = -1;
    std::vector<glm::dvec2> sampleOffsets{{0.5, 0.5}};  // within the pixel, each in [0, 1)^2
    std::optional<PackedSamples> samples;               // instead of sampleOffsets
    bool aovs = true;                                   // false: PixelResult keeps color and alpha alone
    unsigned threads = 0;                               // 0: all
    std::function<void(double)> progress;  // called from any thread, one at a time, with the fraction done
    std::function<bool()> cancelled;       // polled from all threads; true ends the render early
};

// Everything but color, alpha and the losses comes from the first sample. Without a hit: depth inf, indices
// -1, the rest 0.
struct PixelResult {
    glm::dvec3 color{0};                                     // weighted mean over the samples
    double alpha = 0;                                        // the same of 1 where a sample hit anything
    uint32_t samples = 0;                                    // taken
    double depth = std::numeric_limits<double>::infinity();  // t along the unit camera ray
    glm::dvec3 position{0};                                  // world
    glm::dvec3 normal{0};                                    // outward shading normal, unit
    double u = 0, v = 0;                                     // barycentrics of a triangle
    int32_t object = -1;
    int32_t primitive = -1;  // face index in the file's order
    int32_t material = -1;
    uint32_t bounces = 0;
    uint64_t cost = 0;
    uint32_t pathHash = 0;
    uint32_t shadowBits = 0;
    std::optional<Hit> hit;
    Losses lost;  // of all samples; bounds are of the mean
};

struct RenderResult {
    int x0 = 0, y0 = 0;               // where the crop lies in the picture
    int width = 0, height = 0;        // of the crop
    std::vector<PixelResult> pixels;  // row by row from the top
    std::vector<uint8_t> rowsDone;    // per row of the crop: 1 if finished; all 1 unless cancelled
    bool complete = false;

    const PixelResult& at(int x, int y) const {
        return pixels[static_cast<size_t>(y) * width + x];
    }  // in the crop
};

// A picture of width x height pixels. Does not depend on the number of threads.
RenderResult render(const PackedScene& scene, const shared::Camera& camera, int width, int height,
                    const RenderOptions& options = {});

}  // namespace glint::reference
