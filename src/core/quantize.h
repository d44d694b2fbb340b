// From linear floats to the 8-bit samples of a PNG, and back.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image.h"

namespace glint {

// sRGB byte of a linear sample, IEC 61966-2-1:1999 section 5.2: 255 * encode(linear), rounded to the nearest.
// Below 0 (and -inf) gives 0, above 1 (and +inf) 255, NaN 0.
uint8_t srgbByte(float linear);

// Linear value of an sRGB-encoded one in [0, 1], the inverse of the encoding in srgbByte.
double linearFromSrgb(double encoded);

// sRGB encoding of a linear value in [0, 1], in [0, 1].
double srgbFromLinear(double linear);

// 255 * value rounded to the nearest and clamped; NaN gives 0. For alpha and data, which PNG holds without
// sRGB curve.
uint8_t linearByte(double value);

// Bytes of a colour image: the first three channels sRGB-encoded, a fourth (alpha) linear.
std::vector<uint8_t> quantizeColor(const Image& image);

// Bytes of a data layer: all channels together scaled from [min, max] of the finite samples to [0, 255].
// Infinity (the depth of a miss) becomes 255; -infinity, NaN and finite samples of one value become 0. Two
// channels get a third of zeros.
std::vector<uint8_t> quantizeData(const Image& image);

}  // namespace glint
