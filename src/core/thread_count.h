// The number of host threads.
#pragma once

namespace glint {

// Makes defaultThreadCount (core/parallel.h) return `count` from now on; 0: the number of processors.
void limitThreads(unsigned count);

}  // namespace glint
