// The picture of the window: what must be traced next, in pieces short enough for the window to stay alive,
// and what there is to show by now. While the camera moves, whole coarse pictures; at rest the full picture
// band by band, then more samples, then nothing.
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "gpu/device.h"
#include "render/renderer.h"
#include "view/canvas.h"
#include "view/layers.h"
#include "view/pace.h"
#include "view/view_scene.h"

namespace glint::view {

struct LightSetting {
    bool on = true;
    float dim = 1;  // times the scene's intensity
    bool operator==(const LightSetting&) const = default;
};

// What the panel changes and the picture depends on.
struct PictureSettings {
    ViewLayer layer = ViewLayer::Color;
    int maxDepth = 5;
    bool shadows = true;
    bool reflections = true;
    std::vector<LightSetting> lights;
    glm::vec3 background{0};
    int sampleLimit = 64;
    bool operator==(const PictureSettings&) const = default;

    static PictureSettings of(const Scene& scene);
    uint32_t depth() const { return reflections ? static_cast<uint32_t>(maxDepth) : 0u; }
};

struct FrameFacts {
    int width = 0, height = 0;  // traced
    double renderSeconds = 0;   // of the last piece of work
    double raysPerSecond = 0;   // camera and mirrored rays, while tracing
    render::StageTimes times;   // of the last piece of work
    int depth = 0;              // reflections followed
};

// Submissions of the window are short, so that a click waits for no more than one, and the work beside it
// takes turns with it on the device's queue.
render::Options windowOptions(const ViewScene& scene);

class Session {
  public:
    // Keeps a reference to `device`.
    Session(const gpu::Device& device, std::shared_ptr<const ViewScene> scene);

    const ViewScene& scene() const { return *scene_; }
    std::shared_ptr<const ViewScene> sharedScene() const { return scene_; }
    const PictureSettings& settings() const { return settings_; }
    void apply(const PictureSettings& settings);
    void setView(const Camera& camera, int width, int height);

    // What the panel's settings are to a tracer.
    Tracing tracing() const;
    shared::Camera packedCamera() const;
    int width() const { return width_; }
    int height() const { return height_; }

    // A coarse picture of the whole view at `scale` of its size. False if it was there already.
    bool renderMoving(double scale, int depth);
    // The next piece of the full picture, `seconds` long or so; `cancelled` as in Request. False if
    // there is nothing left to do.
    bool refine(double seconds, const std::function<bool()>& cancelled);
    bool finished() const;
    int samples() const { return samples_; }  // complete ones, of the full picture
    double progress() const;                  // of the sample at hand, 0..1

    // What there is to show, of the view's size. `version` grows whenever that changes.
    Canvas canvas(double exposure) const;
    uint64_t version() const { return version_; }
    // The full picture, once its first sample is there.
    const Picture* picture() const { return samples_ > 0 ? &full_ : nullptr; }
    const FrameFacts& facts() const { return facts_; }
    const render::StageTimes& times() const { return renderer_.times(); }

    // What `glint trace --pixel x,y` answers for a picture of the view's size.
    PixelData pixel(int x, int y);

  private:
    void restart();
    Picture render(int width, int height, const Region& region, const glm::dvec2& offset, int depth,
                   const std::function<bool()>& cancelled);
    void addBand(const Picture& band);

    const gpu::Device& device_;
    std::shared_ptr<const ViewScene> scene_;
    render::Renderer renderer_;
    PictureSettings settings_;
    Camera camera_;
    int width_ = 0, height_ = 0;

    Picture coarse_;  // the last moving picture; stands in for rows that are not there yet
    bool coarseCurrent_ = false;
    Picture full_;  // mean of `samples_` samples, of one more above nextRow_
    std::vector<float> sum_;
    int samples_ = 0;
    int nextRow_ = 0;
    double secondsPerPixel_ = 0;  // of refine()
    uint64_t version_ = 0;
    FrameFacts facts_;
};

// The k-th sample's place in its pixel: the centre, then Halton's points in bases 2 and 3 (Halton 1964),
// whose every first part is spread evenly, so that the mean is a fair picture whenever one looks.
glm::dvec2 progressiveOffset(int k);

}  // namespace glint::view
