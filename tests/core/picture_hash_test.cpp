// The hash of a picture's bits.
#include "core/picture_hash.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace glint::picture_hash_test {
Image ramp() {
    Image image(3, 2, 4);
    for (size_t i = 0; i < image.pixels.size(); ++i) image.pixels[i] = 0.25f * static_cast<float>(i);
    return image;
}

// The value that XXH3's own tests state for no input at all.
TEST(PictureHash, IsXxh3) {
    EXPECT_EQ(pictureHash(Image(0, 0, 4)), "2d06800538d394c2");
}

TEST(PictureHash, ChangesWithAnyBitOfAColour) {
    const Image image = ramp();
    const std::string hash = pictureHash(image);
    EXPECT_EQ(hash.size(), 16u);
    EXPECT_EQ(pictureHash(ramp()), hash);
    for (size_t i = 0; i < image.pixels.size(); ++i) {
        if (i % 4 == 3) continue;
        Image other = image;
        other.pixels[i] = std::nextafter(other.pixels[i], 1e9f);
        EXPECT_NE(pictureHash(other), hash) << i;
    }
    Image negativeZero = image;
    negativeZero.pixels[0] = -0.0f;
    EXPECT_NE(pictureHash(negativeZero), hash);
}

TEST(PictureHash, AlphaDoesNotCount) {
    Image other = ramp();
    Image three(3, 2, 3);
    for (size_t pixel = 0; pixel < 6; ++pixel) {
        for (size_t c = 0; c < 3; ++c) three.pixels[3 * pixel + c] = other.pixels[4 * pixel + c];
        other.pixels[4 * pixel + 3] = -1;
    }
    EXPECT_EQ(pictureHash(other), pictureHash(ramp()));
    EXPECT_EQ(pictureHash(three), pictureHash(ramp()));
}

TEST(PictureHash, OrderOfPixelsCounts) {
    Image turned = ramp();
    std::swap_ranges(turned.pixels.begin(), turned.pixels.begin() + 12, turned.pixels.begin() + 12);
    EXPECT_NE(pictureHash(turned), pictureHash(ramp()));
}

}  // namespace glint::picture_hash_test
