// The image of the window: a coarse one while the camera moves, samples that accumulate at rest, all layers.
#pragma once

#include <functional>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "converge/replicates.h"
#include "gpu/device.h"
#include "pack/pack_samples.h"
#include "render/renderer.h"
#include "view/display.h"
#include "view/settings.h"
#include "view/view_scene.h"

namespace glint::view {

class Pace {
  public:
    explicit Pace(double targetSeconds) : target_(targetSeconds) {}

    void setTarget(double seconds) { target_ = seconds; }

    // A frame of `pixels` took `renderSeconds` to trace, and everything else `otherSeconds`.
    void measured(double pixels, double renderSeconds, double otherSeconds);

    // Width and height to render, as a part of those of a window of `fullPixels`: kLeast..1.
    double scale(double fullPixels) const;
    // Reflections to follow out of `full`: fewer once the resolution has had to fall.
    // In glass at least kGlassDepth: a ray that is not followed through glass is black.
    int depth(int full, double fullPixels, bool glass = false) const;

    static constexpr int kGlassDepth = 3;  // into an object, one reflection within, and out of it

    static constexpr double kLeast = 0.125;

  private:
    double target_;
    double secondsPerPixel_ = 0;  // 0: nothing measured yet
    double other_ = 0;
};

// One line for the panel: "error <= 0.012, 24 samples; until 0.003".
std::string inWords(const converge::State& state, double error);

// ---- the image ----

struct FrameFacts {
    int width = 0, height = 0;  // traced
    int depth = 0;              // reflections followed
    double renderSeconds = 0;   // of the last piece of work, without compiling
    double raysPerSecond = 0;   // camera and mirrored rays, while tracing
};

// Submissions of the window are short, so that a click waits for at most one, and background work takes turns
// with it on the device's queue.
render::Options windowOptions(const ViewScene& scene);

class Session {
  public:
    // Keeps a reference to `device`.
    Session(const gpu::Device& device, std::shared_ptr<const ViewScene> scene);

    const gpu::Device& device() const { return device_; }
    const std::shared_ptr<const ViewScene>& scene() const { return scene_; }
    const PictureSettings& settings() const { return settings_; }
    // Keeps the traced samples if the change does not concern them.
    void apply(const PictureSettings& settings);
    void setView(const Camera& camera, int width, int height);

    // The whole view, with one sample in the centre of each pixel.
    Request request() const { return requestFor(width_, height_, false); }
    // Upper bound of the memory per pixel of a view's images and their display, for a device that is the
    // processor too. It counts the full and the coarse image with their source data. It also counts displayed
    // colours here, in the window and in up to four images of its swapchain.
    static constexpr uint64_t bytesPerPixel() {
        return 2 * (4 * sizeof(float) + 1 + sizeof(PixelData)) + 4 * sizeof(float) + 6 * sizeof(uint32_t);
    }
    int width() const { return width_; }
    int height() const { return height_; }
    bool contains(int x, int y) const { return x >= 0 && y >= 0 && x < width_ && y < height_; }

    // A coarse image of the whole view at `scale` of its size. False if it is there already, or the full one.
    bool renderMoving(double scale, int depth);
    // The next piece of the full image, about `seconds` long; `cancelled` as in Request. False if there is
    // nothing left to do. The pass that brings all layers, from the centres of the pixels, is the second one,
    // or the first if the layer that is shown needs it.
    bool refine(double seconds, const std::function<bool()>& cancelled);
    bool finished() const;
    bool ready() const;                        // a full image of the layer that is shown
    bool hasData() const { return hasData_; }  // of every pixel, for all layers but the colour
    int samples() const { return samples_; }   // complete ones, of the colour
    double progress() const;                   // of the pass at hand, 0..1
    // The state of the error target; without rounds before the first look, and always without `unseen`.
    converge::State goal() const { return goal_ ? goal_->state : converge::State(); }

    // The image to show, of the view's size. `version` grows whenever that changes.
    Canvas canvas(const Display& display) const;
    LayerRange range() const;  // that its colours stand for
    uint64_t version() const { return version_; }
    // The full image: its colour once samples() > 0, its data once hasData().
    const Picture& picture() const { return full_; }
    const Camera& camera() const { return camera_; }
    // The samples that its colour is the mean of; before the first, that one.
    PackedSamples taken() const;
    const FrameFacts& facts() const { return facts_; }
    const render::StageTimes& times() const { return renderer_.times(); }

    // The answer of `glint trace --pixel x,y` for a picture of the view's size.
    PixelData pixel(int x, int y);

  private:
    void restart();
    Tracing tracing() const;
    Request requestFor(int width, int height, bool data) const;
    Picture render(const Request& request);
    ImageSettings progressiveSampling() const;
    std::optional<SampleSequence> sequence() const;  // empty: progressiveOffset does
    void beginPass();
    void endPass();
    Request nextPiece(double seconds) const;
    void addBand(const Picture& band);
    bool coarseShown() const;  // coarse_ is of this view and has the layer
    bool enough() const;       // samples
    // False if there is nothing to look at; takes `seconds` at most.
    bool lookAtError(double seconds);
    void askForRounding();

    const gpu::Device& device_;
    std::shared_ptr<const ViewScene> scene_;
    render::Renderer renderer_;
    PictureSettings settings_;
    Camera camera_;
    int width_ = 0, height_ = 0;

    Picture coarse_;  // the last moving image; stands in for rows that are not there yet
    bool coarseIsCurrent_ = false;
    Picture full_;  // mean of `samples_` samples, of those at hand too above nextRow_
    std::vector<float> sum_;
    std::optional<SampleSequence> sequence_;    // of samples that differ from pixel to pixel
    PackedSamples colorPass_;                   // samples of the colour's pass at hand
    std::optional<converge::Replicates> goal_;  // of the image at hand, with an error in the settings
    std::optional<double> rounding_;            // ErrorBudget::rounding of the view
    std::future<double> findsRounding_;         // of the view that had this number
    uint64_t roundingView_ = 0, view_ = 0;
    int samples_ = 0, nextRow_ = 0;
    bool hasData_ = false, colorBegun_ = false;
    bool passHasData_ = false;    // the pass at hand brings all layers but the colour
    double secondsPerPixel_ = 0;  // of refine()
    uint64_t version_ = 0;
    FrameFacts facts_;
};

// The k-th sample's place in its pixel: the centre, then Halton's points in bases 2 and 3 (Halton 1964),
// whose every first part is spread evenly, so that the mean is a fair picture whenever one looks.
glm::dvec2 progressiveOffset(int k);

}  // namespace glint::view
