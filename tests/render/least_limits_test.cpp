// A device with the limits that Vulkan 1.1 requires of every device (onlyLeastLimits): the same bits, or an
// error with both figures. Buffers and kernels check every limit, so what passes one is an error here,
// whatever the device.
#include "core/error.h"
#include "pack/pack_samples.h"
#include "render/scene_buffers.h"
#include "support.h"
#include "support/support.h"

namespace glint::render::test::least_limits_test {
class LeastLimits : public RenderTest {
  protected:
    static gpu::Device leastDevice() {
        gpu::DeviceOptions options;
        options.onlyLeastLimits = true;
        return gpu::Device(options);
    }
};

TEST_F(LeastLimits, SamplersAdaptiveSamplingAndSlices) {
    const gpu::Device least = leastDevice();
    ASSERT_EQ(least.info().limits.maxStorageBuffersPerStage, 4u);
    const Case c = fileCase("lens", 64, 48);
    ASSERT_EQ(chooseAccess(least.info(), arraySizes(c.packed)), gpu::Access::StorageBuffer);
    Request request = wholeWithData(c);
    ImageSettings image = c.scene.image;
    image.samplesPerPixel = 4;
    image.adaptive = AdaptiveSampling{16, 0.05};
    request.samples = packSamples(image, true);
    Options slices;
    slices.maxSlicePixels = 1024;
    Renderer small(least, c.packed, slices), usual(device(), c.packed);
    EXPECT_TRUE(sameBits(small.render(c.camera, request), usual.render(c.camera, request)));
}

TEST_F(LeastLimits, RaysOfABatch) {
    const gpu::Device least = leastDevice();
    const Case c = fileCase("instances", 40, 30);
    std::vector<RayInput> rays;
    Random random(1);
    for (int i = 0; i < 500; ++i) rays.push_back(rayTowards({0, 3, 12}, random.box(4)));
    RayTracer small(least, c.packed), usual(device(), c.packed);
    EXPECT_TRUE(sameBits(small.trace(rays, false), usual.trace(rays, false), rays));
}

TEST_F(LeastLimits, WhatDoesNotFitIsRefusedWithBothFigures) {
    const gpu::Device least = leastDevice();
    PackedScene large = fileCase("spheres", 8, 8).packed;
    large.texels.resize((uint64_t{1} << 27) / sizeof(large.texels[0]));
    const std::string message =
        glint::test::errorOf(ErrorKind::Device, [&] { Renderer renderer(least, large); });
    EXPECT_TRUE(message.starts_with("array \"all arrays together\" needs 1342")) << message;
    EXPECT_TRUE(message.ends_with("bytes, but this device binds at most 134217728 bytes as a storage buffer"))
        << message;
}

}  // namespace glint::render::test::least_limits_test
