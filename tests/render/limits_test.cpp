// Arrays beyond what a device can bind: rendered by the other access, or refused by name.
#include <algorithm>
#include <map>
#include <set>
#include <type_traits>

#include "core/device_layout.h"
#include "core/error.h"
#include "gpu/device_state.h"
#include "pack/pack_samples.h"
#include "render/path_limits.h"
#include "render/scene_buffers.h"
#include "support.h"
#include "support/support.h"

namespace glint::render::test::limits_test {

gpu::DeviceInfo deviceWith(uint64_t storageRange, uint64_t texels, bool llvmpipe, uint32_t images = 1000) {
    gpu::DeviceInfo device;
    device.llvmpipe = llvmpipe;
    device.limits.maxStorageBufferRange = storageRange;
    device.limits.maxTexelBufferElements = texels;
    device.limits.maxAllocationSize = uint64_t{1} << 40;
    device.limits.maxStorageImagesPerStage = images;
    device.limits.maxStorageBuffersPerStage = 1000;
    return device;
}

constexpr uint64_t kStorage = 1 << 20, kTexels = 1 << 17;  // 1 MiB and 2 MiB

TEST(ChooseAccess, TexelBuffersOnLlvmpipeAndWhereOneStorageBufferIsTooSmall) {
    const auto choose = [&](bool llvmpipe, uint64_t largest, uint64_t sum, uint32_t images = 1000) {
        return chooseAccess(deviceWith(kStorage, kTexels, llvmpipe, images), {largest, sum});
    };
    using enum gpu::Access;
    EXPECT_EQ(choose(true, 16, 16), TexelBuffer);
    EXPECT_EQ(choose(true, 2 * kStorage, 9 * kStorage), TexelBuffer);
    // Neither fits: the message names the range of the storage buffer.
    EXPECT_EQ(choose(true, 2 * kStorage + 16, 9 * kStorage), StorageBuffer);
    EXPECT_EQ(choose(false, 2 * kStorage + 16, 9 * kStorage), StorageBuffer);
    EXPECT_EQ(choose(false, 16, kStorage), StorageBuffer);
    EXPECT_EQ(choose(false, 16, kStorage + 16), TexelBuffer);
    // All arrays and the path state are storage images then.
    EXPECT_EQ(choose(true, 16, 16, GLINT_BINDING_COUNT), TexelBuffer);
    EXPECT_EQ(choose(true, 16, 16, GLINT_BINDING_COUNT - 1), StorageBuffer);
    EXPECT_EQ(choose(false, 16, kStorage + 16, 4), StorageBuffer);
}

// lavapipe's limit is 65,535 trips of a subgroup; 64 lanes need another budget than 8.
TEST(TripBudget, LeavesRoomForEveryLane) {
    for (const uint32_t lanes : {1u, 4u, 8u, 16u}) {
        gpu::DeviceInfo device = deviceWith(1 << 27, 1 << 27, true);
        device.limits.subgroupSize = lanes;
        SceneFeatures features = allFeatures();
        features.instances = false;
        const uint32_t budget = deriveTripBudget(device, features);
        EXPECT_LE(std::max(lanes, 8u) * budget + shared::kMaxPlanes, 65535u) << lanes;
        EXPECT_GE(budget, 1000u) << lanes;
        // The greatest polygon's leaf runs on after the last check of the budget, on every lane.
        const uint32_t leaf = shared::kMaxPolygonTrips + 2, beside = deriveTripBudget(device, features, leaf);
        EXPECT_LE(std::max(lanes, 8u) * (beside + leaf) + shared::kMaxPlanes, 65535u) << lanes;
        EXPECT_GE(beside, 500u) << lanes;
        // With instances the lanes count the loops that each of their trips may enter, but in walks where
        // that is so of the longest lane's alone: those of the nodes, of triangles, and one more.
        EXPECT_GE(deriveTripBudget(device, allFeatures()), 1000u) << lanes;
        SceneFeatures meshes;
        meshes.triangles = meshes.instances = true;
        EXPECT_GE(deriveTripBudget(device, meshes), 2000u) << lanes;
        EXPECT_LE((std::max(lanes, 8u) + 3) * deriveTripBudget(device, meshes) + shared::kMaxPlanes, 65535u)
            << lanes;
    }
}

// All lights of a dispatch together may make a ray test at most as many planes as one ray may.
TEST(TripBudget, LightsOfADispatchShareItsTrips) {
    EXPECT_EQ(lightsAtOnce(1, 0), 1u);
    EXPECT_EQ(lightsAtOnce(3000, 0), 8u);
    EXPECT_EQ(lightsAtOnce(1u << 16, 0), 174u);
    EXPECT_EQ(lightsAtOnce(3000, shared::kMaxPlanes), 1u);
    for (const uint32_t planes : {0u, 1u, 100u, 500u, 1023u}) {
        const uint32_t lights = lightsAtOnce(3000, planes);
        EXPECT_GE(lights, 1u) << planes;
        EXPECT_LE(lights * (planes + 1), shared::kMaxPlanes) << planes;
    }
    EXPECT_GT(lightsAtOnce(3000, 1), lightsAtOnce(3000, 500));
    EXPECT_GT(lightsAtOnce(3000, 1), lightsAtOnce(300, 1));
}

class LimitsTest : public RenderTest {};

// The scene's own triangles lie behind so many others that their array passes the storage buffer range.
PackedScene behindManyTriangles(PackedScene scene, uint32_t others) {
    const auto insert = [&](auto& array) { array.insert(array.begin(), others, {}); };
    insert(scene.triangles);
    insert(scene.triangleSurfaces);
    const auto move = [&](uint32_t& child) {
        if (child == shared::kNone || !(child & shared::kLeafFlag)) return;
        const uint32_t first = (child & shared::kLeafFirstMask) + others;
        ASSERT_LE(first, shared::kLeafFirstMask);
        child = (child & ~shared::kLeafFirstMask) | first;
    };
    for (shared::Node& node : scene.nodes) {
        move(node.child0);
        move(node.child1);
    }
    return scene;
}

TEST_F(LimitsTest, ArrayBeyondTheStorageRangeIsRendered) {
    const Case c = fileCase("knot", 64, 48);
    const uint64_t range = device().info().limits.maxStorageBufferRange;
    const uint32_t others = static_cast<uint32_t>(range / sizeof(shared::Triangle)) + 1;
    const PackedScene large = behindManyTriangles(c.packed, others);
    Renderer small(device(), c.packed), renderer(device(), large);
    EXPECT_EQ(renderer.access(), gpu::Access::TexelBuffer);
    EXPECT_GT(renderer.deviceBytes(), range);
    EXPECT_TRUE(sameBits(draw(small, c), draw(renderer, c)));
}

// A device with the limits that Vulkan 1.1 requires of every device (sections "Required Limits" and "Required
// Format Support"): the same bits, or an error with both figures. Buffers and kernels check every limit, so
// more than a limit is an error here, whatever the device.
class LeastLimits : public RenderTest {
  protected:
    static gpu::Device leastDevice() {
        gpu::Device device;
        gpu::DeviceLimits& limits = device.state().physical.info.limits;
        const auto atMost = [](auto& limit, uint64_t promised) {
            limit =
                static_cast<std::remove_reference_t<decltype(limit)>>(std::min<uint64_t>(limit, promised));
        };
        atMost(limits.maxStorageBufferRange, uint64_t{1} << 27);
        atMost(limits.maxTexelBufferElements, 65536);
        atMost(limits.maxAllocationSize, uint64_t{1} << 30);
        atMost(limits.maxWorkgroupInvocations, 128);
        atMost(limits.maxWorkgroupSizeX, 128);
        atMost(limits.maxWorkgroupCountX, 65535);
        atMost(limits.maxPushConstantBytes, 128);
        atMost(limits.maxStorageBuffersPerStage, 4);
        atMost(limits.maxStorageImagesPerStage, 4);
        atMost(limits.subgroupSize, 1);
        limits.subgroupShuffle = false;
        limits.timestampPeriod = 0;
        EXPECT_EQ(gpu::refusal(VK_API_VERSION_1_1, true, limits), "");
        return device;
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
    request.samples = packSamples(image, c.camera);
    Renderer small(least, c.packed, {.maxSlicePixels = 1024}), usual(device(), c.packed);
    EXPECT_TRUE(sameBits(small.render(request), usual.render(request)));
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
    EXPECT_STARTS(message, "array \"all arrays together\" needs 1342");
    EXPECT_ENDS(message, "bytes, but this device binds at most 134217728 bytes as a storage buffer");
}

// ---- bindings of arrays that a scene does not have ----

class SceneBuffersTest : public RenderTest {
  protected:
    static std::vector<uint32_t> words(const gpu::Buffer& buffer, uint64_t first, size_t count) {
        std::vector<uint32_t> found(count);
        gpu::download(device(), buffer, std::as_writable_bytes(std::span(found)), first);
        return found;
    }
    static bool allZero(const std::vector<uint32_t>& found) {
        return std::all_of(found.begin(), found.end(), [](uint32_t word) { return word == 0; });
    }
    // Bindings of arrays that a scene of one triangle lacks, and how many bytes their first element takes.
    static std::map<uint32_t, size_t> absent() {
        const std::set<std::string> lacking = {"optics", "textures",         "instances", "objectFrames",
                                               "lights", "vertexAttributes", "samples"};
        std::map<uint32_t, size_t> found;
#define GLINT_ADD_ABSENT(binding, field, Struct, ROWS) \
    if (lacking.contains(#field)) found[binding] = sizeof(shared::Struct);
        GLINT_SCENE_ARRAYS(GLINT_ADD_ABSENT)
#undef GLINT_ADD_ABSENT
        return found;
    }
    static PackedScene oneTriangle() {
        Scene scene = emptyScene();
        addTriangle(scene, {0, 0, 0}, {1, 0, 0}, {0, 1, 0});
        return packScene(scene);
    }
};

TEST_F(SceneBuffersTest, AbsentArraysAreZeros) {
    const PackedScene scene = oneTriangle();
    ASSERT_EQ(absent().size(), 7u);
    const SceneBuffers apart(device(), scene, gpu::Access::TexelBuffer, {}),
        together(device(), scene, gpu::Access::StorageBuffer, {});
    const std::vector<uint32_t> first = words(together.at(2), 0, GLINT_BINDING_COUNT);
    for (const auto& [binding, bytes] : absent()) {
        const gpu::Buffer& bound = apart.at(binding);
        ASSERT_GE(bound.size(), bytes) << binding;
        EXPECT_TRUE(allZero(words(bound, 0, bound.size() / 4))) << binding;
        if (binding == shared::kSamplesBinding) continue;
        EXPECT_TRUE(allZero(words(together.at(2), uint64_t{16} * first[binding], bytes / 4))) << binding;
    }
    EXPECT_TRUE(allZero(words(together.at(3), 0, together.at(3).size() / 4)));
}

}  // namespace glint::render::test::limits_test
