// Quantities by which a pixel's two answers are compared: the colour, and the layers of the first hit.
#pragma once

#include <array>

#include "reference/tracer.h"
#include "trace/picture.h"

namespace glint::verify {

// Colour (3), then of the first hit depth, position (3), shading normal (3), geometric normal (3), u, v, and
// the bits of the lights that are hidden from it, which nothing may add to.
inline constexpr size_t kColorQuantities = 3, kQuantities = 16;
using Quantities = std::array<double, kQuantities>;

Quantities quantitiesOf(const reference::PixelRecord& record, const glm::dvec3& origin);
Quantities quantitiesOf(const glm::vec3& color, const PixelData& data);

// Rounding error that arithmetic may add to each quantity for a given ray and hit; for the colour
// PixelRecord::rounding. `ray`: the camera's.
Quantities floorsOf(const PackedScene& scene, const reference::PixelRecord& record,
                    const reference::Ray& ray);

// Units of 2^-24 by which fp32 may turn the normal of the hit.
double normalTurn(const PackedScene& scene, const reference::PixelRecord& record, const reference::Ray& ray);

// True if rays that leave the first hit start as far from it as rounding demands.
bool beginsClear(const PackedScene& scene, const reference::PixelRecord& record, const reference::Ray& ray,
                 const PixelData& device);

// The smallest box of quantities seen.
struct Hull {
    Quantities lo, hi;
    explicit Hull(const Quantities& q) : lo(q), hi(q) {}
    void include(const Quantities& q);
    // Each quantity within floors + `stretch` times the box's size of the box; NaN never is.
    bool contains(const Quantities& q, const Quantities& floors, double stretch) const;
};

}  // namespace glint::verify
