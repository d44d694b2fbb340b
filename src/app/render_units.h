// Pictures of `glint render` that are drawn unit by unit (farm/unit_result.h).
#pragma once

#include <iosfwd>
#include <string>

#include "app/render_options.h"

namespace glint::app {

// Throws Error(Argument) if --error was asked for; `manner` says how the picture is drawn.
void refuseErrorTarget(const RenderCommand& command, const std::string& manner);

// --part: one part of a picture into a file of its own.
int renderPart(const RenderCommand& command, std::ostream& out, std::ostream& err);

// --checkpoint: units that are finished are kept, and an interrupted picture goes on from them.
int renderFromCheckpoint(const RenderCommand& command, std::ostream& out, std::ostream& err);

// --join: with other processes, by a folder.
int renderTogether(const RenderCommand& command, std::ostream& out, std::ostream& err);

}  // namespace glint::app
