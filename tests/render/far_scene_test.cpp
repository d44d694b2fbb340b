// Scenes that lie thousands of times their size from 0, with an object among them that hides it: fp32 counts
// from where most objects are, so pictures are those of the same scene at 0.
#include "support.h"
#include "verify/verify.h"

namespace glint::render::test::far_scene_test {
using glm::dvec3;

class FarSceneTest : public RenderTest {
  protected:
    static verify::Report seen(Scene scene, const dvec3& middle, double fovY) {
        scene.lights.push_back(PointLight{middle + dvec3(5, 4, 1), Color(0.9)});
        scene.camera.eye = middle + dvec3(6, 1.5, 0.5);
        scene.camera.target = middle;
        scene.camera.fovY = fovY;
        scene.ambient = Color(0.2);
        const Case c = makeCase(std::move(scene), 160, 120);
        return verified(c, true);
    }
};

// From 0 the coordinates' last place is a quarter of a pane's thickness: the next ray's origin passes its
// back.
TEST_F(FarSceneTest, PanesAFewRoundingsThick) {
    const dvec3 middle(2587, 4, 126);
    Scene scene = emptyScene();
    const uint32_t plain = addMaterial(scene, Color(0.6)), glass = addMaterial(scene, Color(0.1));
    scene.materials[glass].transmission = Color(0.9);
    scene.materials[glass].ior = 1.5;
    for (int i = 0; i < 4; ++i) {
        const dvec3 corner = middle + dvec3(0.31 * i, -1, -2.1 + i);
        scene.objects.push_back({"/pane", BoxShape{corner, corner + dvec3(6e-4, 2, 1.5)}, glass});
    }
    scene.objects.push_back({"/ball", SphereShape{middle - dvec3(2, 0.3, 0), 1}, plain});
    scene.objects.push_back(
        {"/block", BoxShape{middle + dvec3(-170, -400, -371), middle + dvec3(200, -4, -1)}, plain});
    const verify::Report report = seen(std::move(scene), middle, 40);
    EXPECT_TRUE(report.passed());
    EXPECT_LE(report.edges + report.roundings, 4u);
    EXPECT_EQ(report.unexplained, 0u);
}

// From 0 their corners are no farther apart than one or two roundings.
TEST_F(FarSceneTest, CrumbsKeepTheirShape) {
    const dvec3 middle(40366, 4, 9);
    Scene scene = emptyScene();
    const uint32_t plain = addMaterial(scene, Color(0.6));
    Random random(5);
    for (int i = 0; i < 200; ++i) {
        const dvec3 at = middle + random.box(0.15);
        scene.objects.push_back(
            {"/crumb", TriangleShape{{at, at + random.box(0.01), at + random.box(0.01)}}, plain});
    }
    scene.objects.push_back({"/planet", SphereShape{middle - dvec3(300, 640, 0), 700}, plain});
    const verify::Report report = seen(std::move(scene), middle, 3);
    EXPECT_TRUE(report.passed());
    EXPECT_EQ(report.unexplained, 0u);
    ASSERT_TRUE(report.representation.has_value());
    EXPECT_EQ(report.representation->explained + report.representation->unexplained, 0u);
}

}  // namespace glint::render::test::far_scene_test
