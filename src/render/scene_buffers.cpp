#include "render/scene_buffers.h"

#include <algorithm>
#include <string>
#include <type_traits>

namespace glint::render {

namespace {

constexpr uint32_t kLightsBinding = 9;
constexpr uint32_t kEnvironmentBinding = 10;
constexpr uint32_t kCameraBinding = 11;

// Calls visit(binding, name, bytes) for each array of the scene; the camera comes later, by setCamera.
template <typename Visit>
void visitArrays(const PackedScene& scene, const std::vector<shared::PacketCorner>& packetCorners,
                 const Visit& visit) {
    const shared::Camera camera;
    const auto bytesOf = [](const auto& array) {
        using Array = std::remove_cvref_t<decltype(array)>;
        if constexpr (requires { array.data(); }) {
            return std::as_bytes(std::span(array.data(), array.size()));
        } else {
            return std::as_bytes(std::span<const Array, 1>(&array, 1));
        }
    };
    const struct {
#define GLINT_FIELD(BINDING, field, Struct) std::span<const std::byte> field;
        GLINT_SCENE_ARRAYS(GLINT_FIELD)
#undef GLINT_FIELD
    } arrays = {bytesOf(scene.nodes),
                bytesOf(scene.triangles),
                bytesOf(scene.triangleSurfaces),
                bytesOf(scene.vertexNormals),
                bytesOf(scene.spheres),
                bytesOf(scene.planes),
                bytesOf(scene.materials),
                bytesOf(scene.lights),
                bytesOf(scene.environment),
                bytesOf(camera),
                bytesOf(scene.discs),
                bytesOf(scene.polygons),
                bytesOf(scene.polygonVertices),
                bytesOf(packetCorners)};
#define GLINT_VISIT(BINDING, field, Struct) visit(BINDING, #field, arrays.field);
    GLINT_SCENE_ARRAYS(GLINT_VISIT)
#undef GLINT_VISIT
}

}  // namespace

uint64_t largestArray(const PackedScene& scene) {
    uint64_t largest = 0;
    visitArrays(scene, {}, [&](uint32_t, const char*, std::span<const std::byte> data) {
        largest = std::max<uint64_t>(largest, data.size());
    });
    return largest;
}

SceneBuffers::SceneBuffers(const gpu::Device& device, const PackedScene& scene, gpu::Access access,
                           const std::vector<shared::PacketCorner>& packetCorners) {
    visitArrays(
        scene, packetCorners, [&](uint32_t binding, const char* name, std::span<const std::byte> data) {
            if (data.empty()) return;
            buffers_[binding] = gpu::Buffer(device, name, data.size(), access, gpu::MemoryKind::Device);
            gpu::upload(device, buffers_[binding], data);
        });
}

void SceneBuffers::setCamera(const gpu::Device& device, const shared::Camera& camera) const {
    gpu::upload(device, buffers_[kCameraBinding],
                std::as_bytes(std::span<const shared::Camera, 1>(&camera, 1)));
}

void SceneBuffers::setEnvironment(const gpu::Device& device, const shared::Environment& environment) const {
    gpu::upload(device, buffers_[kEnvironmentBinding],
                std::as_bytes(std::span<const shared::Environment, 1>(&environment, 1)));
}

void SceneBuffers::setLights(const gpu::Device& device, const std::vector<shared::Light>& lights) const {
    if (!lights.empty()) gpu::upload(device, buffers_[kLightsBinding], std::as_bytes(std::span(lights)));
}

const gpu::Buffer& SceneBuffers::at(uint32_t binding) const {
    return buffers_[binding] ? buffers_[binding] : buffers_[kEnvironmentBinding];
}

uint64_t SceneBuffers::bytes() const {
    uint64_t sum = 0;
    for (const gpu::Buffer& buffer : buffers_) sum += buffer ? buffer.size() : 0;
    return sum;
}

}  // namespace glint::render
