// Messages by MPI.
#pragma once

#include <memory>
#include <optional>

#include "farm/transport.h"

namespace glint::farm {

// What a launcher of MPI says about this process in its environment.
struct Launched {
    int rank = 0, size = 1;
};
// Nothing if no launcher has started it, or it is the only one.
std::optional<Launched> launchedByMpi();

// Whether openMpi() has what it needs.
bool hasMpiModule();

// Joins the other processes. Throws Error(Failed) if glint has no module for MPI, or MPI says so.
std::unique_ptr<Transport> openMpi();

}  // namespace glint::farm
