#include "app/drawing.h"

#include <memory>
#include <ostream>
#include <utility>

#include "app/common.h"
#include "app/loading.h"
#include "core/error.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "core/text_file.h"
#include "pack/pack_samples.h"
#include "pack/request_environment.h"
#include "reference/render.h"
#include "reference/tracer.h"
#include "reference/truth/truth.h"
#include "verify/stiffness.h"

namespace glint::app {

Error withAdvice(const Error& error) {
    return {error.kind(), std::string(error.what()) + ", or use --backend cpu"};
}

gpu::Device openDevice(const DeviceChoice& choice, bool hostWould, bool keepPrograms) {
    try {
        return gpu::Device({choice.selector, choice.validation, {}, keepPrograms});
    } catch (const Error& error) {
        if (!hostWould || choice.validation || !choice.selector.empty()) throw;
        throw withAdvice(error);
    }
}

void checkValidation(const gpu::Device& device, const DeviceChoice& choice) {
    if (!choice.validation) return;
    const auto messages = device.validationMessages();
    std::string text = "the validation layer found faults:";
    for (const std::string& message : messages) text += "\n  " + message;
    if (!messages.empty()) throw Error(ErrorKind::Device, text);
}

converge::Job jobOf(const ErrorTarget& target, const LoadedScene& loaded, Backend backend, Request& request) {
    if (!target.withinDepth && converge::missesReflections(loaded.scene, depthOf(loaded.packed, request)))
        throw Error(ErrorKind::Argument,
                    "--error cannot bound reflections at maxDepth 0: use --max-depth 1 or --within-depth");
    if (regionOf(request).width() * regionOf(request).height() == 1)
        throw Error(ErrorKind::Argument,
                    "--error cannot bound the error of a single pixel: use a larger --crop");
    converge::Target wanted = target.limits;
    wanted.error = *target.error;
    wanted.depthCounts = !target.withinDepth;
    converge::Job job = converge::jobFor(loaded.packed, request, wanted);
    request = job.request;
    job.radianceBound =
        radianceBound(loaded.packed, environmentOf(loaded.packed, request), lightsOf(loaded.packed, request));
    job.inDouble = backend == Backend::Cpu;
    // The condition number times the ulp of the arithmetic, and the rounding error of storing as fp32.
    job.rounding =
        verify::roundingError(reference::Tracer(loaded.packed, request), cameraOf(loaded, request),
                              request.width, request.height, job.inDouble ? 0x1p-53 : verify::kFloatUnit);
    return job;
}

Drawing::Drawing(Backend backend, const DeviceChoice& choice, std::ostream& warnings)
    : backend_(backend), choice_(choice), warnings_(warnings) {
    if (backend == Backend::Cpu) return;
    opening_ = std::async(std::launch::async | std::launch::deferred, [&choice] {
        gpu::Device device = openDevice(choice, true);
        device.arithmetic();  // a few milliseconds the first time
        return device;
    });
}

void Drawing::load(const LoadedScene& loaded, const Request& expected, uint64_t cameraRays) {
    loaded_ = &loaded;
    expected_ = expected;
    camera_ = cameraOf(loaded, expected);
    try {
        if (backend_ == Backend::Gpu) return loadDevice(expected, cameraRays);
    } catch (const Error& error) {
        if (!fallBack(error)) throw;
        return;
    }
    loadTruth();
}

void Drawing::loadTruth() {
    const Stopwatch watch;
    const glm::dvec3& origin = loaded_->packed.origin;
    truth_ = std::make_shared<reference::Model>(reference::truthOf(loaded_->scene, origin));
    truthCamera_ = reference::truthCamera(loaded_->scene.camera, expected_.width, expected_.height, origin);
    hostSeconds_ += watch.seconds();
}

void Drawing::loadDevice(const Request& expected, uint64_t cameraRays) {
    if (!device_) device_.emplace(opening_.get());
    render::Options options;
    options.traversal = choice_.traversal;
    options.ownArithmetic = choice_.reproducible;
    options.expected = &expected;
    options.also = alsoFor(*loaded_, expected);
    options.cameraRays = cameraRays;
    renderer_.emplace(*device_, loaded_->packed, options);
}

bool Drawing::fallBack(const Error& error) {
    if (backend_ == Backend::Cpu || choice_.fallback != Fallback::Cpu || error.kind() != ErrorKind::Device)
        return false;
    backend_ = Backend::Cpu;
    failed_ = {device_ ? device_->info().name : "", error.what()};
    // On a terminal the warning overwrites the bar, which is shorter.
    warnings_ << (isTerminal(warnings_) ? "\r" : "") << "glint: warning: " << failed_->reason
              << "; rendered by the reference instead (--fallback cpu)\n"
              << std::flush;
    renderer_.reset();
    device_.reset();
    loadTruth();
    return true;
}

void Drawing::reload(const Request& expected, bool cameraAlone) {
    if (!cameraAlone) return load(*loaded_, expected);
    camera_ = cameraOf(*loaded_, expected);
    if (backend_ == Backend::Gpu) return;
    reference::setEye(*truth_, loaded_->scene.camera.eye);
    truthCamera_ = reference::truthCamera(loaded_->scene.camera, expected.width, expected.height,
                                          loaded_->packed.origin);
}

Picture Drawing::draw(const Request& request, const std::optional<converge::Job>& job,
                      std::optional<converge::Result>& converged) {
    return whole([&] {
        if (!job) return draw(request);
        converged = converge::converge([&](const Request& r) { return draw(r); }, *job);
        return std::move(converged->picture);
    });
}

Picture Drawing::draw(const Request& request) {
    if (backend_ == Backend::Gpu) return renderer_->render(camera_, request);
    const Stopwatch watch;
    const reference::Tracer tracer(truth_, request, radianceBoundOf(loaded_->packed, request));
    Picture picture = reference::render(tracer, truthCamera_, request);
    hostSeconds_ += watch.seconds();
    return picture;
}

DrawingFacts Drawing::facts() const {
    DrawingFacts facts;
    facts.backend = backend_;
    if (!renderer_ && !truth_) return facts;
    if (backend_ == Backend::Cpu) {
        facts.device = "CPU reference (double precision)";
        facts.driver = counted(defaultThreadCount(), "thread");
        facts.times.trace = hostSeconds_;
        facts.failed = failed_;
        return facts;
    }
    facts.device = device_->info().name;
    facts.driver = device_->info().driver;
    // Whole paths and counts of tests trace single rays.
    const render::KernelTimes& kernels = renderer_->times().kernels;
    const bool single = expected_.cost || (kernels.whole > 0 && kernels.primary == 0);
    facts.traversal = nameOf(single ? render::TraversalChoice() : renderer_->traversal(expected_.methods));
    facts.arithmetic = device_->arithmetic();
    facts.times = renderer_->times();
    return facts;
}

void Drawing::checkValidation() const {
    if (device_) app::checkValidation(*device_, choice_);
}

}  // namespace glint::app
