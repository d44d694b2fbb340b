// Elapsed processor time.
#pragma once

#include <ctime>

namespace glint {

// Processor time of all threads of the process since construction. Other work of the machine affects it
// least.
class ProcessorWatch {
  public:
    double seconds() const { return now() - start_; }

  private:
    static double now() {
        timespec time{};
        clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
        return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
    }
    double start_ = now();
};

}  // namespace glint
