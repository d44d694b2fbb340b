// Every scene of the repository, pixel by pixel against the reference.
#include "support.h"
#include "verify/verify.h"

namespace glint::render::test::scenes_test {

class SceneTest : public RenderTest, public testing::WithParamInterface<std::string> {};

TEST_P(SceneTest, AgreesWithTheReference) {
    const Case c = fileCase(GetParam(), 160, 120);
    Renderer renderer(device(), c.packed);
    const verify::Report report = verified(renderer, c);
    EXPECT_EQ(report.unexplained, 0u);
    EXPECT_TRUE(report.passed()) << report.explained() << " explained pixels of " << report.pixels;
    EXPECT_EQ(report.pixels, 160u * 120u);
    const Picture picture = draw(renderer, c);
    EXPECT_EQ(picture.notFinite, 0u);
    // A picture of nothing, or of one thing alone, would prove little.
    EXPECT_GT(pixelsWithObject(picture), 160u * 120u / 4);
}

INSTANTIATE_TEST_SUITE_P(All, SceneTest, testing::ValuesIn(sceneNames()), sceneName);

}  // namespace glint::render::test::scenes_test
