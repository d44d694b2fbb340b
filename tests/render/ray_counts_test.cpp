// Rays by class, as --stats prints them: in scenes where geometry says how many there are.
#include "support.h"

namespace glint::render::test::ray_counts_test {
class RayCountsTest : public RenderTest {
  protected:
    static RayCounts counted(const Case& c, uint32_t tripBudget = 0) {
        Options options;
        if (tripBudget > 0) options.tripBudget = tripBudget;
        Renderer renderer(device(), c.packed, options);
        Request request = wholeWithData(c);
        request.tally = true;
        renderer.render(c.camera, request);
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

// A ball 32 units of the last place large, at negative coordinates: at its limb rounding alone would say
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
    size_t hits = 0, hidden = 0;
    for (const PixelData& pixel : renderer.render(c.camera, wholeWithData(c)).data) {
        hits += pixel.object != PixelData::kNoIndex;
        hidden += pixel.shadowBits != 0;
    }
    EXPECT_GT(hits, 1000u);
    EXPECT_EQ(counted(c).mirrored, hits);
    EXPECT_EQ(hidden, 0u);
}

}  // namespace glint::render::test::ray_counts_test
