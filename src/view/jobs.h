// Long work beside the window: loading, packing, saving, verifying, the reference image. One thread each.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <string>

#include "core/image.h"
#include "gpu/device.h"
#include "verify/verify.h"
#include "view/session.h"

namespace glint::view {

struct JobControl {
    std::atomic<double> progress{0};
    std::atomic<bool> cancelled{false};
};

// At most one run at a time. Destruction cancels and waits.
class Job {
  public:
    // The rest of the work, on the window's thread, with the result.
    using Rest = std::function<void()>;

    Job() = default;
    ~Job() { stop(); }
    Job(const Job&) = delete;
    Job& operator=(const Job&) = delete;

    // Stops an earlier run. Wakes the window when the work ends.
    void start(std::function<Rest(JobControl&)> work);
    bool running() const { return future_.valid(); }
    double progress() const { return control_ ? control_->progress.load() : 0; }
    bool finished() const;
    void finish() { future_.get()(); }  // Throws what the work threw.
    void stop();

  private:
    std::unique_ptr<JobControl> control_;
    std::future<Rest> future_;
};

// A view at the time of a command.
struct ViewRequest {
    explicit ViewRequest(const Session& session);

    const gpu::Device* device;
    std::shared_ptr<const ViewScene> scene;
    Tracing tracing;
    shared::Camera camera;
    bool lens;  // the camera has one
    int width, height;
};

bool isExr(const std::filesystem::path& file);

// Each save function returns a line about the file.

// Saves the image of `glint render` for the view with this sampling. EXR: every layer; else colour, by
// `display`.
std::string saveRendered(const ViewRequest& view, const std::filesystem::path& file,
                         const ImageSettings& sampling, const Display& display, JobControl& control);

// Saves every layer of the session's image as EXR. Missing ones are traced with one sample in the middle of
// each pixel. `picture`: colour if samples > 0, layers if `hasData`.
std::string saveLayers(const ViewRequest& view, const std::filesystem::path& file, Picture picture,
                       int samples, bool hasData, JobControl& control);

// Saves the bytes of the screen; `how`: what they show.
std::string saveCanvas(const std::filesystem::path& file, const Canvas& canvas, const std::string& how);

// `glint verify` of the view.
verify::Report verifyView(const ViewRequest& view, JobControl& control);

// The view's colours by the reference, of these samples. Throws Error(Failed) if it is stopped.
Image traceReference(const ViewRequest& view, const PackedSamples& samples, JobControl& control);

}  // namespace glint::view
