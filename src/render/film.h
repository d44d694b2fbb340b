// Colours of a slice's pixels, from the path state.
#pragma once

#include "render/path_state.h"
#include "render/pipelines.h"

namespace glint::render {

// Fills color, done, notFinite and, if adaptive, samples of the slice's pixels.
void readFilm(const PathState& paths, const gpu::Device& device, const Slice& slice, const TraceModes& modes,
              Picture& picture);

}  // namespace glint::render
