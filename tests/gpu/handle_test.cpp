#include "gpu/handle.h"

#include <gtest/gtest.h>

#include <vector>

namespace glint::gpu::handle_test {
namespace {

std::vector<VkBuffer> destroyed;

VkBuffer fake(uintptr_t value) {
    return reinterpret_cast<VkBuffer>(value);
}

void VKAPI_PTR recordDestroy(VkDevice, VkBuffer buffer, const VkAllocationCallbacks*) {
    destroyed.push_back(buffer);
}

class HandleTest : public testing::Test {
  protected:
    HandleTest() { destroyed.clear(); }
    Handle<VkBuffer> make(uintptr_t value) { return Handle<VkBuffer>(context_, fake(value), recordDestroy); }
    DeviceContext context_;
};

TEST_F(HandleTest, DestroysItsObjectOnce) {
    { const Handle<VkBuffer> handle = make(1); }
    EXPECT_EQ(destroyed, std::vector{fake(1)});
}

TEST_F(HandleTest, AnEmptyOneDestroysNothing) {
    { const Handle<VkBuffer> handle; }
    EXPECT_TRUE(destroyed.empty());
}

TEST_F(HandleTest, MovingHandsTheObjectOver) {
    Handle<VkBuffer> first = make(1);
    const Handle<VkBuffer> second = std::move(first);
    EXPECT_FALSE(first);
    EXPECT_EQ(second.get(), fake(1));
    EXPECT_TRUE(destroyed.empty());
}

TEST_F(HandleTest, AssigningDestroysTheOldObject) {
    Handle<VkBuffer> handle = make(1);
    handle = make(2);
    EXPECT_EQ(destroyed, std::vector{fake(1)});
    handle = {};
    EXPECT_EQ(destroyed, (std::vector{fake(1), fake(2)}));
}

TEST_F(HandleTest, LeaksOnADeviceThatHangs) {
    {
        const Handle<VkBuffer> handle = make(1);
        context_.abandoned = true;
    }
    EXPECT_TRUE(destroyed.empty());
}

}  // namespace
}  // namespace glint::gpu::handle_test
