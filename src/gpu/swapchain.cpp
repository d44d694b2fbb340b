#include "gpu/swapchain.h"

#include <algorithm>
#include <cstring>
#include <vector>

#include "core/error.h"
#include "gpu/device_state.h"

namespace glint::gpu {

namespace {

// An image that no other program gives back within this time will not come: the window system hangs.
constexpr uint64_t kAcquireNanoseconds = 5'000'000'000;

VkSurfaceCapabilitiesKHR capabilitiesOf(const DeviceState& device) {
    VkSurfaceCapabilitiesKHR capabilities{};
    check(vkGetPhysicalDeviceSurfaceCapabilitiesKHR(device.physical.handle, device.surface, &capabilities),
          "vkGetPhysicalDeviceSurfaceCapabilitiesKHR");
    return capabilities;
}

// Eight-bit and not sRGB: the bytes are encoded already.
VkSurfaceFormatKHR chooseFormat(const DeviceState& device) {
    const auto formats = enumerate<VkSurfaceFormatKHR>("vkGetPhysicalDeviceSurfaceFormatsKHR",
                                                       vkGetPhysicalDeviceSurfaceFormatsKHR,
                                                       device.physical.handle, device.surface);
    for (const VkSurfaceFormatKHR& format : formats) {
        const bool known =
            format.format == VK_FORMAT_B8G8R8A8_UNORM || format.format == VK_FORMAT_R8G8B8A8_UNORM;
        if (known && format.colorSpace == VK_COLOR_SPACE_SRGB_NONLINEAR_KHR) return format;
    }
    throw Error(ErrorKind::Device,
                "the window takes no image of 8 bits a channel on this device: use glint render");
}

}  // namespace

struct SwapchainState {
    const Device& device;
    DeviceState& state;

    Handle<VkSwapchainKHR> chain;
    VkExtent2D extent{};
    int askedWidth = 0, askedHeight = 0;  // what the chain was made for; the window may have had another size
    VkFormat format = VK_FORMAT_UNDEFINED;
    std::vector<VkImage> images;
    std::vector<Handle<VkSemaphore>> drawn;  // for each image: its copy is complete
    Handle<VkSemaphore> acquired;
    Commands commands;  // the last copy
    Buffer pixels;

    explicit SwapchainState(const Device& d);
    ~SwapchainState();

