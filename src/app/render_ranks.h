// `mpirun glint render`: one picture by all processes that the launcher started (farm/ranks.h).
#pragma once

#include <iosfwd>

#include "app/render_options.h"

namespace glint::app {

// True if a launcher of MPI has started this process and others, and the command draws one picture that they
// are to share. Throws Error(Argument) for what cannot be shared.
bool isForRanks(const RenderCommand& command);

int renderAmongRanks(const RenderCommand& command, std::ostream& out, std::ostream& err);

}  // namespace glint::app
