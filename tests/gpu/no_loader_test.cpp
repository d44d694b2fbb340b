// Runs under CTest with a library search path on which libvulkan.so.1 is an empty file (CMakeLists.txt).
#include <gtest/gtest.h>

#include "core/error.h"
#include "gpu/device.h"

namespace glint::gpu::no_loader_test {
const std::string kMessage =
    "no Vulkan loader (libvulkan.so.1) found: install libvulkan1 and a driver such as mesa-vulkan-drivers";

template <typename Call>
void expectNoLoader(Call call) {
    try {
        call();
        FAIL() << "a loader was found; run this through ctest, which hides it";
    } catch (const Error& error) {
        EXPECT_EQ(error.what(), kMessage);
        EXPECT_EQ(error.kind(), ErrorKind::Device);
    }
}

TEST(NoLoader, IsReportedEveryTimeWithThePackages) {
    expectNoLoader([] { listDevices(); });
    expectNoLoader([] { listDevices(); });
    expectNoLoader([] { Device device; });
}

}  // namespace glint::gpu::no_loader_test
