// `mpirun glint render`: one image by all processes that the launcher started (farm/ranks.h).
#pragma once

#include <iosfwd>

#include "app/exit_code.h"
#include "app/render_options.h"

namespace glint::app {

// True if an MPI launcher started several processes for this image. Throws Error(Argument) for options that
// exclude it.
bool isForRanks(const RenderCommand& command);
ExitCode renderAmongRanks(const RenderCommand& command, std::ostream& out, std::ostream& err);

// This process among those of an MPI launcher; 0 without one.
int rankOfLauncher();
// Ends all ranks with this exit code; does nothing without ranks.
void abortRanks(int exitCode);
// True if the module for MPI is installed.
bool hasRanksModule();

}  // namespace glint::app
