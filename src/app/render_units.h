// Images of `glint render` that are rendered unit by unit (farm/unit_result.h).
#pragma once

#include <iosfwd>
#include <string>

#include "app/exit_code.h"
#include "app/render_options.h"

namespace glint::app {

// Throws Error(Argument) if --error is given; `manner` names the option that excludes it.
void refuseErrorTarget(const RenderCommand& command, const std::string& manner);

// --part: renders one part into a file.
ExitCode renderPart(const RenderCommand& command, std::ostream& out, std::ostream& err);

// --checkpoint: keeps finished units, and resumes from them.
ExitCode renderFromCheckpoint(const RenderCommand& command, std::ostream& out, std::ostream& err);

}  // namespace glint::app