    // Drops the old chain and makes one of the window's present size; none while that is zero.
    void rebuild(int width, int height);
    VkSwapchainCreateInfoKHR describe(const VkSurfaceCapabilitiesKHR& capabilities, int width, int height);
    void fillPixels(std::span<const uint32_t> source, int width, int height);
    void recordCopy(VkImage image);
    void submitCopy(uint32_t index);
    bool presentOnce(std::span<const uint32_t> source, int width, int height);
    void waitUntilIdle();
};

SwapchainState::SwapchainState(const Device& d) : device(d), state(d.state()), commands(state) {}

SwapchainState::~SwapchainState() {
    if (state.abandoned) return;
    const std::lock_guard lock(state.queueMutex);
    state.vk.vkQueueWaitIdle(
        state.queue);  // a lost device has nothing to wait for; the result does not matter
}

// A fence signals the end of the copy, but nothing signals that the window system has waited for its
// semaphore.
void SwapchainState::waitUntilIdle() {
    const std::lock_guard lock(state.queueMutex);
    check(state.vk.vkQueueWaitIdle(state.queue), "vkQueueWaitIdle");
}

VkSwapchainCreateInfoKHR SwapchainState::describe(const VkSurfaceCapabilitiesKHR& capabilities, int width,
                                                  int height) {
    if ((capabilities.supportedUsageFlags & VK_IMAGE_USAGE_TRANSFER_DST_BIT) == 0)
        throw Error(ErrorKind::Device, "the window takes no copied images on this device: use glint render");
    const VkSurfaceFormatKHR chosen = chooseFormat(state);
    format = chosen.format;
    extent = capabilities.currentExtent;
    if (extent.width == UINT32_MAX) {  // the window takes the size of its pictures
        extent.width = std::clamp(static_cast<uint32_t>(width), capabilities.minImageExtent.width,
                                  capabilities.maxImageExtent.width);
        extent.height = std::clamp(static_cast<uint32_t>(height), capabilities.minImageExtent.height,
                                   capabilities.maxImageExtent.height);
    }
    auto info = infoOf<VkSwapchainCreateInfoKHR>(VK_STRUCTURE_TYPE_SWAPCHAIN_CREATE_INFO_KHR);
    info.surface = state.surface;
    // One to draw into beside those that the screen may hold, and three at least: with two (SwiftShader holds
    // one) a late picture waits for a whole turn of the screen, as best-practices validation says.
    info.minImageCount = std::max(capabilities.minImageCount + 1, 3u);
    if (capabilities.maxImageCount > 0)
        info.minImageCount = std::min(info.minImageCount, capabilities.maxImageCount);
    info.imageFormat = chosen.format;
    info.imageColorSpace = chosen.colorSpace;
    info.imageExtent = extent;
    info.imageArrayLayers = 1;
    info.imageUsage = VK_IMAGE_USAGE_TRANSFER_DST_BIT;
    info.imageSharingMode = VK_SHARING_MODE_EXCLUSIVE;
    info.preTransform = capabilities.currentTransform;
    info.compositeAlpha = VK_COMPOSITE_ALPHA_OPAQUE_BIT_KHR;
    if ((capabilities.supportedCompositeAlpha & info.compositeAlpha) == 0) {
        info.compositeAlpha = static_cast<VkCompositeAlphaFlagBitsKHR>(
            capabilities.supportedCompositeAlpha & (~capabilities.supportedCompositeAlpha + 1));
    }
    info.clipped = VK_TRUE;
    return info;
}

void SwapchainState::rebuild(int width, int height) {
    waitUntilIdle();
    askedWidth = width;
    askedHeight = height;
    const VkSurfaceCapabilitiesKHR capabilities = capabilitiesOf(state);
    VkSwapchainCreateInfoKHR info = describe(capabilities, width, height);
    info.presentMode = VK_PRESENT_MODE_FIFO_KHR;  // every screen offers it
    drawn.clear();
    images.clear();
    if (extent.width == 0 || extent.height == 0) {  // minimised
        chain = {};
        return;
    }
    info.oldSwapchain = chain.get();
    Handle<VkSwapchainKHR> next = create(state, "vkCreateSwapchainKHR", info, state.vk.vkCreateSwapchainKHR,
                                         state.vk.vkDestroySwapchainKHR);
    chain = {};  // the old one goes before its semaphores' successors come
    chain = std::move(next);
    images = enumerate<VkImage>("vkGetSwapchainImagesKHR", state.vk.vkGetSwapchainImagesKHR, state.device,
                                chain.get());
    auto semaphore = infoOf<VkSemaphoreCreateInfo>(VK_STRUCTURE_TYPE_SEMAPHORE_CREATE_INFO);
    const auto makeSemaphore = [&] {
        return create(state, "vkCreateSemaphore", semaphore, state.vk.vkCreateSemaphore,
                      state.vk.vkDestroySemaphore);
    };
    // A failed acquire may leave the semaphore in any state, so it is new with every chain.
    acquired = makeSemaphore();
    for (size_t i = 0; i < images.size(); ++i) drawn.push_back(makeSemaphore());
    pixels = Buffer();
    pixels = Buffer(device, "window picture", uint64_t{extent.width} * extent.height * 4,
                    Access::StorageBuffer, MemoryKind::Host);
}

void SwapchainState::fillPixels(std::span<const uint32_t> source, int width, int height) {
    auto* target = static_cast<uint32_t*>(pixels.mapped());
    const size_t columns = std::min<size_t>(static_cast<size_t>(width), extent.width);
    const size_t rows = std::min<size_t>(static_cast<size_t>(height), extent.height);
    if (columns < extent.width || rows < extent.height) std::memset(target, 0, pixels.size());
    for (size_t y = 0; y < rows; ++y) {
        const uint32_t* in = source.data() + y * static_cast<size_t>(width);
        uint32_t* out = target + y * extent.width;
        if (format == VK_FORMAT_R8G8B8A8_UNORM) {
            std::copy_n(in, columns, out);
            continue;
        }
        for (size_t x = 0; x < columns; ++x) {
            const uint32_t p = in[x];
            out[x] = (p & 0xff00ff00u) | (p & 0xffu) << 16 | (p >> 16 & 0xffu);
        }
    }
}

void SwapchainState::recordCopy(VkImage image) {
    const VolkDeviceTable& vk = state.vk;
    commands.begin();
    auto barrier = infoOf<VkImageMemoryBarrier>(VK_STRUCTURE_TYPE_IMAGE_MEMORY_BARRIER);
    barrier.dstAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
    barrier.oldLayout = VK_IMAGE_LAYOUT_UNDEFINED;
    barrier.newLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    barrier.srcQueueFamilyIndex = barrier.dstQueueFamilyIndex = VK_QUEUE_FAMILY_IGNORED;
    barrier.image = image;
    barrier.subresourceRange = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 1, 0, 1};
    // From the stage in which the submission waits for the image, so that the two are in order.
    vk.vkCmdPipelineBarrier(commands.buffer, VK_PIPELINE_STAGE_TRANSFER_BIT, VK_PIPELINE_STAGE_TRANSFER_BIT,
                            0, 0, nullptr, 0, nullptr, 1, &barrier);
    VkBufferImageCopy copy{};
    copy.imageSubresource = {VK_IMAGE_ASPECT_COLOR_BIT, 0, 0, 1};
    copy.imageExtent = {extent.width, extent.height, 1};
    vk.vkCmdCopyBufferToImage(commands.buffer, pixels.state().buffer.get(), image,
                              VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL, 1, &copy);
    barrier.srcAccessMask = VK_ACCESS_TRANSFER_WRITE_BIT;
    barrier.dstAccessMask = 0;
    barrier.oldLayout = VK_IMAGE_LAYOUT_TRANSFER_DST_OPTIMAL;
    barrier.newLayout = VK_IMAGE_LAYOUT_PRESENT_SRC_KHR;
    vk.vkCmdPipelineBarrier(commands.buffer, VK_PIPELINE_STAGE_TRANSFER_BIT,
                            VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT, 0, 0, nullptr, 0, nullptr, 1, &barrier);
}

