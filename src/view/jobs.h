// Long work beside the window: saving at full quality, verifying, loading. One thread each; the window asks
// now and then.
#pragma once

#include <atomic>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <string>

#include "core/image.h"
#include "gpu/device.h"
#include "view/session.h"

namespace glint::view {

struct JobControl {
    std::atomic<double> progress{0};
    std::atomic<bool> cancelled{false};
};

// At most one run at a time. Destruction cancels and waits.
template <typename Result>
class Job {
  public:
    Job() = default;
    ~Job() { stop(); }
    Job(const Job&) = delete;
    Job& operator=(const Job&) = delete;

    bool running() const { return future_.valid(); }
    double progress() const { return control_ ? control_->progress.load() : 0; }
    void start(std::function<Result(JobControl&)> work) {
        stop();
        control_ = std::make_unique<JobControl>();
        future_ = std::async(std::launch::async, std::move(work), std::ref(*control_));
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
    std::unique_ptr<JobControl> control_;
    std::future<Result> future_;
};

struct SaveRequest {
    std::filesystem::path file;  // .png: colour; .exr: every layer
    std::shared_ptr<const ViewScene> scene;
    Tracing tracing;
    shared::Camera camera;
    int width = 0, height = 0;
    int samplesPerPixel = 1;
    double exposure = 0;  // stops, of a PNG
};

// A request for the session's view.
SaveRequest saveRequest(const Session& session, const std::filesystem::path& file, int samplesPerPixel,
                        double exposure);

// Renders as `glint render` does and writes. Returns a line about it.
std::string save(const gpu::Device& device, SaveRequest request, JobControl& control);

struct VerifyResult {
    bool passed = false;
    std::string text;  // one line
    Image difference;
};

// `glint verify` of the session's view.
VerifyResult verifyView(const gpu::Device& device, SaveRequest request, JobControl& control);

// STEM-view-001.png in `folder`, or the first number that is free.
std::filesystem::path freeName(const std::filesystem::path& folder, const std::string& stem,
                               const std::string& extension);

}  // namespace glint::view
