// The search for a rounding that turns the reference's answer into the device's.
#pragma once

#include "verify/quantities.h"
#include "verify/verify.h"

namespace glint::verify {

// The jitter, in units of 2^-24, that a float path of the device may have gone through where the reference
// took the path of `record`: see explain.cpp. instances: of a path that meets one.
double roundingBound(const PackedScene& scene, const reference::PixelRecord& record, bool instances);

// Whether the device's answer, of the reference's path, lies within the pixel's predicted error: the floors,
// and kResponseGain times what the reference's answer changes by for rays moved by one unit.
bool isPredicted(const reference::Tracer& tracer, const reference::Ray& cameraRay,
                 const reference::PixelRecord& still, const PackedScene& scene, const Quantities& device);

// Sets pixel.reason and pixel.ulps. pixel.reference has the path. persistently: by 64 times as many moves.
void explain(const reference::Tracer& tracer, const reference::Ray& cameraRay, const PackedScene& scene,
             const Quantities& device, DifferingPixel& pixel, bool persistently = false);

}  // namespace glint::verify
