// Messages by MPI.
#pragma once

#include <memory>
#include <optional>

#include "farm/transport.h"

namespace glint::farm {

// The rank of this process, from the environment that an MPI launcher sets. Empty without a launcher, or if
// this is its only process.
std::optional<int> launchedRank();

// True if openMpi() finds the module glint-mpi.so.
bool hasMpiModule();

// Joins the other processes. Throws Error(Failed) without the module, or with MPI's own error.
std::unique_ptr<Transport> openMpi();

// Ends all processes with this exit code if openMpi() has joined them and they have not finished; otherwise
// does nothing.
void abortMpi(int exitCode);

}  // namespace glint::farm
