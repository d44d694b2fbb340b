// The scenes of scenes/stiff, which one tolerance cannot serve, and scenes far from the origin.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <numbers>

#include "../render/support.h"
#include "import/load.h"
#include "support/support.h"
#include "verify/verify.h"

namespace glint::stability::stiff_test {
using namespace render::test;

class StiffTest : public RenderTest, public testing::WithParamInterface<std::string> {};

// Chaotic paths and coincident surfaces may differ in as many pixels as they like (docs/design/numerics.md
// 4), but each for a reason, and where the paths agree the colours must.
TEST_P(StiffTest, NothingIsUnexplained) {
    const Case c = fileCase("stiff/" + GetParam(), 160, 120);
    render::Renderer renderer(device(), c.packed);
    const verify::Report report = verified(renderer, c);
    std::cout << "[ measured ] " << GetParam() << ": kappa " << report.sensitivity.kappa << " ("
              << reference::stiffnessOf(report.sensitivity.kappa) << "), expected "
              << report.sensitivity.kappa * reference::kFloatUnit << ", p99 " << report.p99 << "; edges "
              << report.edges << ", unexplained " << report.unexplained << "; RMSE on the same paths "
              << report.rmseSamePath << '\n';
    EXPECT_EQ(report.unexplained, 0u);
    EXPECT_TRUE(report.passed()) << report.explained() << " of " << report.pixels;
    // Device and reference order coincident surfaces by the same rule.
    if (GetParam() == "coplanar_decals") {
        EXPECT_EQ(report.explained(), 0u);
    }
    const Picture picture = draw(renderer, c);
    EXPECT_EQ(picture.notFinite, 0u);
    EXPECT_GT(pixelsWithObject(picture), 160u * 120u / 10);
}

class PrismTest : public RenderTest {};

INSTANTIATE_TEST_SUITE_P(All, StiffTest, testing::ValuesIn(sceneNames("stiff")), sceneName);

// scenes/stiff/critical_prism.json against Snell and Fresnel in double: left of the threshold all is
// reflected, right of it the orange wall shines through by 1 - R, of a cosine that is the square root of what
// lies between angle and threshold. Along a row of pixels: the front lets 0.96 in.
TEST_F(PrismTest, TurnsInTheMiddle) {
    const Case c = fileCase("stiff/critical_prism", 320, 240);
    const Picture picture = draw(device(), c);
    const double step = 2 * std::tan(0.00225 / 2 * std::numbers::pi / 180) / 240,
                 critical = std::asin(1 / 1.5);
    // Transmitted by two faces; reflections inside add at most four terms of 0.04 to 0.06 each.
    const double plateau = picture.color.at(0, 120, 0), through = 0.96 * 0.96 * 0.05;
    EXPECT_GE(plateau, 0.999 * through);
    EXPECT_LE(plateau, through + 30 * 0.04 * 0.04 * 0.06);
    for (int x = 0; x < 320; ++x) {
        const float red = picture.color.at(x, 120, 0);
        const double angle = critical - (x - 159.5) * step / 1.5;
        // Angles inside are good to some units of 2^-24: 3 pixels.
        if (x < 157) {
            EXPECT_NEAR(red, plateau, 1e-5) << "all is reflected, at " << x;
        } else if (x >= 163) {
            const double cosine = std::cos(angle), after = std::sqrt(1 - std::pow(1.5 * std::sin(angle), 2));
            const double across = (1.5 * cosine - after) / (1.5 * cosine + after);
            const double along = (cosine - 1.5 * after) / (cosine + 1.5 * after);
            const double passed = 1 - (across * across + along * along) / 2;
            const double orange = 0.96 * 30 * passed, blue = plateau * (1 - passed);
            // The slope of a square root: half of the relative error of its argument.
            const double doubt = orange * 0.5 * 3 / (x - 159.5);
            EXPECT_NEAR(red, orange + blue, doubt + 1e-3) << x;
        }
        EXPECT_NEAR(red, picture.color.at(x, 10, 0), x > 156 && x < 163 ? 0.1 : 0.01) << "rows are alike";
    }
}

// A sheet of half a metre with waves of a millimetre, as a survey gives it, with its base in its numbers.
void writeSheet(const std::filesystem::path& path, const glm::dvec3& base) {
    constexpr int kSide = 40;
    std::ofstream file(path);
    file.precision(17);
    for (int y = 0; y <= kSide; ++y) {
        for (int x = 0; x <= kSide; ++x) {
            const double u = 0.5 * x / kSide, v = 0.5 * y / kSide;
            const double h = 0.001 * std::sin(60 * u) * std::cos(47 * v);
            file << "v " << base.x + u << ' ' << base.y + v << ' ' << base.z + h << '\n';
        }
    }
    for (int y = 0; y < kSide; ++y) {
        for (int x = 0; x < kSide; ++x) {
            const int a = y * (kSide + 1) + x + 1, b = a + kSide + 1;
            file << "f " << a << ' ' << a + 1 << ' ' << b + 1 << "\nf " << a << ' ' << b + 1 << ' ' << b
                 << '\n';
        }
    }
}

class FarTest : public RenderTest {
  protected:
    Picture sheetAt(const glm::dvec3& base) const {
        const glint::test::TemporaryFolder folder;
        const auto path = folder.path() / "sheet.obj";
        writeSheet(path, base);
        Scene scene = loadScene(path);
        scene.camera = {};
        aim(scene.camera, base + glm::dvec3(0.25, -0.3, 0.35), base + glm::dvec3(0.25, 0.25, 0), {0, 0, 1});
        scene.ambient = Color(0.1);
        scene.lights = {PointLight{base + glm::dvec3(-0.5, 0.2, 0.4), Color(0.9)}};
        return draw(device(), makeCase(std::move(scene), 160, 120));
    }
};

// T35, T96. Corners are rounded in a frame of about 1, to 2^-24, wherever the sheet lies; its numbers
// themselves are good to half an ulp of 4.6e6 in double, 4.7e-10. A facet of 0.0125 turns by 2 (2^-24
// + 4.7e-10) / 0.0125 = 1e-5, and so does its shade; both pictures, and the hit points: 4e-5. Where a pixel's
// centre lies on an edge of a facet to within 1e-6 of its size, or of a shadow, the pictures may differ: 160
// pixels across 40 facets put 1 in 1e4 there.
TEST_F(FarTest, AMillimetreAtFourThousandKilometres) {
    const Picture near = sheetAt({0, 0, 0});
    for (const glm::dvec3& base : {glm::dvec3(5e5, 4.6e6, 120), glm::dvec3(-4.6e6, 31.25, 2e3)}) {
        const Picture far = sheetAt(base);
        size_t other = 0, hits = 0;
        double worst = 0;
        for (size_t i = 0; i < near.data.size(); ++i) {
            hits += near.data[i].object == 0;
            if (near.data[i].primitive != far.data[i].primitive ||
                near.data[i].shadowBits != far.data[i].shadowBits) {
                ++other;
                continue;
            }
            for (int c = 0; c < 3; ++c)
                worst = std::max<double>(
                    worst, std::abs(near.color.pixels[4 * i + c] - far.color.pixels[4 * i + c]));
        }
        std::cout << "[ measured ] sheet at " << base.x << ' ' << base.y << ": greatest difference " << worst
                  << ", " << other << " pixels on other facets\n";
        EXPECT_GT(hits, near.data.size() / 4);
        EXPECT_LE(worst, 4e-5);
        EXPECT_LE(other, near.data.size() / 1000);
    }
}

}  // namespace glint::stability::stiff_test
