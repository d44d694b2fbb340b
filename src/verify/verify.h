// Compares a device's image with the reference. Every pixel must lie within its predicted error or be
// explained by rounding. The reference predicts the greatest number of explained pixels. All limits scale
// with the brightness of the pixel (docs/design/verification.md).
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "core/enum_names.h"
#include "core/image.h"
#include "reference/sensitivity.h"
#include "reference/tracer.h"
#include "render/renderer.h"
#include "trace/picture.h"
#include "trace/request.h"
#include "verify/representation.h"

namespace glint::verify {

// Why a pixel differs.
enum class Reason {
    Predicted,   // within its predicted error: not in the report
    Edge,        // explained: another path; each of its rays is a possible rounding of the step before
    Rounding,    // explained: the same of the reference's own path, by more than its response to one unit
    Undecided,   // not examined, or beyond the steps that a pixel or an image may take
    Unexplained  // a defect, in the shader, the reference or the scene's packing
};
constexpr auto entriesOf(Reason) {
    return std::to_array<EnumEntry<Reason>>({{Reason::Predicted, "predicted"},
                                             {Reason::Edge, "edge"},
                                             {Reason::Rounding, "rounding"},
                                             {Reason::Undecided, "undecided"},
                                             {Reason::Unexplained, "unexplained"}});
}

// Settings of a comparison. Each sample (adaptive: of the first round) is compared as an image of its own, of
// the whole view. Region and outputs of the request other than colour are ignored.
struct Options : Request {
    Options() { width = 640, height = 480; }
    size_t worstCount = 10;
    // A scene passes with up to this many unexplained pixels, for devices with a known defect.
    uint64_t allowedUnexplained = 0;
    // Leave pixels in doubt undecided once the unexplained pixels fail the image.
    bool verdictAlone = false;
    // Also render the first sample without layers, as `glint render` does, possibly with other kernels.
    bool plainToo = true;
};

struct DifferingPixel {
    int x = 0, y = 0;
    uint32_t sample = 0;
    Reason reason = Reason::Unexplained;
    double difference = 0;  // greatest colour difference
    // Names of what differs by more than its predicted error: kQuantityNames, "alpha", "bounces", "layers of
    // a miss", or "path" alone if other surfaces were hit.
    std::vector<std::string_view> quantities = {};
    double ulps = 0;             // the greatest move of a ray, in units of 2^-24, that explained it
    uint32_t openDecisions = 0;  // steps of the path at which rounding decided
    glm::vec3 deviceColor{0};
    PixelData device;
    reference::PixelRecord reference;
    // Device and reference hit the same primitives.
    bool isSamePath() const { return device.pathHash == reference.pathHash; }
    // They also followed equally many rays, and so lost the same branches.
    bool isAlike() const { return isSamePath() && device.bounces == reference.bounces; }
};

struct Report {
    uint64_t pixels = 0;
    uint64_t edges = 0, roundings = 0, undecided = 0, unexplained = 0;
    uint64_t plainDiffers = 0;  // pixels whose bits differ in the image without layers
    uint64_t filmDiffers = 0;   // pixels of the combined image that are not the mean of their samples
    bool lossesDiffer = false;  // device and reference omitted different branches
    double rmse = 0;            // colour, all pixels
    double rmseSamePath = 0;    // colour, pixels whose paths hit the same primitives: pure arithmetic
    double maxSamePath = 0;
    double p99 = 0;  // |device - reference|, greatest channel, 99th percentile of all pixels
    // Sensitivity of the reference alone, which defects of the device cannot change
    // (reference/sensitivity.h).
    reference::Sensitivity sensitivity;
    std::vector<DifferingPixel> worst;  // unexplained first, then by difference
    Image device, reference;            // 3 channels, linear; of the first sample
    Image difference;  // 3 channels: grey |difference| * 64; red unexplained, yellow edge, green rounding,
                       // magenta undecided; of the first sample
    bool interrupted = false;
    uint64_t allowedUnexplained = 0;  // Options'
    // Effect of the scene's rounding; absent if the source of the packed scene is not given.
    std::optional<Representation> representation;

    uint64_t explained() const { return edges + roundings; }
    // The greatest number of pixels that may be explained, with kConfidence.
    uint64_t allowedExplained() const;
    bool passed() const {
        return !interrupted && unexplained <= allowedUnexplained && plainDiffers == 0 && filmDiffers == 0 &&
               !lossesDiffer && explained() + undecided <= allowedExplained() &&
               (!representation || representation->passed());
    }
};

// Bytes that verify() allocates for each pixel of the image: images, differences, and the part that is
// compared at a time, with one ray for each path. maxDepth: of the scene with these options.
uint64_t bytesPerPixel(const Options& options, uint32_t maxDepth);

// `scene`: the scene of `renderer`. read: the source of `scene`, to check its rounding too; its camera is the
// request's.
Report verify(render::Renderer& renderer, const PackedScene& scene, const Options& options,
              const Scene* read = nullptr);

}  // namespace glint::verify
