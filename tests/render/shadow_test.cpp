// Rays that start on a surface: they must neither hit it again (acne) nor jump over its neighbour (leaks).
#include "support.h"

namespace glint::render::test::shadow_test {
// Objects far from the origin, thin walls: tests/stability/leaks_test.cpp.
class ShadowTest : public RenderTest {};

// A lamp close above a table in a large room: the cup between them casts its shadow however short the way is.
TEST_F(ShadowTest, LightCloseToASurface) {
    for (const double distance : {1.0, 0.1, 0.01, 0.001}) {
        Scene scene = emptyScene();
        addTriangle(scene, {-10, 0, -10}, {10, 0, -10}, {0, 0, 15});
        addTriangle(scene, {-8, 0.5 * distance, -8}, {8, 0.5 * distance, -8}, {0, 0.5 * distance, 12});
        scene.lights.push_back(PointLight{{0, distance, 0}, Color(1)});
        scene.camera.eye = {0, 0.25 * distance, 0};
        scene.camera.target = {0, 0, -0.5 * distance};
        scene.camera.fovY = 40;
        const Case c = makeCase(scene, 32, 32);
        const Picture picture = draw(device(), c);
        int table = 0, lit = 0;
        for (const PixelData& data : picture.data) {
            if (data.object != 0) continue;
            ++table;
            lit += data.shadowBits == 0;
        }
        EXPECT_GT(table, 500) << distance;
        EXPECT_EQ(lit, 0) << "light " << distance << " above the table: lit pixels of " << table;
    }
}

// The floor's own primitive is no obstacle, its neighbour in a mesh is one.
TEST_F(ShadowTest, WedgeIsDarkInsideAndLitOutside) {
    Scene scene = emptyScene();
    addTriangle(scene, {0, 0, -50}, {4, 0, 0}, {0, 0, 50});
    addTriangle(scene, {0, 0, -50}, {0, 0, 50}, {4, 0.004, 0});  // a thousandth of a radian above it
    scene.lights.push_back(DirectionalLight{{0, -1, 0}, Color(1)});
    scene.camera.eye = {2, 3, 0};
    scene.camera.target = {2, 0, 0};
    scene.camera.up = {0, 0, 1};
    scene.camera.fovY = 30;
    const Picture above = draw(device(), makeCase(scene, 32, 32));
    for (const PixelData& data : above.data) EXPECT_EQ(data.shadowBits, 0u);
    scene.camera.eye = {3.9, 0.0015, 0};
    scene.camera.target = {3.5, 0, 0};
    scene.camera.up = {0, 1, 0};
    const Picture inside = draw(device(), makeCase(scene, 32, 32));
    int dark = 0;
    for (const PixelData& data : inside.data) {
        if (data.object != 0) continue;
        EXPECT_EQ(data.shadowBits, 1u);
        ++dark;
    }
    EXPECT_GT(dark, 100);
}

// A surface that sends none of a light's light on asks for no shadow ray: with a trip to a dispatch there are
// as many dispatches as without the light. A highlight asks where it is not zero.
TEST_F(ShadowTest, LightThatAddsNothingTakesNoRay) {
    Scene scene = emptyScene();
    const uint32_t floor = addMaterial(scene, Color(0));
    scene.materials[floor].ambient = Color(0.5);
    addTriangle(scene, {-10, 0, -10}, {0, 0, 15}, {10, 0, -10}, floor);
    for (int i = 0; i < 16; ++i)
        addSphere(scene, {0.25 * (i % 4) - 0.4, 3, 0.25 * (i / 4) - 0.2}, 0.1, floor);
    scene.camera.eye = {0, 1, 0};
    scene.camera.target = {0, 0, 0};
    scene.camera.up = {0, 0, 1};
    const auto resumesOf = [&](const Scene& of, std::vector<float>& pixels) {
        const Case c = makeCase(of, 16, 16);
        Options options;
        options.tripBudget = 1;
        options.traversal = Traversal::Lane;
        Renderer renderer(device(), c.packed, options);
        Request settings;
        settings.width = settings.height = 16;
        const Picture picture = renderer.render(c.camera, settings);
        pixels.clear();
        for (int y = 0; y < 16; ++y)
            for (int x = 0; x < 16; ++x) pixels.push_back(picture.color.at(x, y, 0));
        return renderer.times().resumes;
    };
    std::vector<float> unlit, lit;
    const auto without = resumesOf(scene, unlit);
    scene.lights.push_back(PointLight{{0, 6, 0.4}, Color(1)});
    EXPECT_EQ(resumesOf(scene, lit), without);
    EXPECT_EQ(lit, unlit);
    scene.materials[floor].specular = Color(0.5);
    scene.materials[floor].shininess = 50;
    EXPECT_GT(resumesOf(scene, lit), without);
    EXPECT_NE(lit, unlit);
}

}  // namespace glint::render::test::shadow_test
