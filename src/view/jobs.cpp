#include "view/jobs.h"

#include <algorithm>

#include "core/error.h"
#include "core/image_io.h"
#include "core/text_file.h"
#include "pack/pack_samples.h"
#include "reference/render.h"
#include "scene/sampling.h"
#include "view/window.h"

namespace glint::view {

void Job::start(std::function<Rest(JobControl&)> work) {
    stop();
    control_ = std::make_unique<JobControl>();
    future_ = std::async(std::launch::async, [work = std::move(work), control = control_.get()] {
        Rest rest = work(*control);
        Window::wake();
        return rest;
    });
}

bool Job::finished() const {
    return future_.valid() && future_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
}

void Job::stop() {
    if (!future_.valid()) return;
    control_->cancelled = true;
    future_.wait();
    future_ = {};
}

bool isExr(const std::filesystem::path& file) {
    return lowerExtension(file) == ".exr";
}

namespace {

// Every layer that an image of the window can have: all its pixels have the same number of samples, and it
// has no estimates of their error.
std::vector<Aov> allLayers() {
    std::vector<Aov> layers;
    for (const EnumEntry<Aov>& entry : kEnumEntries<Aov>)
        if (entry.value != Aov::Error && entry.value != Aov::Samples) layers.push_back(entry.value);
    return layers;
}

void addView(const ViewRequest& view, JobControl& control, Request& wanted) {
    static_cast<Tracing&>(wanted) = view.tracing;
    wanted.width = view.width;
    wanted.height = view.height;
    wanted.progress = [&](double fraction) { control.progress = fraction; };
    wanted.cancelled = [&] { return control.cancelled.load(); };
}

// The view by the device. Throws Error(Failed) if it is stopped.
Picture rendered(const ViewRequest& view, Request wanted, const std::filesystem::path& file,
                 JobControl& control) {
    addView(view, control, wanted);
    render::Renderer renderer(*view.device, view.scene->packed, windowOptions(*view.scene));
    Picture picture = renderer.render(view.camera, wanted);
    if (!picture.complete) throw Error(ErrorKind::Failed, "saving stopped: " + file.string());
    return picture;
}

std::string line(const std::filesystem::path& file, int width, int height, const std::string& how) {
    return "saved " + file.string() + " (" + std::to_string(width) + "x" + std::to_string(height) + ", " +
           how + ")";
}

}  // namespace

ViewRequest::ViewRequest(const Session& session)
    : device(&session.device()),
      scene(session.sharedScene()),
      tracing(session.tracing()),
      camera(session.packedCamera()),
      lens(hasLens(session.camera())),
      width(session.width()),
      height(session.height()) {}

std::string saveRendered(const ViewRequest& view, const std::filesystem::path& file,
                         const ImageSettings& sampling, const Display& display, JobControl& control) {
    const std::string conflict = samplingConflict(sampling);
    if (!conflict.empty()) throw Error(ErrorKind::Failed, "not saved: " + conflict);
    Request wanted = requestOf(sampling, view.lens);
    wanted.data = wanted.cost = isExr(file);
    Picture picture = rendered(view, wanted, file, control);
    if (!isExr(file)) applyDisplay(picture.color, display);
    writeLayers(file, makeLayers(picture, isExr(file) ? allLayers() : std::vector{Aov::Radiance}));
    return line(file, view.width, view.height,
                "samples per pixel: " + std::to_string(sampling.samplesPerPixel));
}

std::string saveLayers(const ViewRequest& view, const std::filesystem::path& file, Picture picture,
                       int samples, bool hasData, JobControl& control) {
    if (samples == 0 || !hasData) {
        Request wanted;
        wanted.data = wanted.cost = true;
        Picture traced = rendered(view, wanted, file, control);
        if (samples > 0) traced.color = std::move(picture.color);
        picture = std::move(traced);
    }
    writeLayers(file, makeLayers(picture, allLayers()));
    return line(file, view.width, view.height,
                "as seen: " + counted(static_cast<uint64_t>(std::max(samples, 1)), "sample"));
}

std::string saveCanvas(const std::filesystem::path& file, const Canvas& canvas, const std::string& how) {
    writeImage(file, toImage(canvas));
    return line(file, canvas.width, canvas.height, "as seen: " + how);
}

verify::Report verifyView(const ViewRequest& view, JobControl& control) {
    render::Renderer renderer(*view.device, view.scene->packed, windowOptions(*view.scene));
    verify::Options options;
    addView(view, control, options);
    return verify::verify(renderer, view.scene->packed, view.camera, options);
}

Image traceReference(const ViewRequest& view, const PackedSamples& samples, JobControl& control) {
    Request wanted;
    addView(view, control, wanted);
    wanted.samples = samples;
    Picture picture = reference::render(view.scene->packed, view.camera, wanted);
    if (!picture.complete) throw Error(ErrorKind::Failed, "the reference was stopped");
    return std::move(picture.color);
}

}  // namespace glint::view
