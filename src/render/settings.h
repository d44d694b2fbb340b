// What the settings of a picture come to.
#pragma once

#include "pack/pack_samples.h"
#include "render/pipelines.h"
#include "render/renderer.h"
#include "trace/picture.h"

namespace glint::render {

Region wholeOrGiven(const RenderSettings& settings);
PackedSamples samplesOf(const RenderSettings& settings);
// `samples`: of these settings.
TraceModes modesOf(const RenderSettings& settings, const PackedSamples& samples);

}  // namespace glint::render
