// Finished pictures on a window: each is copied from the host into an image of the window's swapchain. Needs
// no graphics queue, no render pass and no shader, so it works on every device that can compute and present.
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "gpu/device.h"

namespace glint::gpu {

struct SwapchainState;

class Swapchain {
  public:
    // `device` must have been made with DeviceOptions::window and outlive the swapchain, which waits for the
    // screen (VK_PRESENT_MODE_FIFO_KHR).
    Swapchain(const Device& device, int width, int height);
    ~Swapchain();
    Swapchain(const Swapchain&) = delete;
    Swapchain& operator=(const Swapchain&) = delete;

    // Shows width x height pixels, bytes R, G, B, A (A is ignored), top row first. The swapchain follows the
    // window's size by itself; where that differs from the picture's, the common part is shown. False if
    // nothing could be shown just now: the window is minimised, or changed size twice in a row. Throws
    // Error(Device), or DeviceLost.
    bool present(std::span<const uint32_t> pixels, int width, int height);

  private:
    std::unique_ptr<SwapchainState> state_;
};

}  // namespace glint::gpu
