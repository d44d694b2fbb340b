// Long work beside the window: saving at full quality, verifying, loading. One thread each; the window asks
// now and then.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>

#include "core/image.h"
#include "gpu/device.h"
#include "view/session.h"

namespace glint::view {

struct JobControl {
    std::atomic<double> progress{0};
    std::atomic<bool> cancelled{false};
};

// At most one run at a time. Destruction cancels and waits. Each run ends with `wake`, on its own thread.
template <typename Result>
class Job {
  public:
    explicit Job(std::function<void()> wake) : wake_(std::move(wake)) {}
    ~Job() { stop(); }
    Job(const Job&) = delete;
    Job& operator=(const Job&) = delete;

    bool running() const { return future_.valid(); }
    double progress() const { return control_ ? control_->progress.load() : 0; }
    void start(std::function<Result(JobControl&)> work) {
        stop();
        control_ = std::make_unique<JobControl>();
        future_ = std::async(std::launch::async, [this, work = std::move(work), control = control_.get()] {
            Result result = work(*control);
            wake_();
            return result;
        });
    }
    bool finished() const {
        return future_.valid() && future_.wait_for(std::chrono::seconds(0)) == std::future_status::ready;
    }
    Result take() { return future_.get(); }  // or what it threw
    void stop() {
        if (!future_.valid()) return;
        control_->cancelled = true;
        future_.wait();
        future_ = {};
    }

  private:
    std::function<void()> wake_;
    std::unique_ptr<JobControl> control_;
    std::future<Result> future_;
};

// A view as it is when something is asked about it.
struct ViewRequest {
    std::shared_ptr<const ViewScene> scene;
    Tracing tracing;
    shared::Camera camera;
    bool lens = false;  // the camera has one
    int width = 0, height = 0;
};
ViewRequest viewRequest(const Session& session);

// A picture as `glint render` would draw it of the view, with the sampling that is set.
struct RenderRequest {
    ViewRequest view;
    std::filesystem::path file;  // .exr: every layer; else colour, by `display`
    ImageSettings sampling;      // its size is not used
    Display display;
};

// The picture that is on the screen.
struct SeenRequest {
    ViewRequest view;
    std::filesystem::path file;  // .exr: every layer, colour as radiance; else what is seen
    ViewLayer layer = ViewLayer::Color;
    Display display;
    // Present results; missing ones are traced with one sample in the middle of each pixel.
    std::optional<Canvas> canvas;  // as seen
    Picture picture;               // colour if samples > 0, data if hasData
    int samples = 0;
    bool hasData = false;
};
SeenRequest seenRequest(const Session& session, const std::filesystem::path& file, const Display& display);

// Draw and write. Return a line about it. A file that was claimed and could not be written is taken away
// again.
std::string save(const gpu::Device& device, const RenderRequest& request, JobControl& control);
std::string save(const gpu::Device& device, SeenRequest request, JobControl& control);

struct VerifyResult {
    bool passed = false;
    std::string text;  // one line
    Image difference;
};

// `glint verify` of the session's view.
VerifyResult verifyView(const gpu::Device& device, const ViewRequest& request, JobControl& control);

// The view's colours by the reference, of these samples. Throws Error(Failed) if it is stopped.
Image traceReference(const ViewRequest& request, const PackedSamples& samples, JobControl& control);

// STEM-view-001.png in `folder`, or the first number that is free; the file is there from now on, empty, so
// that nobody else takes the name. Throws Error(Failed) where no file can be made.
std::filesystem::path claimName(const std::filesystem::path& folder, const std::string& stem,
                                const std::string& extension);

}  // namespace glint::view
