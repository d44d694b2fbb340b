#include "scene/keyframes.h"

#include <gtest/gtest.h>

#include <cmath>

namespace glint::test::keyframes_test {
using Value = std::vector<double>;

Keyframes numbers(Interpolation interpolation, Value times, Value values) {
    return {interpolation, false, 1, std::move(times), std::move(values)};
}

TEST(Keyframes, StepLinearAndTheEnds) {
    const Keyframes step = numbers(Interpolation::Step, {1, 2, 4}, {10, 20, -4});
    const Keyframes linear = numbers(Interpolation::Linear, {1, 2, 4}, {10, 20, -4});
    for (const Keyframes& k : {step, linear}) {
        EXPECT_EQ(valueAt(k, -3), Value{10});
        EXPECT_EQ(valueAt(k, 1), Value{10});
        EXPECT_EQ(valueAt(k, 2), Value{20});
        EXPECT_EQ(valueAt(k, 4), Value{-4});
        EXPECT_EQ(valueAt(k, 99), Value{-4});
    }
    EXPECT_EQ(valueAt(step, 1.999), Value{10});
    EXPECT_EQ(valueAt(linear, 1.25), Value{12.5});
    EXPECT_EQ(valueAt(linear, 3), Value{8});
    EXPECT_EQ(valueAt(numbers(Interpolation::Linear, {5}, {7}), 2), Value{7});
}

TEST(Keyframes, EveryComponentByItself) {
    const Keyframes k = {Interpolation::Linear, false, 3, {0, 1}, {0, 1, 2, 4, 5, 10}};
    EXPECT_EQ(valueAt(k, 0.5), (Value{2, 3, 6}));
}

// A cubic polynomial is reproduced from its values and slopes, whatever the length of the segments.
TEST(Keyframes, CubicIsHermites) {
    const auto p = [](double t) { return 2 * t * t * t - 3 * t * t + t - 5; };
    const auto slope = [](double t) { return 6 * t * t - 6 * t + 1; };
    Keyframes k = numbers(Interpolation::Cubic, {-1, 0.5, 3}, {});
    for (const double t : k.times) k.values.insert(k.values.end(), {slope(t), p(t), slope(t)});
    for (double t = -1; t <= 3; t += 0.125) EXPECT_NEAR(valueAt(k, t)[0], p(t), 1e-13) << t;
    EXPECT_EQ(valueAt(k, -2)[0], p(-1));
    EXPECT_EQ(valueAt(k, 5)[0], p(3));
}

// Half way between two turns about one axis is the turn half way, at an even speed, the short way round.
TEST(Keyframes, RotationsGoAlongTheArc) {
    const auto turn = [](double degrees) {
        const double half = degrees * std::acos(-1.0) / 360;
        return Value{0, std::sin(half), 0, std::cos(half)};
    };
    for (const double end : {40.0, 170.0, 1e-6, -120.0}) {
        for (const double sign : {1.0, -1.0}) {
            Keyframes k = {Interpolation::Linear, true, 4, {0, 2}, turn(10)};
            for (const double c : turn(10 + end)) k.values.push_back(3 * sign * c);  // of any length
            for (const double t : {0.0, 0.5, 1.0, 1.7, 2.0}) {
                const Value expected = turn(10 + end * t / 2), got = valueAt(k, t);
                double dot = 0, length = 0;
                for (size_t i = 0; i < 4; ++i) dot += expected[i] * got[i], length += got[i] * got[i];
                EXPECT_NEAR(std::abs(dot), 1, 1e-12) << end << ' ' << t;
                EXPECT_NEAR(length, 1, 1e-12);
            }
        }
    }
}

TEST(Keyframes, CubicRotationsHaveLengthOne) {
    const Keyframes k = {Interpolation::Cubic, true, 4, {0, 1}, {0, 0, 0, 0, 0, 0, 0, 2, 1, 0, 0, 0,
                                                                 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0}};
    for (const double t : {0.0, 0.3, 0.5, 1.0}) {
        double length = 0;
        for (const double c : valueAt(k, t)) length += c * c;
        EXPECT_NEAR(length, 1, 1e-12);
    }
    EXPECT_EQ(valueAt(k, 0), (Value{0, 0, 0, 1}));
}

}  // namespace glint::test::keyframes_test
