#include "core/error.h"
#include "core/stopwatch.h"
#include "gpu/device_state.h"

namespace glint::gpu {
namespace {

constexpr VkPipelineStageFlags kDeviceStages =
    VK_PIPELINE_STAGE_COMPUTE_SHADER_BIT | VK_PIPELINE_STAGE_TRANSFER_BIT;
constexpr VkAccessFlags kDeviceWrites = VK_ACCESS_SHADER_WRITE_BIT | VK_ACCESS_TRANSFER_WRITE_BIT;
constexpr VkAccessFlags kDeviceReads = VK_ACCESS_SHADER_READ_BIT | VK_ACCESS_TRANSFER_READ_BIT;

void barrier(const SubmissionState& state, VkPipelineStageFlags nextStages, VkAccessFlags nextAccess) {
    auto memory = infoOf<VkMemoryBarrier>(VK_STRUCTURE_TYPE_MEMORY_BARRIER);
    memory.srcAccessMask = kDeviceWrites;
    memory.dstAccessMask = nextAccess;
    state.device.vk.vkCmdPipelineBarrier(state.commands.buffer, kDeviceStages, nextStages, 0, 1, &memory, 0,
                                         nullptr, 0, nullptr);
}

// Before each command. The first one's barrier is for what earlier submissions wrote.
void prepareCommand(SubmissionState& state) {
    const VolkDeviceTable& vk = state.device.vk;
    if (!state.recording) {
        state.commands.begin();
        state.recording = true;
        if (state.timestamps) {
            vk.vkCmdResetQueryPool(state.commands.buffer, state.timestamps.get(), 0, 2);
            vk.vkCmdWriteTimestamp(state.commands.buffer, VK_PIPELINE_STAGE_TOP_OF_PIPE_BIT,
                                   state.timestamps.get(), 0);
        }
    }
    barrier(state, kDeviceStages, kDeviceReads | kDeviceWrites);
}

double deviceSeconds(const SubmissionState& state) {
    if (!state.timestamps) return 0;
    const DeviceState& device = state.device;
    uint64_t ticks[2] = {};
    check(
        device.vk.vkGetQueryPoolResults(device.device, state.timestamps.get(), 0, 2, sizeof(ticks), ticks,
                                        sizeof(ticks[0]), VK_QUERY_RESULT_64_BIT | VK_QUERY_RESULT_WAIT_BIT),
        "vkGetQueryPoolResults");
    // The counter has timestampBits and wraps; the difference modulo its width is right unless a batch
    // outlasts a period.
    const uint32_t bits = device.physical.timestampBits;
    const uint64_t mask = bits >= 64 ? ~uint64_t{0} : (uint64_t{1} << bits) - 1;
    const double nanoseconds =
        static_cast<double>((ticks[1] - ticks[0]) & mask) * device.physical.info.limits.timestampPeriod;
    return nanoseconds * 1e-9;
}

}  // namespace

Commands::Commands(DeviceState& owner) : device(owner) {
    auto poolInfo = infoOf<VkCommandPoolCreateInfo>(VK_STRUCTURE_TYPE_COMMAND_POOL_CREATE_INFO);
    poolInfo.queueFamilyIndex = device.physical.queueFamily;
    pool = create(device, "vkCreateCommandPool", poolInfo, device.vk.vkCreateCommandPool,
                  device.vk.vkDestroyCommandPool);
    auto info = infoOf<VkCommandBufferAllocateInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_ALLOCATE_INFO);
    info.commandPool = pool.get();
    info.level = VK_COMMAND_BUFFER_LEVEL_PRIMARY;
    info.commandBufferCount = 1;
    check(device.vk.vkAllocateCommandBuffers(device.device, &info, &buffer), "vkAllocateCommandBuffers");
    auto fenceInfo = infoOf<VkFenceCreateInfo>(VK_STRUCTURE_TYPE_FENCE_CREATE_INFO);
    fenceInfo.flags = VK_FENCE_CREATE_SIGNALED_BIT;
    fence = create(device, "vkCreateFence", fenceInfo, device.vk.vkCreateFence, device.vk.vkDestroyFence);
}

void Commands::begin() {
    check(device.vk.vkResetCommandPool(device.device, pool.get(), 0), "vkResetCommandPool");
    auto info = infoOf<VkCommandBufferBeginInfo>(VK_STRUCTURE_TYPE_COMMAND_BUFFER_BEGIN_INFO);
    info.flags = VK_COMMAND_BUFFER_USAGE_ONE_TIME_SUBMIT_BIT;
    check(device.vk.vkBeginCommandBuffer(buffer, &info), "vkBeginCommandBuffer");
}

