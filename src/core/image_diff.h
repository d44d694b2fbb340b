// How far apart two images are.
#pragma once

#include <cstdint>
#include <vector>

#include "core/image.h"

namespace glint {

struct PixelDifference {
    int x = 0;
    int y = 0;
    float difference = 0;  // greatest absolute channel difference, see ImageDifference::max
    bool operator==(const PixelDifference&) const = default;
};

// Rousselle, Knaus, Zwicker, "Adaptive Sampling and Reconstruction using Greedy Error Minimization", ACM TOG
// 30(6), 2011.
inline constexpr double kRelativeFloor = 1e-2;

struct ImageDifference {
    double rmse = 0;  // root mean square over all channels of all pixels that are finite in both
    // Mean over the same of (B - A)^2 / (A^2 + kRelativeFloor), A being the truth.
    double relMse = 0;
    double psnr = 0;         // 20 log10(1 / rmse), in dB for a fixed peak of 1; +inf for equal images
    double max = 0;          // greatest absolute channel difference; +inf if a sample is not finite in one
                             // image and is finite, or not finite in another way, in the other
    double mean = 0;         // mean signed difference B - A, the bias
    uint64_t pixels = 0;     // pixels compared
    uint64_t above = 0;      // pixels with a channel difference above the tolerance
    uint64_t notFinite = 0;  // pixels that are not finite in exactly one of the images
    std::vector<PixelDifference> worst;  // the worst pixels, worst first, then by y, x; only differing ones
};

// Compares colours channel by channel (the first min(3, channels) ones), linear, unclamped. A grey image (1
// channel) compares against each channel of a colour one. `tolerance` >= 0. Throws Error(Failed) if the
// sizes, or the numbers of channels otherwise, differ. Two NaN are equal, and so are two equal infinities.
ImageDifference compareImages(const Image& a, const Image& b, double tolerance, size_t worstCount = 10);

// An image of |a - b|, 3 channels, scaled by `gain`.
Image differenceImage(const Image& a, const Image& b, float gain = 1.0f);

// The structural similarity index of Z. Wang, A. C. Bovik, H. R. Sheikh, E. P. Simoncelli, "Image quality
// assessment: from error visibility to structural similarity", IEEE Transactions on Image Processing 13(4),
// 2004: 1 for equal images. It compares the luma (Rec. 601, as there) of the images as displayed,
// sRGB-encoded and cut off at 0 and 1. Its windows have 11 x 11 pixels, a Gaussian with a deviation of 1.5,
// and lie inside the image; K1 = 0.01, K2 = 0.03. Samples that are not finite count as 0. NaN for images with
// a side shorter than a window. Throws Error(Failed) if the sizes differ.
double structuralSimilarity(const Image& a, const Image& b);

}  // namespace glint
