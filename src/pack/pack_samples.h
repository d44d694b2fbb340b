// The samples of a picture's pixels from its settings (docs/guide/sampling.md).
#pragma once

#include "scene/scene.h"
#include "trace/packed_samples.h"
#include "trace/request.h"

namespace glint {

// The samples that valid settings ask for; `lens`: the camera has one. A regular grid under the box filter of
// radius 0.5 comes as offsets, anything else as rows.
PackedSamples packSamples(const ImageSettings& image, bool lens);

// The whole picture that these settings ask for; everything else is the default.
Request requestOf(const ImageSettings& image, bool lens);

}  // namespace glint
