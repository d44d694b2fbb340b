// Does the device draw what the reference draws? Every pixel that differs must be explained by rounding, or
// the verdict is no.
#pragma once

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "core/enum_names.h"
#include "core/image.h"
#include "reference/tracer.h"
#include "render/renderer.h"
#include "trace/picture.h"
#include "trace/request.h"
#include "verify/stiffness.h"

namespace glint::verify {

// Why a differing pixel differs.
enum class Reason {
    Tie,   // explained, and the two first hits are other primitives at the same t within the bound
    Edge,  // explained: the reference gives the device's answer for a ray moved by no more than rounding
    Unexplained  // a defect, in the shader, the reference or the scene's packing
};
constexpr auto entriesOf(Reason) {
    return std::to_array<EnumEntry<Reason>>(
        {{Reason::Tie, "tie"}, {Reason::Edge, "edge"}, {Reason::Unexplained, "unexplained"}});
}

// What is to be compared: each sample (adaptive: of the first round) is a picture of its own, of the whole
// view. Region and what a request wants besides colour are not looked at.
struct Options : Request {
    Options() { width = 640, height = 480; }
    double tolerance =
        1.0 / 512;  // greatest colour difference that needs no explanation: linear, unclamped, full scale 1
    double maxExplainedShare = 0.005;  // of all pixels, where the reference itself is not sensitive
    size_t worstCount = 10;
};

struct DifferingPixel {
    int x = 0, y = 0;
    size_t sample = 0;
    Reason reason = Reason::Unexplained;
    double difference = 0;  // greatest colour difference
    double ulps = 0;        // the jitter that explained it
    glm::vec3 deviceColor{0};
    PixelData device;
    reference::PixelRecord reference;
};

// How many times as many pixels the device may see otherwise as the reference does when each of its rays is
// moved by up to one unit of 2^-24. Measured: 0.6 to 1 times as many (docs/design/verification.md).
inline constexpr double kShareOfPrediction = 2;

struct Report {
    uint64_t pixels = 0;
    uint64_t ties = 0, edges = 0, unexplained = 0;
    uint64_t idsDiffer = 0;   // of the differing pixels, those whose paths hit other primitives
    double rmse = 0;          // colour, all pixels
    double rmseSamePath = 0;  // colour, pixels whose paths hit the same primitives: pure arithmetic
    double maxSamePath = 0;
    double p99 = 0;    // |device - reference|, greatest channel, 99th percentile of all pixels
    double kappa = 0;  // of the scene, see stiffness.h; kappa 2^-24 is what p99 should be about
    std::vector<DifferingPixel> worst;  // unexplained first, then by difference
    // The share of pixels that the reference alone sees otherwise when its rays are moved by one unit: a
    // prediction that no defect of the device can change (Sensitivity::changed).
    double predictedShare = 0;
    Image difference;  // 3 channels: grey |difference| * 64; red unexplained, yellow edge, blue tie; of the
                       // first sample
    bool interrupted = false;

    uint64_t explained() const { return ties + edges; }
    // What share of explained pixels is allowed, see docs/design/verification.md.
    double allowedShare(const Options& options) const {
        return std::max(options.maxExplainedShare, kShareOfPrediction * predictedShare);
    }
    bool passed(const Options& options) const {
        return !interrupted && unexplained == 0 &&
               static_cast<double>(explained()) <= allowedShare(options) * static_cast<double>(pixels);
    }
};

// `scene` must be the one that `renderer` was made from.
Report verify(render::Renderer& renderer, const PackedScene& scene, const shared::Camera& camera,
              const Options& options);

}  // namespace glint::verify
