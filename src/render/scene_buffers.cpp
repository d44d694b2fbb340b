#include "render/scene_buffers.h"

#include <algorithm>

#include "bvh/packet_tree.h"

namespace glint::render {

namespace {

#define GLINT_NAME_BINDING(binding, field, Struct, ROWS) constexpr uint32_t field##Binding = binding;
GLINT_SCENE_ARRAYS(GLINT_NAME_BINDING)
#undef GLINT_NAME_BINDING

// Bytes after the last triangle. A packet's 8 lanes load 8 texels from a triangle on, which has three; the
// rest is unused (packet/packet.glsl).
constexpr size_t kPacketOverrun = 5 * sizeof(glm::vec4);
// Bytes after the last attribute. Colours follow a triangle's texture coordinates, and their rows are loaded
// even for a triangle without colours (primitives/triangle.glsl).
constexpr size_t kAttributeOverrun = 3 * sizeof(shared::VertexAttribute);

// Place of the storage buffer that holds all arrays.
constexpr uint32_t kTogether = 2;
constexpr uint64_t kTexelBytes = 16;
constexpr uint64_t kHeadBytes =
    (GLINT_BINDING_COUNT * sizeof(uint32_t) + kTexelBytes - 1) / kTexelBytes * kTexelBytes;
static_assert(samplesBinding == shared::kSamplesBinding);

// Size of the zeros that stand in for an absent array: the first element of any struct, or the rows of a
// triangle's colours, whichever is larger.
#define GLINT_LARGER_STRUCT(binding, field, Struct, ROWS) largest = std::max(largest, sizeof(shared::Struct));
constexpr size_t kZeroBytes = [] {
    size_t largest = 5 * sizeof(shared::VertexAttribute);
    GLINT_SCENE_ARRAYS(GLINT_LARGER_STRUCT)
    return largest;
}();
#undef GLINT_LARGER_STRUCT
constexpr std::array<std::byte, kZeroBytes> kZeros{};

// Arrays that the scene lacks. setView fills the camera, setSamples the samples.
struct Others {
    shared::Camera camera;
    std::vector<shared::PacketCorner> packetCorners;
    std::vector<shared::Sample> samples;
};

// Calls visit(binding, name, bytes) for each array. A template, so that `requires` finds the array's owner.
template <typename Packed, typename More, typename Visit>
void visitArrays(const Packed& scene, const More& others, const Visit& visit) {
    const auto bytesOf = [](const auto& array) {
        if constexpr (requires { array.data(); }) {
            return std::as_bytes(std::span(array.data(), array.size()));
        } else {
            return gpu::bytesOf(array);
        }
    };
#define GLINT_VISIT(BINDING, field, Struct, ROWS)     \
    if constexpr (requires { scene.field; })          \
        visit(BINDING, #field, bytesOf(scene.field)); \
    else                                              \
        visit(BINDING, #field, bytesOf(others.field));
    GLINT_SCENE_ARRAYS(GLINT_VISIT)
#undef GLINT_VISIT
}

// True if the device can bind the arrays as texel buffers (GLINT_BINDING_COUNT, each at most `largest`), or
// as one storage buffer of `sum`. Every Vulkan device binds 4 storage buffers, as many as this needs.
bool hasAccess(const gpu::DeviceInfo& device, gpu::Access access, const ArraySizes& sizes) {
    if (access == gpu::Access::StorageBuffer) return gpu::fits(sizes.sum, access, device.limits);
    return device.limits.maxStorageImagesPerStage >= GLINT_BINDING_COUNT &&
           gpu::fits(sizes.largest, access, device.limits);
}

size_t overrunOf(uint32_t binding, bool packets) {
    if (binding == vertexAttributesBinding) return kAttributeOverrun;
    return packets && binding == trianglesBinding ? kPacketOverrun : 0;
}

}  // namespace

ArraySizes arraySizes(const PackedScene& scene) {
    ArraySizes sizes;
    visitArrays(scene, Others{}, [&](uint32_t binding, const char*, std::span<const std::byte> data) {
        const uint64_t bytes = data.size() + overrunOf(binding, true);
        sizes.largest = std::max(sizes.largest, bytes);
        sizes.sum += bytes;
    });
    sizes.sum +=
        kHeadBytes + kZeroBytes + std::as_bytes(std::span(scene.nodes)).size();  // room for a wide BVH
    return sizes;
}

gpu::Access chooseAccess(const gpu::DeviceInfo& device, const ArraySizes& sizes) {
    using enum gpu::Access;
    const bool texels = hasAccess(device, TexelBuffer, sizes);
    return texels && (device.llvmpipe || !hasAccess(device, StorageBuffer, sizes)) ? TexelBuffer
                                                                                   : StorageBuffer;
}

SceneBuffers::SceneBuffers(const gpu::Device& device, const PackedScene& scene, gpu::Access access,
                           const TraversalChoice& traversal)
    : device_(&device), access_(access) {
    Others others;
    if (traversal.packets) others.packetCorners = packetTree(scene.nodes, &packetSlots_, device.context());
    zeros_ = gpu::Buffer(device, "zeros", kZeroBytes, access, gpu::MemoryKind::Device);
    gpu::upload(device, zeros_, kZeros);
    if (access == gpu::Access::StorageBuffer) {
        std::array<uint64_t, GLINT_BINDING_COUNT> sizes{};
        visitArrays(scene, others, [&](uint32_t binding, const char*, std::span<const std::byte> data) {
            sizes[binding] = data.size();
        });
        placeTogether(sizes);
    }
    visitArrays(scene, others, [&](uint32_t binding, const char* name, std::span<const std::byte> data) {
        if (data.empty()) return;
        if (access == gpu::Access::TexelBuffer)
            buffers_[binding] = gpu::Buffer(device, name, data.size() + overrunOf(binding, traversal.packets),
                                            access, gpu::MemoryKind::Device);
        write(binding, data);
    });
}

void SceneBuffers::update(const PackedScene& scene) {
    if (!packetSlots_.empty()) {
        if (packetCorners_.empty()) {
            packetCorners_.resize(2 * packetSlots_.size());
            gpu::download(*device_, buffers_[packetCornersBinding],
                          std::as_writable_bytes(std::span(packetCorners_)));
        }
        refitPacketTree(scene.nodes, packetSlots_, packetCorners_, device_->context());
    }
    const auto rewrite = [&](uint32_t binding, const auto& array) {
        if (!array.empty()) write(binding, std::as_bytes(std::span(array)));
    };
    rewrite(trianglesBinding, scene.triangles);
    rewrite(triangleSurfacesBinding, scene.triangleSurfaces);
    rewrite(nodesBinding, scene.nodes);
    rewrite(packetCornersBinding, packetCorners_);
    rewrite(vertexNormalsBinding, scene.vertexNormals);
    rewrite(planesBinding, scene.planes);
    rewrite(instancesBinding, scene.instances);
    rewrite(lightsBinding, scene.lights);
    write(environmentBinding, gpu::bytesOf(scene.environment));
}

void SceneBuffers::placeTogether(const std::array<uint64_t, GLINT_BINDING_COUNT>& sizes) {
    uint64_t bytes = kHeadBytes;
    for (uint32_t binding = 0; binding < GLINT_BINDING_COUNT; ++binding) {
        first_[binding] = static_cast<uint32_t>(bytes / kTexelBytes);
        bytes += sizes[binding];
    }
    // Zeros last, so that the overrun of any array is in the buffer.
    for (uint32_t binding = 0; binding < GLINT_BINDING_COUNT; ++binding)
        if (sizes[binding] == 0) first_[binding] = static_cast<uint32_t>(bytes / kTexelBytes);
    static_assert(kZeroBytes >= std::max(kPacketOverrun, kAttributeOverrun));
    buffers_[kTogether] = gpu::Buffer(*device_, "all arrays together", bytes + kZeroBytes,
                                      gpu::Access::StorageBuffer, gpu::MemoryKind::Device);
    gpu::upload(*device_, buffers_[kTogether], std::as_bytes(std::span(first_)));
    gpu::upload(*device_, buffers_[kTogether], kZeros, bytes);
}

void SceneBuffers::write(uint32_t binding, std::span<const std::byte> data) const {
    const bool together = access_ == gpu::Access::StorageBuffer && binding != samplesBinding;
    gpu::upload(*device_, buffers_[together ? kTogether : binding], data,
                together ? first_[binding] * kTexelBytes : 0);
}

void SceneBuffers::setView(const shared::Camera& camera, const shared::Environment& environment,
                           std::span<const shared::Light> lights) const {
    write(cameraBinding, gpu::bytesOf(camera));
    write(environmentBinding, gpu::bytesOf(environment));
    if (!lights.empty()) write(lightsBinding, std::as_bytes(lights));
}

bool SceneBuffers::setSamples(std::span<const shared::Sample> rows) {
    if (rows.empty()) return false;
    gpu::Buffer& buffer = buffers_[samplesBinding];
    const bool grows = !buffer || buffer.size() < rows.size_bytes();
    if (grows) buffer = gpu::Buffer(*device_, "samples", rows.size_bytes(), access_, gpu::MemoryKind::Device);
    gpu::upload(*device_, buffer, std::as_bytes(rows));
    return grows;
}

const gpu::Buffer& SceneBuffers::at(uint32_t binding) const {
    const uint32_t place =
        access_ == gpu::Access::StorageBuffer && binding != kTogether ? samplesBinding : binding;
    return buffers_[place] ? buffers_[place] : zeros_;
}

uint64_t SceneBuffers::bytes() const {
    uint64_t sum = zeros_ ? zeros_.size() : 0;
    for (const gpu::Buffer& buffer : buffers_) sum += buffer ? buffer.size() : 0;
    return sum;
}

}  // namespace glint::render
