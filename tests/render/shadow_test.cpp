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
        aim(scene.camera, {0, 0.25 * distance, 0}, {0, 0, -0.5 * distance});
        scene.camera.fovY = 40;
        const Case c = makeCase(scene, 32, 32);
        const Picture picture = draw(device(), c);
        const size_t table = countPixels(picture, [](const PixelData& d) { return d.object == 0; });
        const size_t lit =
            countPixels(picture, [](const PixelData& d) { return d.object == 0 && d.shadowBits == 0; });
        EXPECT_GT(table, 500u) << distance;
        EXPECT_EQ(lit, 0u) << "light " << distance << " above the table: lit pixels of " << table;
    }
}

// The floor's own primitive is no obstacle, its neighbour in a mesh is one.
TEST_F(ShadowTest, WedgeIsDarkInsideAndLitOutside) {
    Scene scene = emptyScene();
    addTriangle(scene, {0, 0, -50}, {4, 0, 0}, {0, 0, 50});
    addTriangle(scene, {0, 0, -50}, {0, 0, 50}, {4, 0.004, 0});  // a thousandth of a radian above it
    scene.lights.push_back(DirectionalLight{{0, -1, 0}, Color(1)});
    aim(scene.camera, {2, 3, 0}, {2, 0, 0}, {0, 0, 1});
    scene.camera.fovY = 30;
    const Picture above = draw(device(), makeCase(scene, 32, 32));
    EXPECT_EQ(countPixels(above, [](const PixelData& d) { return d.shadowBits != 0; }), 0u);
    aim(scene.camera, {3.9, 0.0015, 0}, {3.5, 0, 0}, {0, 1, 0});
    const Picture inside = draw(device(), makeCase(scene, 32, 32));
    EXPECT_GT(countPixels(inside, [](const PixelData& d) { return d.object == 0; }), 100u);
    EXPECT_EQ(countPixels(inside, [](const PixelData& d) { return d.object == 0 && d.shadowBits != 1; }), 0u);
}

// A surface that reflects none of a light's light needs no shadow ray: with a trip to a dispatch there are as
// many dispatches as without the light. A highlight needs one where it is not zero.
TEST_F(ShadowTest, LightThatAddsNothingTakesNoRay) {
    Scene scene = emptyScene();
    const uint32_t floor = addMaterial(scene, Color(0));
    scene.materials[floor].ambient = Color(0.5);
    addTriangle(scene, {-10, 0, -10}, {0, 0, 15}, {10, 0, -10}, floor);
    for (int i = 0; i < 16; ++i)
        addSphere(scene, {0.25 * (i % 4) - 0.4, 3, 0.25 * (i / 4) - 0.2}, 0.1, floor);
    aim(scene.camera, {0, 1, 0}, {0, 0, 0}, {0, 0, 1});
    const auto resumesOf = [&](const Scene& of, std::vector<float>& pixels) {
        const Case c = makeCase(of, 16, 16);
        Renderer renderer(device(), c.packed, {.tripBudget = 1, .traversal = Traversal::Lane});
        pixels = renderer.render(sized<Request>(c)).color.pixels;
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

// Rays by class, as --stats prints them: in scenes where geometry says how many there are.

class RayCountsTest : public RenderTest {
  protected:
    static RayCounts counted(const Case& c, uint32_t tripBudget = 0) {
        Renderer renderer(device(), c.packed, {.tripBudget = tripBudget});
        Request request = wholeWithData(c);
        request.tally = true;
        renderer.render(request);
        return renderer.rays();
    }
};

// Parallel rays onto a floor that mirrors: each is mirrored once, to nothing, and casts a shadow ray to each
// light above, two of them, and none to the one below. A ray that is gone on with counts once.
TEST_F(RayCountsTest, ShadowRaysGoToLightsThatFaceTheSurface) {
    const Case c = textCase(R"({
        "camera": {"type": "orthographic", "eye": [0, 5, 0], "target": [0, 0, 0], "up": [0, 0, 1], "height": 4},
        "maxDepth": 2, "materials": {"m": {"diffuse": 0.5, "mirror": 0.5}},
        "lights": [{"type": "directional", "direction": [0.1, -1, 0]}, {"type": "directional", "direction": [0, 1, 0.1]},
                   {"type": "point", "position": [1, 9, 0]}],
        "objects": [{"type": "triangle", "vertices": [[-50, 0, -50], [-50, 0, 90], [90, 0, -50]], "material": "m"},
                    {"type": "sphere", "center": [0, -3, 0], "radius": 1, "material": "m"}]})",
                            16, 12);
    for (const uint32_t tripBudget : {0u, 1u}) {
        const RayCounts rays = counted(c, tripBudget);
        EXPECT_EQ(rays.primary, 16u * 12u) << tripBudget;
        EXPECT_EQ(rays.mirrored, 16u * 12u) << tripBudget;
        EXPECT_EQ(rays.refracted, 0u) << tripBudget;
        EXPECT_EQ(rays.shadow, 2u * 16u * 12u) << tripBudget;
    }
}

// A ball 32 units of the last place large, at negative coordinates: at its limb rounding alone would decide
// whether a ray leaves it. It does, so that each ray is mirrored once, and no light that it faces is hidden.
TEST_F(RayCountsTest, RaysLeaveABallThatIsAlone) {
    const Case c = textCase(R"({
        "camera": {"eye": [-4.9990234375, -6, -7], "target": [-5, -6, -7], "fovY": 2.1},
        "maxDepth": 5, "materials": {"m": {"diffuse": 0.5, "mirror": 0.5}},
        "lights": [{"type": "directional", "direction": [-0.6, -1, -0.4]}, {"type": "directional", "direction": [-0.1, 1, 0.3]},
                   {"type": "directional", "direction": [0.1, 0.7, -1]}, {"type": "directional", "direction": [-0.3, -0.2, 1]}],
        "objects": [{"type": "sphere", "center": [-5, -6, -7], "radius": 1.52587890625e-05, "material": "m"},
                    {"type": "triangle", "vertices": [[5, 6, 7], [6, 6, 7], [5, 7, 7]], "material": "m"}]})",
                            96, 72);
    Renderer renderer(device(), c.packed);
    const Picture picture = renderer.render(wholeWithData(c));
    const size_t hits = pixelsWithObject(picture);
    EXPECT_GT(hits, 1000u);
    EXPECT_EQ(counted(c).mirrored, hits);
    EXPECT_EQ(countPixels(picture, [](const PixelData& d) { return d.shadowBits != 0; }), 0u);
}

}  // namespace glint::render::test::shadow_test
