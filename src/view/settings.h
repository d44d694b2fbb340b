// What the panel changes and the picture depends on.
#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "scene/scene.h"
#include "trace/methods.h"
#include "view/layers.h"

namespace glint::view {

struct LightSetting {
    bool on = true;
    float dim = 1;  // times the intensity
    // As in scene.h; a kind of light has some of them.
    glm::dvec3 position{0}, direction{0, -1, 0};
    Color intensity{1};
    double angle = 30, penumbra = 0;
    bool operator==(const LightSetting&) const = default;

    static LightSetting of(const Light& light);
    // `light` with these values; what cannot be (no direction, a spot without width) stays as it was there.
    Light applied(const Light& light) const;
};

// ImageSettings but for the size, comparable.
struct SamplingSettings {
    int samplesPerPixel = 1;
    Sampler sampler = Sampler::Auto;
    Filter filter = Filter::Box;
    double filterRadius = 0.5;
    uint32_t seed = 0;
    bool adaptive = false;
    int maxSamples = 64;
    double threshold = 0.05;
    bool operator==(const SamplingSettings&) const = default;

    static SamplingSettings of(const ImageSettings& image);
    ImageSettings image(int width, int height) const;
};

// Until when the window takes samples: an error in place of a number (docs/design/error-targets.md).
struct ErrorSetting {
    double error = 0;  // linear radiance, root mean square over the picture; 0: a number of samples
    double confidence = 0.95;
    bool withinDepth = false;  // what lies beyond the depth is not counted
    bool operator==(const ErrorSetting&) const = default;
};

struct PictureSettings {
    ViewLayer layer = ViewLayer::Color;
    int maxDepth = 5;
    bool shadows = true;
    bool reflections = true;
    std::vector<LightSetting> lights;
    glm::vec3 background{0};
    Methods methods;
    SamplingSettings sampling;
    int sampleLimit = 64;  // of the picture in the window, unless `until` says it
    ErrorSetting until;
    bool operator==(const PictureSettings&) const = default;

    // As the file has them.
    static PictureSettings of(const Scene& scene);
    uint32_t depth() const { return reflections ? static_cast<uint32_t>(maxDepth) : 0u; }
    // After the file has changed: what was as in `before` is now as in `now`; what the user has moved stays.
    void follow(const PictureSettings& before, const PictureSettings& now);
};

// A multiple of 0.5 stops further, within kMostExposure.
double steppedExposure(double exposure, double step);

}  // namespace glint::view
