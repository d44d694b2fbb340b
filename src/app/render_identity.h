// Identity of an image of `glint render`: parts and checkpoints must agree on it.
#pragma once

#include "app/render_options.h"
#include "farm/identity.h"
#include "pack/loaded_scene.h"
#include "trace/request.h"

namespace glint::app {

// Version, files, settings; not which device draws, nor where files lie. `request` is the whole picture's.
farm::Identity identityOf(const RenderCommand& command, const LoadedScene& loaded, const Request& request);

}  // namespace glint::app
