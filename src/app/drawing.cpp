#include "app/drawing.h"

#include <utility>

#include "app/common.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "reference/loaded_truth.h"
#include "reference/render.h"

namespace glint::app {

Drawing::Drawing(Backend backend, const DeviceChoice& choice) : backend_(backend), choice_(choice) {
    if (backend == Backend::Cpu) return;
    opening_ = std::async(std::launch::async | std::launch::deferred, [&choice] {
        gpu::Device device = openDevice(choice, true);
        device.arithmetic();  // a few milliseconds the first time
        return device;
    });
}

void Drawing::load(const LoadedScene& loaded, const Request& expected) {
    loaded_ = &loaded;
    camera_ = cameraOf(loaded);
    methods_ = expected.methods;
    if (backend_ == Backend::Cpu) {
        const Stopwatch watch;
        truth_ = reference::truthOf(loaded);
        truthCamera_ = reference::truthCamera(loaded);
        hostSeconds_ += watch.seconds();
        return;
    }
    if (!device_) device_.emplace(opening_.get());
    render::Options options;
    options.traversal = choice_.traversal;
    options.ownArithmetic = choice_.reproducible;
    options.expected = &expected;
    renderer_.emplace(*device_, loaded.packed, options);
}

void Drawing::reload(const Request& expected, bool cameraAlone) {
    if (!cameraAlone) return load(*loaded_, expected);
    camera_ = cameraOf(*loaded_);
    if (backend_ == Backend::Gpu) return;
    reference::setEye(*truth_, loaded_->scene.camera.eye);
    truthCamera_ = reference::truthCamera(*loaded_);
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
    if (backend_ == Backend::Cpu) {
        facts.device = "CPU reference (double precision)";
        facts.driver = counted(defaultThreadCount(), "thread");
        facts.times.trace = hostSeconds_;
        return facts;
    }
    facts.device = device_->info().name;
    facts.driver = device_->info().driver;
    facts.traversal = render::nameOf(renderer_->traversal(methods_));
    facts.arithmetic = device_->arithmetic();
    facts.times = renderer_->times();
    return facts;
}

void Drawing::reportValidation(std::ostream& err) const {
    if (device_) app::reportValidation(*device_, choice_, err);
}

}  // namespace glint::app
