// Runs under CTest with a library search path on which libvulkan.so.1 is an empty file (CMakeLists.txt).
#include <gtest/gtest.h>

#include "gpu/device.h"
#include "support/support.h"

namespace glint::gpu::no_loader_test {
using glint::test::errorOf;

const std::string kMessage =
    "no Vulkan loader (libvulkan.so.1) found: install libvulkan1 and a driver such as mesa-vulkan-drivers";

TEST(NoLoader, IsReportedEveryTimeWithThePackages) {
    const auto list = [] { listDevices(); };
    EXPECT_EQ(errorOf(ErrorKind::Device, list), kMessage);
    EXPECT_EQ(errorOf(ErrorKind::Device, list), kMessage);
    EXPECT_EQ(errorOf(ErrorKind::Device, [] { Device device; }), kMessage);
}

}  // namespace glint::gpu::no_loader_test
