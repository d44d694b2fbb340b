// What a picture of `glint render` is made from: parts of it, and what is left of an interrupted one, must
// agree on that.
#pragma once

#include "app/render_options.h"
#include "farm/identity.h"
#include "pack/loaded_scene.h"
#include "trace/request.h"

namespace glint::app {

// Version, files, settings; not which device draws, nor where files lie. `request` is the whole picture's.
farm::Identity identityOf(const RenderCommand& command, const LoadedScene& loaded, const Request& request);

}  // namespace glint::app
