// The search for a rounding that turns the reference's answer into the device's.
#pragma once

#include "verify/verify.h"

namespace glint::verify {

// The jitter, in units of 2^-24, that a float path of the device may have gone through: see explain.cpp.
double roundingBound(const PackedScene& scene, const reference::PixelRecord& record, const PixelData& device,
                     const Methods& methods = {});

// Sets pixel.reason and pixel.ulps.
void explain(const reference::Tracer& tracer, const reference::Ray& cameraRay, const PackedScene& scene,
             double tolerance, DifferingPixel& pixel);

}  // namespace glint::verify
