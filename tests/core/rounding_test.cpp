// The compiler must round where the program requires it. GCC 12.2 with -O2 or -O3 does not without
// -fno-tree-slp-vectorize: for a vector that goes to float and back to double it keeps the unrounded
// components.
#include <gtest/gtest.h>

#include <glm/glm.hpp>

namespace glint::rounding_test {
struct Floats {
    glm::vec3 origin, direction;
};
struct Doubles {
    glm::dvec3 origin, direction;
};

Floats rounded(const glm::dvec3& origin, const glm::dvec3& target) {
    const glm::vec3 from(origin);
    return {from, glm::vec3(target - glm::dvec3(from))};
}

// Out of line, so that the numbers are made in registers and read from memory.
[[gnu::noinline]] bool areFloats(const Doubles& d) {
    for (int i = 0; i < 3; ++i) {
        const volatile double numbers[] = {d.origin[i], d.direction[i]};
        for (const volatile double& x : numbers) {
            const volatile auto asFloat = static_cast<float>(x);
            if (static_cast<double>(asFloat) != x) return false;
        }
    }
    return true;
}

[[gnu::noinline]] bool roundTrip(const glm::dvec3& origin, const glm::dvec3& target) {
    const Floats f = rounded(origin, target);
    return areFloats({f.origin, f.direction});
}

TEST(Rounding, ToFloatAndBackIsKept) {
    EXPECT_TRUE(roundTrip({0.1, 0.2, 0.3}, {1.7, 2.3, 3.1}));
    EXPECT_TRUE(roundTrip({1e6 + 1 / 3.0, 1e-6, 0.7}, {-1 / 3.0, 7.3, 1e3 + 1 / 7.0}));
}

}  // namespace glint::rounding_test
