// Direction of a diffuse bounce.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>
#include <numbers>
#include <random>

namespace glint::bench {

// Cosine-weighted, about the unit `normal`.
inline glm::dvec3 bounceAbout(const glm::dvec3& normal, std::mt19937& random) {
    std::uniform_real_distribution<double> unit(0, 1);
    const double z = 2 * unit(random) - 1, angle = 2 * std::numbers::pi * unit(random);
    const double r = std::sqrt(std::max(0.0, 1 - z * z));
    return normal * 1.0001 + glm::dvec3(r * std::cos(angle), r * std::sin(angle), z);
}

}  // namespace glint::bench
