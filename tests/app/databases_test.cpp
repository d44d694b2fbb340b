// Two of the Standard Procedural Databases, against what their author counted (E. Haines, Readme 3.14): of
// 513 x 513 eye rays 49,788 hit something in tetra, 173,125 in mount; the others fill the picture.
#include <numeric>
#include <optional>

#include "core/image_io.h"
#include "support.h"

namespace glint::app::test {
namespace {

namespace fs = std::filesystem;

class Databases : public FolderTest {
  protected:
    // The part of the picture that is covered, with nx x nx rays. Nothing if the file is not there.
    std::optional<double> coverage(const std::string& name) {
        const fs::path path = fs::path(GLINT_SOURCE_DIR) / "../shared/assets/spd" / name;
        if (!fs::exists(path)) return std::nullopt;
        const Ran ran = runGlint({"render", path.string(), "--backend", "cpu", "--size", "171x171",
                                  "--max-depth", "0", "--aov", "alpha", "-o", "a.pfm"});
        EXPECT_EQ(ran.code, 0) << ran.err;
        const Image image = readImage(*names().begin());
        const double sum = std::accumulate(image.pixels.begin(), image.pixels.end(), 0.0);
        return sum / static_cast<double>(image.pixels.size());
    }
};

// "should all be within about 10%": the edges of 4096 triangles are cut by a ninth of the rays here.
TEST_F(Databases, AsManyRaysHitAsTheirAuthorCounted) {
    const auto tetra = coverage("tetra.nff");
    if (!tetra) GTEST_SKIP() << "the folder ../shared/assets with the databases is not there";
    EXPECT_NEAR(*tetra, 49788.0 / 263169, 0.02 * 49788.0 / 263169);
    EXPECT_NEAR(*coverage("mount.nff"), 173125.0 / 263169, 0.02 * 173125.0 / 263169);
    EXPECT_EQ(*coverage("balls.nff"), 1);
    EXPECT_EQ(*coverage("rings.nff"), 1);
}

}  // namespace
}  // namespace glint::app::test
