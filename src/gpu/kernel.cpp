#include <algorithm>

#include "core/error.h"
#include "gpu/device_state.h"
#include "gpu/specialize.h"

namespace glint::gpu {
namespace {

std::string label(const std::string& name) {
    return "kernel \"" + name + "\": ";
}

VkDescriptorType descriptorType(Access access) {
    return access == Access::StorageBuffer ? VK_DESCRIPTOR_TYPE_STORAGE_BUFFER
                                           : VK_DESCRIPTOR_TYPE_STORAGE_TEXEL_BUFFER;
}

uint32_t count(const std::vector<Access>& bindings, Access access) {
    return static_cast<uint32_t>(std::count(bindings.begin(), bindings.end(), access));
}

void createLayouts(Program& program, const DeviceState& device) {
    const std::vector<Access>& accesses = program.key.bindings;
    std::vector<VkDescriptorSetLayoutBinding> bindings(accesses.size());
    for (uint32_t i = 0; i < bindings.size(); ++i) {
        bindings[i].binding = i;
        bindings[i].descriptorType = descriptorType(accesses[i]);
        bindings[i].descriptorCount = 1;
        bindings[i].stageFlags = VK_SHADER_STAGE_COMPUTE_BIT;
    }
    auto set = infoOf<VkDescriptorSetLayoutCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_LAYOUT_CREATE_INFO);
    set.bindingCount = static_cast<uint32_t>(bindings.size());
    set.pBindings = bindings.data();
    program.setLayout = create(device, "vkCreateDescriptorSetLayout", set,
                               device.vk.vkCreateDescriptorSetLayout, device.vk.vkDestroyDescriptorSetLayout);

