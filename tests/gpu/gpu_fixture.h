// A device with the validation layer for each test; the test fails if the layer reports anything.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/error.h"
#include "gpu/compute.h"
#include "gpu/device_state.h"
#include "support/support.h"

namespace glint::gpu {

inline DeviceOptions withValidation() {
    return {.validation = true};
}

class GpuTest : public testing::Test {
  protected:
    void TearDown() override {
        for (const std::string& message : device_.validationMessages()) ADD_FAILURE() << message;
    }

    Device device_{withValidation()};
};

// The name of a parameterised test's case.
inline std::string accessName(const testing::TestParamInfo<Access>& access) {
    return access.param == Access::StorageBuffer ? "Storage" : "Texel";
}

inline std::vector<uint32_t> counting(size_t values, uint32_t first = 0) {
    std::vector<uint32_t> result(values);
    for (size_t i = 0; i < values; ++i) result[i] = first + static_cast<uint32_t>(i);
    return result;
}

inline std::vector<uint32_t> read(const Device& device, const Buffer& buffer, size_t values,
                                  uint64_t offset = 0) {
    std::vector<uint32_t> result(values);
    download(device, buffer, std::as_writable_bytes(std::span(result)), offset);
    return result;
}

inline void write(const Device& device, const Buffer& buffer, const std::vector<uint32_t>& values,
                  uint64_t offset = 0) {
    upload(device, buffer, std::as_bytes(std::span(values)), offset);
}

// The message of the Error(Device) that `call` throws.
inline std::string errorOf(const std::function<void()>& call) {
    return glint::test::errorOf(ErrorKind::Device, call);
}

// ---- the kernels of this folder ----

struct ScalePush {
    uint32_t count = 0;  // texels
    uint32_t addend = 0;
};

inline uint32_t groupsFor(uint32_t texels) {
    return (texels + 63) / 64;
}

// A buffer of 0, 1, 2, ... in the device's memory.
inline Buffer countingBuffer(const Device& device, size_t values, Access access = Access::StorageBuffer) {
    Buffer buffer(device, "values", values * 4, access, MemoryKind::Device);
    write(device, buffer, counting(values));
    return buffer;
}

// One dispatch, done when this returns.
inline Submission::Times run(const Device& device, const Kernel& kernel, uint32_t groups,
                             std::span<const std::byte> push = {}) {
    Submission submission(device);
    submission.dispatch(kernel, groups, push);
    return submission.submit();
}

// constants: FACTOR, then ADDS. With a buffer, bound to it.
Kernel scaleKernel(const Device& device, Access access, std::vector<uint32_t> constants);
Kernel scaleKernel(const Device& device, const Buffer& buffer, std::vector<uint32_t> constants);
Kernel reverseKernel(const Device& device);
Kernel twistsKernel(const Device& device);
Kernel emptyKernel(const Device& device);

}  // namespace glint::gpu
