// Rays and hits that both sides of the comparison exchange.
#pragma once

#include <cstdint>
#include <ctime>
#include <glm/glm.hpp>

namespace glint::bench {

struct BenchRay {
    glm::vec3 origin{0};
    float tMin = 0;
    glm::vec3 direction{0};
    float tMax = -1;  // below tMin: no ray
};

struct BenchHit {
    bool hit = false;
    float t = 0;
    uint32_t id = 0;  // of the primitive in the scene, the same on both sides
};

// Seconds on the clock, and of all of the process's threads: the second is what a busy machine spoils least.
struct Timing {
    double wall = 0, cpu = 0;
};

class Timer {
  public:
    Timer() : wall_(now(CLOCK_MONOTONIC)), cpu_(now(CLOCK_PROCESS_CPUTIME_ID)) {}
    Timing elapsed() const { return {now(CLOCK_MONOTONIC) - wall_, now(CLOCK_PROCESS_CPUTIME_ID) - cpu_}; }

  private:
    static double now(clockid_t clock) {
        timespec t{};
        clock_gettime(clock, &t);
        return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
    }
    double wall_, cpu_;
};

}  // namespace glint::bench
