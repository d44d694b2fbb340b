// The validation layer, with synchronization validation, has nothing to say about a render and a trace.
#include "scene/sampling.h"
#include "support.h"

namespace glint::render::test::validation_test {
namespace {

class ValidationTest : public testing::TestWithParam<gpu::Access> {};

TEST_P(ValidationTest, LayerIsSilent) {
    gpu::DeviceOptions withLayer;
    withLayer.validation = true;
    const gpu::Device device(withLayer);
    ASSERT_TRUE(device.validationActive())
        << "VK_LAYER_KHRONOS_validation is missing: install the Debian package vulkan-validationlayers";
    for (const std::string scene : {"triangles", "spheres", "knot"}) {
        const Case c = fileCase(scene, 33, 25);
        Options options;
        options.access = GetParam();
        options.tripBudget = 40;  // so that rays are resumed
        options.maxSlicePixels = 512;
        Renderer renderer(device, c.packed, options);
        EXPECT_TRUE(draw(renderer, c).complete);
        Request plain;
        plain.width = plain.height = 16;
        plain.samples = PackedSamples::fixed(sampleOffsets(2));
        EXPECT_TRUE(renderer.render(c.camera, plain).complete);
        plain.cost = true;
        EXPECT_TRUE(renderer.render(c.camera, plain).complete);
        const std::vector<RayInput> rays(100, rayOf(c.camera.eye, c.camera.center));
        renderer.trace(rays, false);
        renderer.trace(rays, true);
        if (scene == "knot") {
            EXPECT_GT(renderer.times().resumes, 0u);
        }
        for (const std::string& message : device.validationMessages())
            ADD_FAILURE() << scene << ": " << message;
    }
    // The full pipeline binds a stand-in for every array that the scene has not.
    const Case c = fileCase("knot", 16, 16);
    Options full;
    full.access = GetParam();
    full.leaveOut = false;
    EXPECT_TRUE(draw(device, c, full).complete);
    for (const std::string& message : device.validationMessages())
        ADD_FAILURE() << "full pipeline: " << message;
}

INSTANTIATE_TEST_SUITE_P(All, ValidationTest,
                         testing::Values(gpu::Access::StorageBuffer, gpu::Access::TexelBuffer),
                         [](const auto& p) {
                             return std::string(p.param == gpu::Access::StorageBuffer ? "storage" : "texel");
                         });

}  // namespace
}  // namespace glint::render::test::validation_test
