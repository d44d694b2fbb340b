// `glint render --frames`: the pictures of an animation.
#pragma once

#include <iosfwd>

#include "app/exit_code.h"
#include "app/render_options.h"

namespace glint::app {

ExitCode renderFrames(const RenderCommand& command, std::ostream& out, std::ostream& err);

}  // namespace glint::app
