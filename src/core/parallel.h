// Host threads.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

namespace glint {

// Threads used when a caller asks for 0: the number of processors this process may run on, at least 1.
unsigned defaultThreadCount();

// Calls body(i) once for every i in [0, count), from up to `threads` threads (0: defaultThreadCount()),
// handing out indices one at a time in ascending order. The first exception thrown by a body stops further
// indices and is rethrown here after all threads have ended.
void parallelFor(size_t count, const std::function<void(size_t)>& body, unsigned threads = 0);

// While it lives, the threads that parallelFor starts for the thread that made it wait for its next call
// instead of ending: to start one costs as much as thousands of rays. Starts none itself; the innermost
// holds.
class KeptThreads {
  public:
    KeptThreads();
    ~KeptThreads();
    KeptThreads(const KeptThreads&) = delete;
    KeptThreads& operator=(const KeptThreads&) = delete;

    class Team;

  private:
    std::unique_ptr<Team> team_;
    Team* before_;
};

// Runs the tasks, which do not depend on each other, as parallelFor does.
void parallelTasks(const std::vector<std::function<void()>>& tasks, unsigned threads = 0);

}  // namespace glint
