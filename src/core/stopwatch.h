// Elapsed wall time that no change of the system's clock can disturb.
#pragma once

#include <chrono>

namespace glint {

// Starts when constructed.
class Stopwatch {
  public:
    double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
    void restart() { start_ = Clock::now(); }

  private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point start_ = Clock::now();
};

}  // namespace glint
