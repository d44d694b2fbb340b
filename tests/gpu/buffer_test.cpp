#include <algorithm>
#include <tuple>

#include "gpu_fixture.h"

namespace glint::gpu::buffer_test {
enum class Path { Mapped, Staged };

// Each memory kind, mapped directly and through staging.
class RoundTrip : public GpuTest, public testing::WithParamInterface<std::tuple<MemoryKind, Path>> {
  protected:
    RoundTrip() {
        if (std::get<Path>(GetParam()) == Path::Staged) {
            device_.state().physical.unified = false;
            device_.state().stagingBytes = 1008;  // many pieces, the last one short
        }
    }
    Buffer make(const std::string& name, uint64_t bytes) const {
        return Buffer(device_, name, bytes, Access::TexelBuffer, std::get<MemoryKind>(GetParam()));
    }
};

std::string caseName(const testing::TestParamInfo<RoundTrip::ParamType>& info) {
    const auto [kind, path] = info.param;
    return std::string(kind == MemoryKind::Device ? "Device" : "Host") +
           (path == Path::Mapped ? "Mapped" : "Staged");
}

INSTANTIATE_TEST_SUITE_P(All, RoundTrip,
                         testing::Combine(testing::Values(MemoryKind::Device, MemoryKind::Host),
                                          testing::Values(Path::Mapped, Path::Staged)),
                         caseName);

TEST_P(RoundTrip, KernelDoublesWhatWasUploaded) {
    const uint32_t texels = 1000;
    const Buffer buffer = make("values", texels * 16);
    write(device_, buffer, counting(texels * 4, 7));
    run(device_, scaleKernel(device_, buffer, {2, 0}), groupsFor(texels), bytesOf(ScalePush{texels, 0}));
    const std::vector<uint32_t> values = read(device_, buffer, texels * 4);
    for (uint32_t i = 0; i < texels * 4; ++i) ASSERT_EQ(values[i], 2 * (7 + i)) << i;
}

TEST_P(RoundTrip, OffsetsAddressBytes) {
    const Buffer buffer = make("values", 4096);
    write(device_, buffer, std::vector<uint32_t>(1024, 0));
    write(device_, buffer, counting(700, 1), 404);
    EXPECT_EQ(read(device_, buffer, 700, 404), counting(700, 1));
    EXPECT_EQ(read(device_, buffer, 2, 400), (std::vector<uint32_t>{0, 1}));
    EXPECT_EQ(read(device_, buffer, 2, 404 + 699 * 4), (std::vector<uint32_t>{700, 0}));
}

TEST_P(RoundTrip, AnOddNumberOfBytes) {
    const Buffer buffer = make("bytes", 3001);
    std::vector<std::byte> bytes(3001);
    for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(i * 37 % 251);
    upload(device_, buffer, bytes);
    std::vector<std::byte> back(bytes.size());
    download(device_, buffer, back);
    EXPECT_EQ(back, bytes);
}

TEST_P(RoundTrip, HostBuffersAreMapped) {
    const Buffer buffer = make("values", 64);
    if (std::get<MemoryKind>(GetParam()) == MemoryKind::Device) {
        EXPECT_EQ(buffer.mapped(), nullptr);
        return;
    }
    write(device_, buffer, counting(16, 3));
    ASSERT_NE(buffer.mapped(), nullptr);
    EXPECT_EQ(std::memcmp(buffer.mapped(), counting(16, 3).data(), 64), 0);
    const uint32_t changed = 99;
    std::memcpy(buffer.mapped(), &changed, 4);
    EXPECT_EQ(read(device_, buffer, 1), std::vector<uint32_t>{99});
}

class BufferTest : public GpuTest {};

TEST_F(BufferTest, AccessesPastTheEndAreErrors) {
    const Buffer buffer(device_, "nodes", 64, Access::TexelBuffer, MemoryKind::Device);
    std::vector<std::byte> bytes(65);
    EXPECT_EQ(errorOf([&] { upload(device_, buffer, bytes); }),
              "an upload of 65 bytes at offset 0 passes the end of array \"nodes\" (64 bytes)");
    EXPECT_EQ(errorOf([&] { download(device_, buffer, std::span(bytes).first(1), 64); }),
              "a download of 1 bytes at offset 64 passes the end of array \"nodes\" (64 bytes)");
    EXPECT_EQ(
        errorOf([&] { download(device_, buffer, std::span(bytes).first(2), ~uint64_t{0}); }),
        "a download of 2 bytes at offset 18446744073709551615 passes the end of array \"nodes\" (64 bytes)");
    EXPECT_EQ(errorOf([&] { upload(device_, buffer, std::span(bytes).first(0), 64); }), "no error");
}

TEST_F(BufferTest, SizesAreWholeTexelsAndNeverZero) {
    const auto size = [&](uint64_t bytes) {
        return Buffer(device_, "b", bytes, Access::StorageBuffer, MemoryKind::Device).size();
    };
    EXPECT_EQ(size(0), 16u);
    EXPECT_EQ(size(1), 16u);
    EXPECT_EQ(size(16), 16u);
    EXPECT_EQ(size(17), 32u);
}

TEST_F(BufferTest, TooLargeForTheDevice) {
    DeviceLimits& limits = device_.state().physical.info.limits;
    limits.maxStorageBufferRange = 134217728;
    limits.maxTexelBufferElements = 65536;
    limits.maxAllocationSize = 150000000;
    const auto message = [&](uint64_t bytes, Access access) {
        return errorOf([&] { Buffer(device_, "nodes", bytes, access, MemoryKind::Device); });
    };
    EXPECT_EQ(message(134217744, Access::StorageBuffer),
              "array \"nodes\" needs 134217744 bytes, but this device binds at most 134217728 bytes as a "
              "storage buffer");
    EXPECT_EQ(
        message(1048577, Access::TexelBuffer),
        "array \"nodes\" needs 1048577 bytes, but this device binds at most 1048576 bytes as a texel buffer");
    limits.maxAllocationSize = 1000000;
    EXPECT_EQ(message(1048576, Access::TexelBuffer),
              "array \"nodes\" needs 1048576 bytes, but this device allocates at most 1000000 bytes at once");
}

// SwiftShader's limit is 2^30 bytes, of which it keeps some for itself: less than a page of them here.
TEST_F(BufferTest, TheLargestOneOfTheDeviceIsMade) {
    const DeviceLimits& limits = device_.info().limits;
    const uint64_t kept = device_.info().llvmpipe ? 0 : 4096;
    const uint64_t largest =
        std::min(limits.maxStorageBufferRange, limits.maxAllocationSize) / 16 * 16 - kept;
    ASSERT_TRUE(fits(largest, Access::StorageBuffer, limits));
    const Buffer buffer(device_, "largest", largest, Access::StorageBuffer, MemoryKind::Device);
    write(device_, buffer, {42}, largest - 4);
    EXPECT_EQ(read(device_, buffer, 1, largest - 4), std::vector<uint32_t>{42});
}

TEST_F(BufferTest, ADeviceWithoutTheMemoryType) {
    device_.state().physical.memory.memoryTypeCount = 0;
    EXPECT_EQ(errorOf([&] { Buffer(device_, "image", 64, Access::StorageBuffer, MemoryKind::Host); }),
              "array \"image\" needs 64 bytes, but this device has no host-visible memory for it");
    EXPECT_EQ(errorOf([&] { Buffer(device_, "image", 64, Access::StorageBuffer, MemoryKind::Device); }),
              "array \"image\" needs 64 bytes, but this device has no device-local memory for it");
}

}  // namespace glint::gpu::buffer_test
