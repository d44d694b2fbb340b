// The validation layer, with synchronization validation, reports nothing for a render and a trace.
#include <cstdlib>

#include "scene/sampling.h"
#include "support.h"

namespace glint::render::test::validation_test {
class ValidationTest : public testing::TestWithParam<gpu::Access> {};

TEST_P(ValidationTest, LayerIsSilent) {
    const gpu::Device device({.validation = true});
    for (const std::string scene : {"triangles", "spheres", "knot"}) {
        const Case c = fileCase(scene, 33, 25);
        // So few trips that rays are resumed.
        const Options options = {.maxSlicePixels = 512, .tripBudget = 40, .access = GetParam()};
        Renderer renderer(device, c.packed, options);
        EXPECT_TRUE(draw(renderer, c).complete);
        auto plain = sized<Request>(c);
        plain.width = plain.height = 16;
        plain.samples = PackedSamples::fixed(sampleOffsets(2));
        EXPECT_TRUE(renderer.render(plain).complete);
        plain.cost = true;
        EXPECT_TRUE(renderer.render(plain).complete);
        const std::vector<RayInput> rays(100, rayOf(filmOf(c).eye, filmOf(c).center));
        RayTracer tracer(device, c.packed, options);
        tracer.trace(rays, false);
        tracer.trace(rays, true);
        if (scene == "knot") {
            EXPECT_GT(renderer.times().resumes, 0u);
        }
        for (const std::string& message : device.validationMessages())
            ADD_FAILURE() << scene << ": " << message;
    }
    // The full pipeline binds a stand-in for every array that the scene has not.
    const Case c = fileCase("knot", 16, 16);
    const Options full = {.leaveOut = false, .access = GetParam()};
    EXPECT_TRUE(draw(device, c, full).complete);
    for (const std::string& message : device.validationMessages())
        ADD_FAILURE() << "full pipeline: " << message;
}

INSTANTIATE_TEST_SUITE_P(All, ValidationTest,
                         testing::Values(gpu::Access::StorageBuffer, gpu::Access::TexelBuffer),
                         [](const auto& p) {
                             return std::string(p.param == gpu::Access::StorageBuffer ? "storage" : "texel");
                         });

// A triangle with colours alone, and behind it one with texture coordinates alone: both are looked up for
// both, and GPU-assisted validation reports a read past the array's end.
TEST(AssistedRenderTest, AttributesOfTheLastTriangleAreInTheArray) {
    Scene scene = emptyScene();
    scene.camera.eye = {0, 0, 4};
    scene.ambient = Color(1);
    scene.textures.push_back({CheckerTexture{Color(0.9), Color(0.2)}, {3, 2}, {0.1, 0.2}});
    const uint32_t material = addMaterial(scene, Color(1));
    scene.materials[material].ambientTexture = 0;
    Mesh colored;
    colored.positions = {{-2, -1, 0}, {0, -1, 0}, {-1, 1, 0}};
    colored.corners = {{0, 1, 2}};
    Mesh checked = colored;
    for (auto& position : checked.positions) position.x += 2;
    colored.colorCorners = {{0, 1, 2}};
    colored.colors = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    checked.uvs = {{0, 0}, {1, 0}, {0, 1}};
    checked.uvCorners = {{0, 1, 2}};
    for (const Mesh& mesh : {colored, checked})
        scene.objects.push_back({"", MeshShape{std::make_shared<const Mesh>(mesh)}, material});
    const Case c = makeCase(scene, 16, 8);
    ASSERT_TRUE(c.packed.features.uvs && c.packed.features.vertexColors);
    ASSERT_EQ(c.packed.vertexAttributes.size(), 5u);
    ::setenv("VK_LAYER_ENABLES", "VK_VALIDATION_FEATURE_ENABLE_GPU_ASSISTED_EXT", 1);
    const gpu::Device device({.validation = true});
    ::unsetenv("VK_LAYER_ENABLES");
    EXPECT_TRUE(draw(device, c).complete);
    for (const std::string& message : device.validationMessages()) ADD_FAILURE() << message;
}

}  // namespace glint::render::test::validation_test