    VkPushConstantRange range{};
    range.stageFlags = VK_SHADER_STAGE_COMPUTE_BIT;
    range.size = program.key.pushConstantBytes;
    auto layout = infoOf<VkPipelineLayoutCreateInfo>(VK_STRUCTURE_TYPE_PIPELINE_LAYOUT_CREATE_INFO);
    layout.setLayoutCount = 1;
    layout.pSetLayouts = program.setLayout.address();
    layout.pushConstantRangeCount = range.size > 0 ? 1 : 0;
    layout.pPushConstantRanges = &range;
    program.layout = create(device, "vkCreatePipelineLayout", layout, device.vk.vkCreatePipelineLayout,
                            device.vk.vkDestroyPipelineLayout);
}

void createPipeline(Program& program, const DeviceState& device) {
    const std::vector<uint32_t> specialized = specialize(program.key.spirv, program.key.constants);
    program.codeBytes = specialized.size() * sizeof(uint32_t);
    auto code = infoOf<VkShaderModuleCreateInfo>(VK_STRUCTURE_TYPE_SHADER_MODULE_CREATE_INFO);
    code.codeSize = program.codeBytes;
    code.pCode = specialized.data();
    const Handle<VkShaderModule> module =
        create(device, "vkCreateShaderModule", code, device.vk.vkCreateShaderModule,
               device.vk.vkDestroyShaderModule);

    auto info = infoOf<VkComputePipelineCreateInfo>(VK_STRUCTURE_TYPE_COMPUTE_PIPELINE_CREATE_INFO);
    info.stage.sType = VK_STRUCTURE_TYPE_PIPELINE_SHADER_STAGE_CREATE_INFO;
    info.stage.stage = VK_SHADER_STAGE_COMPUTE_BIT;
    info.stage.module = module.get();
    info.stage.pName = "main";
    info.layout = program.layout.get();
    VkPipeline pipeline = VK_NULL_HANDLE;
    check(device.vk.vkCreateComputePipelines(device.device, device.pipelineCache.get(), 1, &info, nullptr,
                                             &pipeline),
          "vkCreateComputePipelines");
    program.pipeline = Handle<VkPipeline>(device, pipeline, device.vk.vkDestroyPipeline);
}

std::shared_ptr<const Program> compile(const DeviceState& device, ProgramKey key) {
    auto program = std::make_shared<Program>();
    program->key = std::move(key);
    createLayouts(*program, device);
    createPipeline(*program, device);
    return program;
}

// Compiles outside the lock: several threads may want different programs at once.
std::shared_ptr<const Program> programOf(DeviceState& device, const KernelOptions& options) {
    ProgramKey key{{options.spirv.begin(), options.spirv.end()},
                   options.bindings,
                   options.constants,
                   options.pushConstantBytes};
    {
        const std::lock_guard lock(device.programsMutex);
        auto& kept = device.programs;
        const auto found =
            std::find_if(kept.begin(), kept.end(), [&](const auto& program) { return program->key == key; });
        if (found != kept.end()) {
            std::rotate(kept.begin(), found, found + 1);
            return kept.front();
        }
    }
    auto program = compile(device, std::move(key));
    if (!device.keepsPrograms) return program;
    const std::lock_guard lock(device.programsMutex);
    device.programs.insert(device.programs.begin(), program);
    if (device.programs.size() > DeviceState::kKeptPrograms) device.programs.pop_back();
    return program;
}

void createSet(KernelState& state, const DeviceState& device) {
    std::vector<VkDescriptorPoolSize> sizes;
    for (const Access access : {Access::StorageBuffer, Access::TexelBuffer}) {
        const uint32_t used = count(state.program->key.bindings, access);
        if (used > 0) sizes.push_back({descriptorType(access), used});
    }
    if (sizes.empty()) return;
    auto pool = infoOf<VkDescriptorPoolCreateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_POOL_CREATE_INFO);
    pool.maxSets = 1;
    pool.poolSizeCount = static_cast<uint32_t>(sizes.size());
    pool.pPoolSizes = sizes.data();
    state.pool = create(device, "vkCreateDescriptorPool", pool, device.vk.vkCreateDescriptorPool,
                        device.vk.vkDestroyDescriptorPool);
    auto set = infoOf<VkDescriptorSetAllocateInfo>(VK_STRUCTURE_TYPE_DESCRIPTOR_SET_ALLOCATE_INFO);
    set.descriptorPool = state.pool.get();
    set.descriptorSetCount = 1;
    set.pSetLayouts = state.program->setLayout.address();
    check(device.vk.vkAllocateDescriptorSets(device.device, &set, &state.set), "vkAllocateDescriptorSets");
}

}  // namespace

Kernel::Kernel(const Device& device, const KernelOptions& options) : state_(std::make_shared<KernelState>()) {
    DeviceState& owner = device.state();
    state_->device = &owner;
    state_->name = options.name;
    try {
        state_->program = programOf(owner, options);
        createSet(*state_, owner);
    } catch (const Error& error) {
        throw Error(error.kind(), label(options.name) + error.what());
    }
}

uint64_t Kernel::codeBytes() const {
    return state_->program->codeBytes;
}

void Kernel::bind(std::span<const Buffer* const> buffers) {
    std::vector<VkDescriptorBufferInfo> infos(buffers.size());
    std::vector<VkWriteDescriptorSet> writes(buffers.size());
    for (uint32_t i = 0; i < writes.size(); ++i) {
        const BufferState& buffer = buffers[i]->state();
        infos[i] = {buffer.buffer.get(), 0, VK_WHOLE_SIZE};
        writes[i].sType = VK_STRUCTURE_TYPE_WRITE_DESCRIPTOR_SET;
        writes[i].dstSet = state_->set;
        writes[i].dstBinding = i;
        writes[i].descriptorCount = 1;
        writes[i].descriptorType = descriptorType(buffer.access);
        if (buffer.access == Access::StorageBuffer) {
            writes[i].pBufferInfo = &infos[i];
        } else {
            writes[i].pTexelBufferView = buffer.view.address();
        }
    }
    const DeviceState& device = *state_->device;
    device.vk.vkUpdateDescriptorSets(device.device, static_cast<uint32_t>(writes.size()), writes.data(), 0,
                                     nullptr);
}

}  // namespace glint::gpu
