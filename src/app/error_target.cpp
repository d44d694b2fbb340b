#include "app/error_target.h"

#include <algorithm>
#include <cmath>
#include <ostream>

#include "app/common.h"
#include "app/loading.h"
#include "core/error.h"
#include "pack/pack_samples.h"
#include "pack/request_environment.h"
#include "reference/tracer.h"
#include "verify/stiffness.h"

namespace glint::app {

namespace {

constexpr int kMostErrorSamples = 1 << 20;

double confidenceOf(const std::string& text) {
    const double value = parseNotNegative(text);
    if (!(value > 0.5 && value < 1))
        throw Error(ErrorKind::Argument, "a confidence lies between 0.5 and 1, such as 0.95");
    return value;
}

// Kernels without reflections do not count what is missing.
void checkDepthIsKnown(const ErrorTarget& target, const LoadedScene& loaded, const Request& request) {
    const auto reflects = [](const Material& m) {
        return m.mirror != Color(0) || m.transmission != Color(0);
    };
    const auto& materials = loaded.scene.materials;
    if (target.withinDepth || depthOf(loaded.packed, request) > 0 ||
        std::none_of(materials.begin(), materials.end(), reflects))
        return;
    throw Error(ErrorKind::Argument,
                "--error cannot bound reflections at maxDepth 0: use --max-depth 1 or --within-depth");
}

}  // namespace

void addError(OptionTable& table, ErrorTarget& target) {
    table.value(
        "--error", "E",
        "take samples until the image's root mean square error is at most E (linear radiance, full scale 1)",
        target.error, parsePositive);
    table.value("--confidence", "P", "probability that --error holds, above 0.5 and below 1 (default 0.95)",
                target.confidence, confidenceOf);
    table.flag("--within-depth", "do not count reflections beyond the scene's depth as error",
               target.withinDepth);
    table.require("--error", {"--confidence", "--within-depth"});
}

void addErrorTarget(OptionTable& table, ErrorTarget& target) {
    addError(table, target);
    table.value("--max-seconds", "S", "stop after S seconds with the best image so far", target.maxSeconds,
                parsePositive);
    table.whole("--max-spp", "N", "stop at N samples per pixel (default 65536)", 2, kMostErrorSamples,
                target.maxSamples);
    table.flag("--strict", "exit with code 5 if --error is not reached", target.strict);
    table.require("--error", {"--max-seconds", "--max-spp", "--strict"});
}

converge::Job jobOf(const ErrorTarget& target, const LoadedScene& loaded, Backend backend, Request& request,
                    Progress& progress) {
    checkDepthIsKnown(target, loaded, request);
    if (regionOf(request).width() * regionOf(request).height() == 1)
        throw Error(ErrorKind::Argument,
                    "--error cannot bound the error of a single pixel: use a larger --crop");
    converge::Job job;
    job.image = request.image;
    job.image.adaptive.reset();
    if (job.image.sampler == Sampler::Grid) job.image.sampler = Sampler::LowDiscrepancy;
    job.target.error = *target.error;
    job.target.confidence = target.confidence.value_or(job.target.confidence);
    job.target.maxSeconds = target.maxSeconds.value_or(job.target.maxSeconds);
    if (target.maxSamples) job.target.maxSamples = static_cast<uint32_t>(*target.maxSamples);
    job.target.depthCounts = !target.withinDepth;
    job.radianceBound =
        radianceBound(loaded.packed, environmentOf(loaded.packed, request), lightsOf(loaded.packed, request));
    request.limits.depth = depthOf(loaded.packed, request);
    job.inDouble = backend == Backend::Cpu;
    // The condition number times the ulp of the arithmetic, and the rounding error of storing as fp32.
    job.rounding =
        verify::roundingError(reference::Tracer(loaded.packed, request), cameraOf(loaded, request),
                              request.width, request.height, job.inDouble ? 0x1p-53 : verify::kFloatUnit);
    // Batches are many, and each would count from 0 to 1.
    request.progress = {};
    request.ledger = true;
    request.samples = SampleSequence(job.image).next(leastSamples(job.image.filter));
    job.request = request;
    const double wanted = *target.error;
    job.report = [&progress, wanted, last = 0.0](const converge::State& state) mutable {
        // Work grows with about the error's -5/3rd power. The bound is far from the error at first.
        const double error = state.estimate > 0 ? state.estimate : state.budget.sampling;
        const double left = std::max(error / wanted, 1.0);
        last = std::max(last, std::min(std::pow(left, -5.0 / 3), 0.99));
        progress.update(last);
    };
    return job;
}

}  // namespace glint::app
