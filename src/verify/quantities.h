// Quantities by which a pixel's two answers are compared: the colour, and the layers of the first hit.
#pragma once

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "reference/rounding.h"
#include "reference/tracer.h"
#include "trace/picture.h"

namespace glint::verify {

using reference::kFloatUnit;

// Colour (3), then of the first hit depth, position (3), shading normal (3), geometric normal (3), u, v; the
// bits of hidden lights, object, primitive and material, which must agree; the distance from the hit at which
// further rays begin, which depends on the packing of a scene.
inline constexpr size_t kColorQuantities = 3, kSceneQuantities = 19, kQuantities = 20;
inline constexpr size_t kShadows = 15;  // index of the bits of hidden lights
using Quantities = std::array<double, kQuantities>;

// Error of fp32 numbers near 0: a device may take subnormal numbers for 0.
inline constexpr double kUnderflow = 0x1p-120;

Quantities quantitiesOf(const reference::PixelRecord& record, const glm::dvec3& origin);
Quantities quantitiesOf(const glm::vec3& color, const PixelData& data);
inline constexpr std::array<std::string_view, kQuantities> kQuantityNames = {
    "color",  "color",        "color",  "depth",           "position",        "position",        "position",
    "normal", "normal",       "normal", "geometricNormal", "geometricNormal", "geometricNormal", "u",
    "v",      "hiddenLights", "object", "primitive",       "material",        "clearance"};

// Rounding error that arithmetic may add to each quantity for a given ray and hit; for the colour
// PixelRecord::rounding. `ray`: the camera's.
Quantities floorsOf(const PackedScene& scene, const reference::PixelRecord& record,
                    const reference::Ray& ray);

// Magnitude of the sums behind the first hit's numbers, and turn of its normal, in units of 2^-24. slant: of
// a triangle 1 / the cosine between ray and normal, else 1. Rounding in the triangle test moves the edges
// sideways by units of the corners' distance. Along the ray, and in shares of the triangle, the move is
// larger by `slant`.
struct Reach {
    double way, turn, slant;
};
Reach reachOf(const PackedScene& scene, const reference::PixelRecord& record, const reference::Ray& ray);

// The least box around vectors of numbers, with the rounding error of each number.
struct Box {
    std::vector<double> lo, hi, floors;

    Box(const Quantities& q, const Quantities& errors)
        : lo(q.begin(), q.end()), hi(lo), floors(errors.begin(), errors.end()) {}
    void add(const glm::dvec3& value, const glm::dvec3& error);
    void include(const Box& other);
    // True if the number at `at` lies within its floor, and `stretch` times the box's size, of the box. NaN
    // does not, unless the floor is infinite.
    bool contains(size_t at, double value, double stretch) const;
    // True of each number from `at` on.
    bool contains(size_t at, std::span<const double> values, double stretch) const;
    bool contains(size_t at, const glm::dvec3& value, double stretch) const {
        return contains(at, std::span(&value.x, 3), stretch);
    }
};

}  // namespace glint::verify
