// Values that change with time, as glTF 2.0 defines it (Khronos, glTF 2.0 Specification, appendix C).
#pragma once

#include <cstddef>
#include <vector>

#include "core/enum_names.h"

namespace glint {

// Between two keyframes: the earlier one's value; a straight line, or for rotations the shortest arc (slerp);
// a cubic spline with tangents that are given.
enum class Interpolation { Step, Linear, Cubic };
constexpr auto entriesOf(Interpolation) {
    return std::to_array<EnumEntry<Interpolation>>(
        {{Interpolation::Step, "step"}, {Interpolation::Linear, "linear"}, {Interpolation::Cubic, "cubic"}});
}

struct Keyframes {
    Interpolation interpolation = Interpolation::Linear;
    // Values are quaternions x, y, z, w of any length but 0; what comes of them has length 1.
    bool rotation = false;
    size_t components = 1;      // of a value, 1 and more; 4 of a rotation
    std::vector<double> times;  // seconds, strictly ascending, one and more
    // A value for each time. Cubic: the tangent in which the curve arrives, in units a second, the value, the
    // tangent in which it leaves.
    std::vector<double> values;

    // Numbers of a keyframe.
    size_t stride() const { return components * (interpolation == Interpolation::Cubic ? 3 : 1); }
};

// The first keyframe whose value, a rotation, is zero; the number of keyframes if none is.
size_t zeroRotation(const Keyframes& keyframes);

// The value at a time; before the first keyframe and after the last one it stays as it is there.
std::vector<double> valueAt(const Keyframes& keyframes, double time);

}  // namespace glint
