// How alike two pictures look.
#pragma once

#include "core/image.h"

namespace glint {

// The structural similarity index of Z. Wang, A. C. Bovik, H. R. Sheikh, E. P. Simoncelli, "Image quality
// assessment: from error visibility to structural similarity", IEEE Transactions on Image Processing 13(4),
// 2004: 1 for equal pictures. Of luma (Rec. 601, as there) of the pictures as a screen shows them,
// sRGB-encoded and cut off at 0 and 1; windows of 11 x 11 pixels, Gaussian with a deviation of 1.5, that lie
// inside; K1 = 0.01, K2 = 0.03. Samples that are not finite count as 0. NaN for pictures of which a side is
// shorter than a window. Throws Error(Failed) if the sizes differ.
double structuralSimilarity(const Image& a, const Image& b);

}  // namespace glint
