// Random movements of the size of rounding, see struct Jitter.
#pragma once

#include "reference/tracer.h"

namespace glint::reference {

// splitmix64: G. Steele, D. Lea, C. Flood, "Fast Splittable Pseudorandom Number Generators", OOPSLA 2014.
inline constexpr uint64_t kUniformStride = 0x9e3779b97f4a7c15u;
inline uint64_t randomWord(uint64_t& state) {
    state += kUniformStride;
    uint64_t z = state;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}
// In [-1, 1).
inline double uniform(uint64_t& state) {
    return static_cast<double>(randomWord(state) >> 11) * 0x1p-52 - 1;
}

// Moves rays as struct Jitter says.
class RayMover {
  public:
    explicit RayMover(const Jitter& jitter)
        : state_(jitter.seed),
          step_(jitter.ulps * 0x1p-24),
          formulas_(jitter.formulas),
          slips_(jitter.slips),
          units_(jitter.clears ? jitter.ulps : (slips_ > 1 ? slips_ : 0)) {}

    void move(Ray& ray, double scale) {
        if (step_ == 0) return;
        if (formulas_) ray.noise = {state_, step_};
        for (int i = 0; i < 3; ++i) ray.origin[i] += step_ * scale * next();
        turn(ray.direction, ray.directionScale);
    }

    void turn(glm::dvec3& direction, double scale) {
        if (step_ == 0) return;
        const double length = scale * glm::length(direction);
        for (int i = 0; i < 3; ++i) direction[i] += step_ * length * next();
    }

    // How far from its surface a ray begins, where the device's begin as far as `clearance`.
    double cleared(double clearance) const { return units_ * clearance; }

    double slips() const { return slips_; }

    bool moves() const { return step_ != 0; }
    double shift(double scale) { return step_ == 0 ? 0 : step_ * scale * next(); }
    // Something that has gone through `roundings`.
    double sway(double value, double roundings) {
        return step_ == 0 ? value : value * (1 + roundings * step_ * next());
    }

  private:
    double next() { return uniform(state_); }

    uint64_t state_;
    double step_;
    bool formulas_;
    double slips_;  // Jitter::slips
    double units_;  // of clearances
};

}  // namespace glint::reference
