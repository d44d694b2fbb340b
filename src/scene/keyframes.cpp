#include "scene/keyframes.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace glint {

namespace {

using Value = std::vector<double>;

Value keyValue(const Keyframes& keyframes, size_t key) {
    const size_t middle = keyframes.interpolation == Interpolation::Cubic ? keyframes.components : 0;
    const auto first =
        keyframes.values.begin() + static_cast<std::ptrdiff_t>(key * keyframes.stride() + middle);
    return {first, first + static_cast<std::ptrdiff_t>(keyframes.components)};
}

double dot(const Value& a, const Value& b) {
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

void normalize(Value& quaternion) {
    const double length = std::sqrt(dot(quaternion, quaternion));
    for (double& c : quaternion) c /= length;
}

Value mix(const Value& a, double wa, const Value& b, double wb) {
    Value result(a.size());
    for (size_t i = 0; i < a.size(); ++i) result[i] = wa * a[i] + wb * b[i];
    return result;
}

// Spherical linear interpolation along the shorter arc (K. Shoemake, "Animating Rotation with Quaternion
// Curves", SIGGRAPH 1985; glTF 2.0, appendix C.4). a, b: unit.
Value slerp(const Value& a, const Value& b, double t) {
    const double cosine = dot(a, b);
    const double sign = cosine < 0 ? -1 : 1;
    const double angle = std::acos(std::min(1.0, sign * cosine));
    // Below this the arc and its chord differ by less than 1e-13 of it.
    if (angle < 1e-6) return mix(a, 1 - t, b, sign * t);
    return mix(a, std::sin(angle * (1 - t)) / std::sin(angle), b,
               sign * std::sin(angle * t) / std::sin(angle));
}

// Cubic Hermite spline, glTF 2.0, appendix C.5.
Value spline(const Keyframes& k, size_t key, double t, double seconds) {
    const double t2 = t * t, t3 = t2 * t;
    const size_t n = k.components;
    const double* from = &k.values[key * k.stride()];
    const double* to = from + k.stride();
    Value result(n);
    for (size_t i = 0; i < n; ++i)
        result[i] = (2 * t3 - 3 * t2 + 1) * from[n + i] + seconds * (t3 - 2 * t2 + t) * from[2 * n + i] +
                    (-2 * t3 + 3 * t2) * to[n + i] + seconds * (t3 - t2) * to[i];
    return result;
}

Value between(const Keyframes& keyframes, size_t key, double time) {
    const double seconds = keyframes.times[key + 1] - keyframes.times[key];
    const double t = (time - keyframes.times[key]) / seconds;
    if (keyframes.interpolation == Interpolation::Cubic) return spline(keyframes, key, t, seconds);
    Value a = keyValue(keyframes, key);
    if (keyframes.interpolation == Interpolation::Step) return a;
    Value b = keyValue(keyframes, key + 1);
    if (!keyframes.rotation) return mix(a, 1 - t, b, t);
    normalize(a);
    normalize(b);
    return slerp(a, b, t);
}

}  // namespace

size_t zeroRotation(const Keyframes& keyframes) {
    size_t key = 0;
    for (; key < keyframes.times.size(); ++key)
        if (const Value value = keyValue(keyframes, key); !(dot(value, value) > 0)) break;
    return key;
}

std::vector<double> valueAt(const Keyframes& keyframes, double time) {
    const auto& times = keyframes.times;
    const auto after = std::upper_bound(times.begin(), times.end(), time);
    Value value;
    if (after == times.begin())
        value = keyValue(keyframes, 0);
    else if (after == times.end() || *(after - 1) == time)
        value = keyValue(keyframes, static_cast<size_t>(after - times.begin()) - 1);
    else
        value = between(keyframes, static_cast<size_t>(after - times.begin()) - 1, time);
    if (keyframes.rotation) normalize(value);
    return value;
}

}  // namespace glint
