// GPU-assisted validation, which tools/test-more runs over whole images, must detect reads and writes past
// the end.
#include <cstdlib>
#include <optional>

#include "gpu_fixture.h"

namespace glint::gpu::assisted_test {
constexpr const char* kSetting = "VK_LAYER_ENABLES";

class AssistedTest : public testing::TestWithParam<Access> {
  protected:
    AssistedTest() {
        ::setenv(kSetting, "VK_VALIDATION_FEATURE_ENABLE_GPU_ASSISTED_EXT", 1);
        device_.emplace(withValidation());
        ::unsetenv(kSetting);
    }

    // The layer's messages for a shader that reads and writes `touched` texels of a buffer of 16.
    std::vector<std::string> messages(uint32_t touched) {
        const Buffer buffer = countingBuffer(*device_, 64, GetParam());
        run(*device_, scaleKernel(*device_, buffer, {2}), 1, bytesOf(ScalePush{touched, 0}));
        return device_->validationMessages();
    }

  private:
    std::optional<Device> device_;
};

INSTANTIATE_TEST_SUITE_P(All, AssistedTest, testing::Values(Access::StorageBuffer, Access::TexelBuffer),
                         accessName);

// Without the layer the reads have no effect, as devices are opened with robustBufferAccess.
// tools/test-validated runs this with GPU-assisted validation to check that it is active.
TEST(Robust, ReadsPastTheEndHarmNothing) {
    const Device device;
    const Buffer buffer = countingBuffer(device, 64);
    run(device, scaleKernel(device, buffer, {2}), 1, bytesOf(ScalePush{17, 0}));
    const std::vector<uint32_t> values = read(device, buffer, 64);
    for (uint32_t i = 0; i < 64; ++i) ASSERT_EQ(values[i], 2 * i);
}

TEST_P(AssistedTest, ReadsPastTheEndAreSeen) {
    const std::vector<std::string> seen = messages(17);
    ASSERT_FALSE(seen.empty());
    EXPECT_HAS(seen.front(), "out of bounds");
}

TEST_P(AssistedTest, ReadsUpToTheEndAreNot) {
    for (const std::string& message : messages(16)) ADD_FAILURE() << message;
}

}  // namespace glint::gpu::assisted_test
