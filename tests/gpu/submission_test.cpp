#include <algorithm>

#include "gpu_fixture.h"

namespace glint::gpu::submission_test {
class SubmissionTest : public GpuTest {};

// 0, 1, 2, ...: add 1 to all, reverse the texels, triple all. Each step reads what another invocation wrote.
TEST_F(SubmissionTest, DispatchesOfABatchAreOrdered) {
    const uint32_t texels = 5000;
    const Buffer source(device_, "source", texels * 16, Access::TexelBuffer, MemoryKind::Device);
    const Buffer destination(device_, "destination", texels * 16, Access::StorageBuffer, MemoryKind::Device);
    write(device_, source, counting(texels * 4));
    Kernel add = scaleKernel(device_, source, {1, 1});
    Kernel reverse = reverseKernel(device_);
    Kernel triple = scaleKernel(device_, destination, {3, 0});
    const Buffer* const both[] = {&source, &destination};
    reverse.bind(both);

    Submission submission(device_);
    submission.dispatch(add, groupsFor(texels), bytesOf(ScalePush{texels, 1}));
    submission.dispatch(reverse, groupsFor(texels), bytesOf(texels));
    submission.dispatch(triple, groupsFor(texels), bytesOf(ScalePush{texels, 0}));
    submission.submit();

    const std::vector<uint32_t> values = read(device_, destination, texels * 4);
    for (uint32_t i = 0; i < texels; ++i) {
        for (uint32_t c = 0; c < 4; ++c)
            ASSERT_EQ(values[4 * i + c], 3 * (4 * (texels - 1 - i) + c + 1)) << "texel " << i;
    }
}

TEST_F(SubmissionTest, CopiesTakeTheirTurn) {
    const Buffer a = countingBuffer(device_, 64);
    const Buffer b(device_, "b", 256, Access::TexelBuffer, MemoryKind::Host);
    write(device_, b, std::vector<uint32_t>(64, 7));
    Kernel twice = scaleKernel(device_, a, {2, 0});
    Submission submission(device_);
    submission.dispatch(twice, 1, bytesOf(ScalePush{16, 0}));
    submission.copy(a, 128, b, 64, 64);  // 64, 66, ... to b[16..31]
    submission.dispatch(twice, 1, bytesOf(ScalePush{16, 0}));
    submission.submit();
    const auto* copied = static_cast<const uint32_t*>(b.mapped());
    for (uint32_t i = 0; i < 64; ++i) ASSERT_EQ(copied[i], i >= 16 && i < 32 ? 2 * (i + 16) : 7u) << i;
    const std::vector<uint32_t> values = read(device_, a, 64);
    for (uint32_t i = 0; i < 64; ++i) ASSERT_EQ(values[i], 4 * i);
}

TEST_F(SubmissionTest, IsReusable) {
    const Buffer buffer(device_, "values", 64, Access::StorageBuffer, MemoryKind::Device);
    write(device_, buffer, counting(16, 1));
    Kernel twice = scaleKernel(device_, buffer, {2, 0});
    Submission first(device_);
    Submission submission = std::move(first);
    for (int i = 0; i < 10; ++i) {
        submission.dispatch(twice, 1, bytesOf(ScalePush{4, 0}));
        submission.submit();
    }
    const std::vector<uint32_t> values = read(device_, buffer, 16);
    for (uint32_t i = 0; i < 16; ++i) ASSERT_EQ(values[i], 1024 * (i + 1));
}

TEST_F(SubmissionTest, NothingIsNoWork) {
    const Buffer buffer(device_, "values", 64, Access::StorageBuffer, MemoryKind::Device);
    const Kernel kernel = emptyKernel(device_);
    Submission submission(device_);
    submission.dispatch(kernel, 0, {});
    submission.copy(buffer, 0, buffer, 0, 0);
    const Submission::Times times = submission.submit();
    EXPECT_EQ(times.wall, 0.0);
    EXPECT_EQ(times.device, 0.0);
}

TEST_F(SubmissionTest, RunsTheMostWorkgroupsAndRefusesOneMore) {
    const uint32_t most = device_.info().limits.maxWorkgroupCountX;
    const Kernel kernel = emptyKernel(device_);
    Submission submission(device_);
    EXPECT_EQ(errorOf([&] { submission.dispatch(kernel, most + 1, {}); }),
              "kernel \"empty\": a dispatch of " + std::to_string(most + 1) +
                  " workgroups, but this device runs at most " + std::to_string(most));
    submission.dispatch(kernel, most, {});
    EXPECT_GT(submission.submit().wall, 0.0);
}

TEST_F(SubmissionTest, CopiesPastTheEndAreErrors) {
    const Buffer a(device_, "a", 64, Access::StorageBuffer, MemoryKind::Device);
    const Buffer b(device_, "b", 32, Access::StorageBuffer, MemoryKind::Device);
    Submission submission(device_);
    EXPECT_EQ(errorOf([&] { submission.copy(a, 0, b, 0, 64); }),
              "a copy of 64 bytes at offset 0 passes the end of array \"b\" (32 bytes)");
    EXPECT_EQ(errorOf([&] { submission.copy(a, 60, b, 0, 8); }),
              "a copy of 8 bytes at offset 60 passes the end of array \"a\" (64 bytes)");
}

// The device's time lies between submit and fence; a millisecond allows for two clocks.
TEST_F(SubmissionTest, TimestampsLieWithinTheWallTime) {
    const auto texels = static_cast<uint32_t>(
        std::min<uint64_t>(device_.info().limits.maxTexelBufferElements, uint64_t{1} << 20));
    const Buffer buffer(device_, "values", uint64_t{16} * texels, Access::TexelBuffer, MemoryKind::Device);
    const Submission::Times times =
        run(device_, scaleKernel(device_, buffer, {2, 0}), groupsFor(texels), bytesOf(ScalePush{texels, 0}));
    EXPECT_GT(times.device, 0.0);
    EXPECT_LE(times.device, times.wall + 1e-3);
    EXPECT_LT(times.wall, 60.0);
}

TEST_F(SubmissionTest, DeviceTimeIsZeroWithoutTimestamps) {
    device_.state().physical.info.limits.timestampPeriod = 0;
    const Submission::Times times = run(device_, emptyKernel(device_), 1);
    EXPECT_EQ(times.device, 0.0);
    EXPECT_GT(times.wall, 0.0);
}

}  // namespace glint::gpu::submission_test
