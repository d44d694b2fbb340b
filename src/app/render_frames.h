// `glint render --frames`: the pictures of an animation.
#pragma once

#include <iosfwd>

#include "app/render_options.h"

namespace glint::app {

int renderFrames(const RenderCommand& command, std::ostream& out, std::ostream& err);

}  // namespace glint::app
