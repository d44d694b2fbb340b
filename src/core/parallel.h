// Host threads.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "core/context.h"

namespace glint {

// Threads if a caller requests 0: the number of processors that this process may run on, at least 1.
unsigned defaultThreadCount();

// Calls body(i) once for every i in [0, count), from up to context.threads threads, handing out indices one
// at a time in ascending order, and checks for cancellation before each. The first exception stops further
// indices and is rethrown here after all threads have ended.
void parallelFor(const Context& context, size_t count, const std::function<void(size_t)>& body);

// Runs the tasks, which do not depend on each other, as parallelFor does.
void parallelTasks(const Context& context, const std::vector<std::function<void()>>& tasks);

// Makes defaultThreadCount return `count` from now on; 0: the number of processors.
void limitThreads(unsigned count);

}  // namespace glint
