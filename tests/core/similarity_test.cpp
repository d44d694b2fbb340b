// SSIM beside values of another program, and cases that follow by hand.
#include "core/similarity.h"

#include <cmath>
#include <limits>

#include "core/error.h"
#include "support/support.h"

namespace glint::similarity_test {
struct Pair {
    Image a, b;
};

Pair wavesOf(int width, int height, double change) {
    Pair pair{Image(width, height, 3), Image(width, height, 3)};
    for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
            for (int c = 0; c < 3; ++c) {
                const double a = 0.5 + 0.45 * std::sin(0.7 * x + 0.3 * y + c);
                const double b = a + change * std::cos(1.3 * x) * std::sin(0.9 * y - c) + 0.1 * change;
                pair.a.at(x, y, c) = static_cast<float>(a);
                pair.b.at(x, y, c) = static_cast<float>(b);
            }
        }
    }
    return pair;
}

// The values of scikit-image 0.19.3 (Debian 12): structural_similarity(X, Y, gaussian_weights=True,
// sigma=1.5, use_sample_covariance=False, data_range=1) of the encoded pictures' luma. At 0.6 much is cut
// off.
TEST(StructuralSimilarity, IsThatOfScikitImage) {
    const struct {
        double change, ssim;
    } table[] = {{0, 1}, {0.02, 0.998713679500}, {0.1, 0.968213670519}, {0.6, 0.583539853361}};
    for (const auto& row : table) {
        const Pair pair = wavesOf(24, 20, row.change);
        EXPECT_NEAR(structuralSimilarity(pair.a, pair.b), row.ssim, 1e-9) << row.change;
        EXPECT_NEAR(structuralSimilarity(pair.b, pair.a), row.ssim, 1e-9) << row.change;
    }
}

// More rows of windows than are worked on at a time: 192, in three bands.
TEST(StructuralSimilarity, BandsAreOnePicture) {
    const Pair tall = wavesOf(12, 202, 0.1);
    const auto part = [&](const Image& whole, int y0, int y1) {
        Image image(whole.width, y1 - y0, 3);
        for (int y = y0; y < y1; ++y)
            for (int x = 0; x < whole.width; ++x)
                for (int c = 0; c < 3; ++c) image.at(x, y - y0, c) = whole.at(x, y, c);
        return image;
    };
    // Windows 0 to 95 and 96 to 191.
    const double upper = structuralSimilarity(part(tall.a, 0, 106), part(tall.b, 0, 106));
    const double lower = structuralSimilarity(part(tall.a, 96, 202), part(tall.b, 96, 202));
    EXPECT_NEAR(structuralSimilarity(tall.a, tall.b), (upper + lower) / 2, 1e-12);
}

// Flat pictures have no structure: (2 x y + C1) / (x^2 + y^2 + C1) of their luma x and y.
TEST(StructuralSimilarity, OfFlatPicturesByHand) {
    const Image black(11, 11, 1, 0.0f), white(11, 11, 4, 1.0f), brighter(11, 11, 3, 7.0f);
    EXPECT_NEAR(structuralSimilarity(black, white), 1e-4 / (1 + 1e-4), 1e-12);
    EXPECT_NEAR(structuralSimilarity(brighter, white), 1, 1e-12) << "cut off at 1";
    Image hole = white;
    hole.at(5, 5, 1) = std::numeric_limits<float>::quiet_NaN();
    EXPECT_LT(structuralSimilarity(hole, white), 0.9);
    EXPECT_TRUE(std::isnan(structuralSimilarity(Image(10, 11, 3), Image(10, 11, 3))));
    EXPECT_THROW(structuralSimilarity(black, Image(12, 11, 3)), Error);
}

}  // namespace glint::similarity_test
