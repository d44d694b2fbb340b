// Everything that a user may wish of an image of a scene: camera, size, samples, depth, methods, AOVs. A
// request is a plain value, made once from the command line, the window or a call, and given to either tracer
// with a packed scene. A wish never changes a scene; the window's panel also edits the scene itself
// (SceneEdits in view/settings.h). The moment of an animation chooses the scene (SceneReader). Settings of
// the device alone (traversal, access, slices ...) are in render::Options.
#pragma once

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "core/device_layout.h"
#include "scene/scene.h"
#include "trace/methods.h"
#include "trace/picture.h"

namespace glint {

// The samples of an image's pixels, as both tracers read them (docs/guide/sampling.md).
struct PackedSamples {
    // All pixels take the same samples, each of weight 1: their places in the pixel, in [0, 1)^2. Empty if
    // `rows` holds the samples.
    std::vector<glm::dvec2> offsets;
    // Two filter tables in place of the first shared::kFirstSample, then the samples.
    std::vector<shared::Sample> rows;
    // Samples are taken in rounds of this size; after each round a pixel stops unless it exceeds `threshold`.
    // Not adaptive: one round.
    uint32_t round = 1;
    std::optional<float> threshold;

    uint32_t count() const;  // of samples, if adaptive at the most
    bool scattered() const { return !rows.empty(); }
    // Sample `index` alone, with its weight, not adaptive.
    PackedSamples only(uint32_t index) const;
    // The same places in all pixels.
    static PackedSamples fixed(std::vector<glm::dvec2> offsets);
};

// Lights and background instead of the scene's, as the window's panel changes them.
struct Lighting {
    // Lights in the scene's local coordinates, as PackedScene::lights: the same kinds, and at most as many.
    std::vector<shared::Light> lights;
    glm::vec3 background{0};  // linear radiance; of a scene with an environment map: its factor
};

// Limits of a path's reflections and refractions.
struct PathLimits {
    // Reflections and refractions in a row; empty: the scene's (depthOf in pack/request_environment.h). A
    // device whose pipeline omits mirrors (render::Options::also) follows none.
    std::optional<uint32_t> depth = std::nullopt;
    // Reflected and refracted rays are followed if they can add more than this to any channel of a pixel's
    // colour (linear radiance). Picture::losses has the bound of the others. 0 follows all.
    double minContribution = 0;
};

// Settings of ray paths. Both tracers obey all but Methods::slabs and Methods::offsets, which only the device
// has.
struct Tracing {
    // The tests of rays with triangles and spheres; the defaults hold, the others show why they are needed.
    Methods methods = {};
    PathLimits limits = {};
    bool shadows = true;  // false: lights shine through everything
    std::optional<Lighting> lighting = std::nullopt;
};

// The most parts of an image (src/farm).
inline constexpr int kMostParts = 1 << 20;

// ImageSettings: the size of the whole image; sampler, filter, seed and adaptivity as the user wishes.
struct Request : ImageSettings, Tracing {
    // ---- which pixels ----
    Camera camera;
    Region region;  // cut off at the image's edges; all zero: everything
    // Samples of each pixel, packed from the settings and the camera (pack/pack_samples.h); default: its
    // centre. A thin lens needs scattered samples, or acts as a pinhole.
    PackedSamples samples = PackedSamples::fixed({{0.5, 0.5}});

    // ---- layers and other outputs ----
    bool data = false;    // Picture::data
    bool cost = false;    // PixelData::cost, which the reference always counts; implies data
    bool exact = false;   // Picture::exact, of the reference alone
    bool ledger = false;  // Picture::losses, which the reference always fills, and the device with
                          // minContribution too
    bool tally = false;   // the device's count of rays by class (Renderer::rays), which takes time there

    // ---- on the way ----
    // Called with the fraction done, 0..1, which never falls; from any thread, one call at a time.
    std::function<void(double)> progress;
    // Asked now and then, by the reference from all threads; true ends the picture early.
    std::function<bool()> cancelled;

    bool wantsData() const { return data || cost; }
    bool wantsLosses() const { return ledger || limits.minContribution > 0; }
};

// The pixels to render; empty if the region lies outside of the image.
Region regionOf(const Request& request);

// Upper bound: an adaptive image may take fewer.
uint64_t cameraRaysOf(const Request& request);

// A picture of the region with nothing done yet; each requested output has its size.
Picture blankPicture(const Request& request);

}  // namespace glint