void Commands::submit(VkSubmitInfo info) {
    check(device.vk.vkEndCommandBuffer(buffer), "vkEndCommandBuffer");
    info.commandBufferCount = 1;
    info.pCommandBuffers = &buffer;
    check(device.vk.vkResetFences(device.device, 1, fence.address()), "vkResetFences");
    const std::lock_guard lock(device.queueMutex);
    check(device.vk.vkQueueSubmit(device.queue, 1, &info, fence.get()), "vkQueueSubmit");
}

void Commands::wait() {
    const uint64_t seconds = device.timeoutSeconds();
    const VkResult result =
        device.vk.vkWaitForFences(device.device, 1, fence.address(), VK_TRUE, seconds * 1'000'000'000);
    if (result == VK_TIMEOUT) {
        device.abandoned = true;
        throw Error(ErrorKind::Device, "the device \"" + device.physical.info.name +
                                           "\" hangs: a batch of work has not finished after " +
                                           std::to_string(seconds) + " s");
    }
    check(result, "vkWaitForFences");
}

SubmissionState::SubmissionState(DeviceState& owner) : device(owner), commands(owner) {
    if (device.physical.info.limits.timestampPeriod == 0) return;
    auto queries = infoOf<VkQueryPoolCreateInfo>(VK_STRUCTURE_TYPE_QUERY_POOL_CREATE_INFO);
    queries.queryType = VK_QUERY_TYPE_TIMESTAMP;
    queries.queryCount = 2;
    timestamps = create(device, "vkCreateQueryPool", queries, device.vk.vkCreateQueryPool,
                        device.vk.vkDestroyQueryPool);
}

Submission::Submission(const Device& device) : state_(std::make_shared<SubmissionState>(device.state())) {}

void Submission::dispatch(const Kernel& kernel, uint32_t groupsX, std::span<const std::byte> pushConstants) {
    const KernelState& k = kernel.state();
    const DeviceState& device = state_->device;
    const uint32_t mostGroups = device.physical.info.limits.maxWorkgroupCountX;
    if (groupsX > mostGroups) {
        throw Error(ErrorKind::Device, "kernel \"" + k.name + "\": a dispatch of " + std::to_string(groupsX) +
                                           " workgroups, but this device runs at most " +
                                           std::to_string(mostGroups));
    }
    if (groupsX == 0) return;
    prepareCommand(*state_);
    const VkCommandBuffer commands = state_->commands.buffer;
    device.vk.vkCmdBindPipeline(commands, VK_PIPELINE_BIND_POINT_COMPUTE, k.program->pipeline.get());
    if (k.set != VK_NULL_HANDLE) {
        device.vk.vkCmdBindDescriptorSets(commands, VK_PIPELINE_BIND_POINT_COMPUTE, k.program->layout.get(),
                                          0, 1, &k.set, 0, nullptr);
    }
    if (!pushConstants.empty()) {
        device.vk.vkCmdPushConstants(commands, k.program->layout.get(), VK_SHADER_STAGE_COMPUTE_BIT, 0,
                                     static_cast<uint32_t>(pushConstants.size()), pushConstants.data());
    }
    device.vk.vkCmdDispatch(commands, groupsX, 1, 1);
}

void Submission::copy(const Buffer& source, uint64_t sourceOffset, const Buffer& destination,
                      uint64_t destinationOffset, uint64_t bytes) {
    checkRange("a copy", source, sourceOffset, bytes);
    checkRange("a copy", destination, destinationOffset, bytes);
    if (bytes == 0) return;
    prepareCommand(*state_);
    const VkBufferCopy region{sourceOffset, destinationOffset, bytes};
    state_->device.vk.vkCmdCopyBuffer(state_->commands.buffer, source.state().buffer.get(),
                                      destination.state().buffer.get(), 1, &region);
}

Submission::Times Submission::submit() {
    if (!state_->recording) return {};
    state_->recording = false;
    barrier(*state_, VK_PIPELINE_STAGE_HOST_BIT, VK_ACCESS_HOST_READ_BIT);
    if (state_->timestamps) {
        state_->device.vk.vkCmdWriteTimestamp(state_->commands.buffer, VK_PIPELINE_STAGE_BOTTOM_OF_PIPE_BIT,
                                              state_->timestamps.get(), 1);
    }
    const Stopwatch watch;
    state_->commands.submit();
    state_->commands.wait();
    return {watch.seconds(), deviceSeconds(*state_)};
}

}  // namespace glint::gpu
