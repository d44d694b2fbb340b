// Every scene of the repository, pixel by pixel against the reference.
#include <algorithm>
#include <limits>

#include "reference/render.h"
#include "support.h"
#include "verify/verify.h"

namespace glint::render::test::scenes_test {
using glm::dvec3;

class SceneTest : public RenderTest, public testing::WithParamInterface<std::string> {
  protected:
    struct Counts {
        size_t ids = 0, hashes = 0, shadows = 0, colors = 0;
    };
    // Pixels that differ from the reference's; pixels that see the same primitive must agree in its material.
    static Counts compare(const Case& c, const Picture& device);
};

SceneTest::Counts SceneTest::compare(const Case& c, const Picture& device) {
    const Picture expected = reference::render(c.packed, c.camera, wholeWithData(c));
    Counts counts;
    for (int y = 0; y < c.height; ++y) {
        for (int x = 0; x < c.width; ++x) {
            const PixelData &data = device.at(x, y), &pixel = expected.at(x, y);
            const bool sameId = data.object == pixel.object && data.primitive == pixel.primitive;
            counts.ids += !sameId;
            counts.hashes += data.pathHash != pixel.pathHash || data.bounces != pixel.bounces;
            counts.shadows += data.shadowBits != pixel.shadowBits;
            const dvec3 color(device.color.at(x, y, 0), device.color.at(x, y, 1), device.color.at(x, y, 2));
            const dvec3 off = glm::abs(color - expected.exactAt(x, y));
            counts.colors += !(std::max({off.x, off.y, off.z}) <= 1.0 / 512);
            EXPECT_EQ(device.color.at(x, y, 3) > 0, data.object != PixelData::kNoIndex);
            if (!sameId) continue;
            EXPECT_EQ(data.material, pixel.material) << x << "," << y;
            if (data.object == PixelData::kNoIndex) {
                EXPECT_EQ(data.depth, std::numeric_limits<double>::infinity());
                EXPECT_EQ(data.shadowBits, 0u);
            }
        }
    }
    return counts;
}

TEST_P(SceneTest, AgreesWithTheReference) {
    const Case c = fileCase(GetParam(), 160, 120);
    Renderer renderer(device(), c.packed);
    const verify::Report report = verified(renderer, c);
    EXPECT_EQ(report.unexplained, 0u);
    EXPECT_TRUE(report.passed()) << report.explained() << " explained pixels of " << report.pixels;
    EXPECT_EQ(report.pixels, 160u * 120u);

    const Picture picture = draw(renderer, c);
    EXPECT_EQ(picture.notFinite, 0u);
    const Counts counts = compare(c, picture);
    // A pixel that verify passed over has the reference's path; and its colour, where no pixel's own
    // predicted error is larger than that of a byte.
    EXPECT_LE(counts.hashes, report.explained());
    EXPECT_LE(counts.ids, counts.hashes);
    if (report.sensitivity.kappa < 1e2) {
        EXPECT_LE(counts.colors, report.explained());
    }
    EXPECT_LE(static_cast<double>(counts.shadows), 160 * 120 / 1000);
    // A picture of nothing, or of one thing alone, would prove little.
    EXPECT_LT(std::count_if(picture.data.begin(), picture.data.end(),
                            [](const PixelData& d) { return d.object == PixelData::kNoIndex; }),
              160 * 120 * 3 / 4);
}

INSTANTIATE_TEST_SUITE_P(All, SceneTest, testing::ValuesIn(sceneNames()),
                         [](const auto& p) { return p.param; });

}  // namespace glint::render::test::scenes_test
