// Two of the Standard Procedural Databases, against what their author counted (E. Haines, Readme 3.14): of
// 513 x 513 eye rays 49,788 hit something in tetra, 173,125 in mount; the others fill the picture.
#include <numeric>
#include <sstream>

#include "app/cli.h"
#include "core/image_io.h"
#include "support/support.h"

namespace glint::test::databases_test {
class Databases : public WorkingFolderTest {
  protected:
    // The part of the picture that is covered, with nx x nx rays.
    double coverage(const std::string& name) {
        std::ostringstream out, err;
        const int code = app::run({"render", assetPath("spd/" + name).string(), "--backend", "cpu", "--size",
                                   "171x171", "--max-depth", "0", "--aov", "alpha", "-o", "a.pfm"},
                                  out, err);
        EXPECT_EQ(code, 0) << err.str();
        if (code != 0) return -1;
        const Image image = readImage(*names().begin());
        const double sum = std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0);
        return sum / static_cast<double>(image.pixels.size());
    }
};

// "should all be within about 10%": the edges of 4096 triangles are cut by a ninth of the rays here.
TEST_F(Databases, AsManyRaysHitAsTheirAuthorCounted) {
    EXPECT_NEAR(coverage("tetra.nff"), 49788.0 / 263169, 0.02 * 49788.0 / 263169);
    EXPECT_NEAR(coverage("mount.nff"), 173125.0 / 263169, 0.02 * 173125.0 / 263169);
    EXPECT_EQ(coverage("balls.nff"), 1);
    EXPECT_EQ(coverage("rings.nff"), 1);
}

}  // namespace glint::test::databases_test