void SwapchainState::submitCopy(uint32_t index) {
    const VkPipelineStageFlags stage = VK_PIPELINE_STAGE_TRANSFER_BIT;
    auto info = infoOf<VkSubmitInfo>(VK_STRUCTURE_TYPE_SUBMIT_INFO);
    info.waitSemaphoreCount = 1;
    info.pWaitSemaphores = acquired.address();
    info.pWaitDstStageMask = &stage;
    info.signalSemaphoreCount = 1;
    info.pSignalSemaphores = drawn[index].address();
    commands.submit(info);
}

// False: the chain no longer fits the window.
bool SwapchainState::presentOnce(std::span<const uint32_t> source, int width, int height) {
    commands.wait();
    uint32_t index = 0;
    const VkResult got = state.vk.vkAcquireNextImageKHR(state.device, chain.get(), kAcquireNanoseconds,
                                                        acquired.get(), VK_NULL_HANDLE, &index);
    if (got == VK_ERROR_OUT_OF_DATE_KHR) return false;
    check(got, "vkAcquireNextImageKHR");
    if (got == VK_TIMEOUT || got == VK_NOT_READY)
        throw Error(ErrorKind::Device, "the window system gave no image to draw on within 5 s");
    fillPixels(source, width, height);
    recordCopy(images[index]);
    submitCopy(index);

    auto present = infoOf<VkPresentInfoKHR>(VK_STRUCTURE_TYPE_PRESENT_INFO_KHR);
    present.waitSemaphoreCount = 1;
    present.pWaitSemaphores = drawn[index].address();
    present.swapchainCount = 1;
    present.pSwapchains = chain.address();
    present.pImageIndices = &index;
    VkResult shown = VK_SUCCESS;
    {
        const std::lock_guard lock(state.queueMutex);
        shown = state.vk.vkQueuePresentKHR(state.queue, &present);
    }
    if (shown == VK_ERROR_OUT_OF_DATE_KHR || shown == VK_SUBOPTIMAL_KHR) return false;
    check(shown, "vkQueuePresentKHR");
    return got != VK_SUBOPTIMAL_KHR;
}

Swapchain::Swapchain(const Device& device, int width, int height)
    : state_(std::make_unique<SwapchainState>(device)) {
    state_->rebuild(width, height);
}

Swapchain::~Swapchain() = default;

bool Swapchain::present(std::span<const uint32_t> pixels, int width, int height) {
    SwapchainState& s = *state_;
    if (!s.chain || s.askedWidth != width || s.askedHeight != height) s.rebuild(width, height);
    if (!s.chain) return false;
    if (s.presentOnce(pixels, width, height)) return true;
    s.rebuild(width, height);
    return s.chain && s.presentOnce(pixels, width, height);
}

}  // namespace glint::gpu
