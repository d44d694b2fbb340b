#include "view/settings.h"

#include <algorithm>

#include "scene/limits.h"

namespace glint::view {

namespace {

template <typename T>
void followOne(T& mine, const T& before, const T& now) {
    if (mine == before) mine = now;
}

void followLight(LightSetting& mine, const LightSetting& before, const LightSetting& now) {
    followOne(mine.position, before.position, now.position);
    followOne(mine.direction, before.direction, now.direction);
    followOne(mine.intensity, before.intensity, now.intensity);
    followOne(mine.angle, before.angle, now.angle);
    followOne(mine.penumbra, before.penumbra, now.penumbra);
}

void followSampling(SamplingSettings& mine, const SamplingSettings& before, const SamplingSettings& now) {
    followOne(mine.samplesPerPixel, before.samplesPerPixel, now.samplesPerPixel);
    followOne(mine.sampler, before.sampler, now.sampler);
    // A radius belongs to its filter.
    if (mine.filter == before.filter && mine.filterRadius == before.filterRadius) {
        mine.filter = now.filter;
        mine.filterRadius = now.filterRadius;
    }
    followOne(mine.seed, before.seed, now.seed);
    followOne(mine.adaptive, before.adaptive, now.adaptive);
    followOne(mine.maxSamples, before.maxSamples, now.maxSamples);
    followOne(mine.threshold, before.threshold, now.threshold);
}

}  // namespace

LightSetting LightSetting::of(const Light& light) {
    LightSetting s;
    std::visit([&](const auto& l) { s.intensity = l.intensity; }, light);
    if (const auto* point = std::get_if<PointLight>(&light)) s.position = point->position;
    if (const auto* sun = std::get_if<DirectionalLight>(&light)) s.direction = sun->direction;
    if (const auto* spot = std::get_if<SpotLight>(&light)) {
        s.position = spot->position;
        s.direction = spot->direction;
        s.angle = spot->angle;
        s.penumbra = spot->penumbra;
    }
    return s;
}

Light LightSetting::applied(const Light& light) const {
    Light result = light;
    std::visit([&](auto& l) { l.intensity = intensity; }, result);
    const bool turned = glm::length(direction) >= kMinLength;
    if (auto* point = std::get_if<PointLight>(&result)) point->position = position;
    if (auto* sun = std::get_if<DirectionalLight>(&result); sun != nullptr && turned)
        sun->direction = direction;
    if (auto* spot = std::get_if<SpotLight>(&result)) {
        spot->position = position;
        if (turned) spot->direction = direction;
        const double whole = angle + penumbra;
        if (angle >= 0 && penumbra >= 0 && whole >= kMinSpotAngle && whole <= 180) {
            spot->angle = angle;
            spot->penumbra = penumbra;
        }
    }
    return result;
}

SamplingSettings SamplingSettings::of(const ImageSettings& image) {
    SamplingSettings s;
    s.samplesPerPixel = image.samplesPerPixel;
    s.sampler = image.sampler;
    s.filter = image.filter;
    s.filterRadius = image.filterRadius;
    s.seed = image.seed;
    s.adaptive = image.adaptive.has_value();
    if (image.adaptive) {
        s.maxSamples = image.adaptive->maxSamples;
        s.threshold = image.adaptive->threshold;
    }
    return s;
}

ImageSettings SamplingSettings::image(int width, int height) const {
    ImageSettings image;
    image.width = width;
    image.height = height;
    image.samplesPerPixel = samplesPerPixel;
    image.sampler = sampler;
    image.filter = filter;
    image.filterRadius = filterRadius;
    image.seed = seed;
    if (adaptive) image.adaptive = AdaptiveSampling{maxSamples, threshold};
    return image;
}

PictureSettings PictureSettings::of(const Scene& scene) {
    PictureSettings s;
    s.maxDepth = scene.maxDepth;
    for (const Light& light : scene.lights) s.lights.push_back(LightSetting::of(light));
    s.background = glm::vec3(scene.environment ? scene.environment->intensity : scene.background);
    s.sampling = SamplingSettings::of(scene.image);
    return s;
}

void PictureSettings::follow(const PictureSettings& before, const PictureSettings& now) {
    followOne(maxDepth, before.maxDepth, now.maxDepth);
    followOne(background, before.background, now.background);
    followSampling(sampling, before.sampling, now.sampling);
    const std::vector<LightSetting> mine = std::move(lights);
    lights = now.lights;
    for (size_t i = 0; i < std::min({mine.size(), before.lights.size(), now.lights.size()}); ++i) {
        lights[i] = mine[i];
        followLight(lights[i], before.lights[i], now.lights[i]);
    }
}

double steppedExposure(double exposure, double step) {
    return std::clamp(exposure + step, -kMostExposure, kMostExposure);
}

}  // namespace glint::view
