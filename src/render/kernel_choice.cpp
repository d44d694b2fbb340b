#include "render/kernel_choice.h"

#include <algorithm>
#include <iterator>
#include <string_view>

#include "core/device_layout.h"
#include "core/error.h"
#include "pack/request_environment.h"
#include "render/path_limits.h"

namespace glint::render {

namespace {

// Features that packets support or can ignore. Scenes with any other feature are traced one ray per lane.
constexpr std::string_view kSupported[] = {
    "triangles",      "spheres",           "planes",     "cuboids",  "anchoredSpheres", "vertexNormals",
    "pointLights",    "directionalLights", "spotLights", "specular", "mirrors",         "parallelCamera",
    "splitTriangles", "environmentMap",    "thinLens",   "slivers",  "openPlanes",      "texturedGlass"};

std::string unsupportedByPackets(const SceneFeatures& features) {
    std::string names;
#define GLINT_CHECK(ID, NAME, field)                                                     \
    if (features.field && std::ranges::find(kSupported, #field) == std::end(kSupported)) \
        names += (names.empty() ? "" : ", ") + std::string(#field);
    GLINT_FEATURES(GLINT_CHECK)
#undef GLINT_CHECK
    return names;
}

// A trip tests two boxes. In each scene of scenes/, 99 % of the pixels test at most 2,100 boxes and
// primitives (layer `cost`, 96x72; glass.json the most). If a path runs out, other kernels render the image.
constexpr uint32_t kMinTrips = 1500;
// Rays from which packets repay their longer start: measured between 0.7 million (scenes/arcade.json) and
// two.
constexpr uint64_t kManyRays = 1'000'000;

}  // namespace

size_t primitivesOfPackets(const PackedScene& scene) {
    return scene.triangles.size() + scene.spheres.size() + scene.cuboids.size();
}

bool runsPackets(const gpu::DeviceInfo& device) {
    return device.limits.subgroupSize == shared::kPacketWidth && device.limits.subgroupShuffle;
}

bool loopsConverge(const gpu::DeviceInfo& device) {
    return device.llvmpipe && runsPackets(device);
}

std::string_view nameOf(const TraversalChoice& choice) {
    return glint::nameOf(choice.packets ? Traversal::Packet : Traversal::Lane);
}

TraversalChoice chooseTraversal(Traversal wanted, const gpu::DeviceInfo& device, const PackedScene& scene,
                                const Methods& methods) {
    if (wanted == Traversal::Lane) return {false, "as asked for"};
    const bool able = runsPackets(device);
    if (wanted == Traversal::Packet && !able) {
        throw Error(ErrorKind::Device, "packets of rays need subgroups of " +
                                           std::to_string(shared::kPacketWidth) +
                                           " lanes that can shuffle; \"" + device.name + "\" has " +
                                           std::to_string(device.limits.subgroupSize) +
                                           " lanes: choose the traversal auto or lane");
    }
    if (!able) return {false, "the device has no subgroups of 8 lanes that can shuffle"};
    if (const std::string name = unsupportedByPackets(scene.features); !name.empty())
        return {false, "packets do not support " + name};
    if (methods != Methods{}) return {false, "packets support only the default intersection tests"};
    if (primitivesOfPackets(scene) == 0) return {false, "the scene has no BVH"};
    if (wanted == Traversal::Packet) return {true, "as asked for"};
    if (!device.llvmpipe) return {false, "packets are faster only on llvmpipe"};
    if (primitivesOfPackets(scene) < kMinForPackets) return {false, "too few primitives for packets"};
    return {true, "llvmpipe, subgroups of 8 lanes"};
}

bool wholePathsSupport(const TraceModes& modes) {
    const bool robust = modes.methods.triangles == TriangleMethod::Watertight &&
                        modes.methods.spheres == SphereMethod::Robust;
    return robust && !modes.aovs && !modes.cost && !modes.tally;
}

bool wholePathsPay(const gpu::DeviceInfo& device, const TraversalChoice& choice, const WholePathsWork& work) {
    if (!device.llvmpipe || work.tripBudget < kMinTrips) return false;
    const bool many = work.rays == 0 || work.rays >= kManyRays;
    return !(choice.packets && !work.furtherRays && many);
}

std::vector<KernelId> kernelsOfSteps(const PackedScene& scene, const Request& request, bool packets) {
    std::vector<KernelId> kernels = {KernelId::Generate, KernelId::Shade};
    // Packets trace camera rays alone. The scene decides whether there are others, not the features of the
    // kernels: unused kernels for later bounces would double a cold start.
    const bool goesOn = goesOnAfterHits(scene.features, environmentOf(scene, request));
    const bool hasLights = !lightsOf(scene, request).empty();
    for (const KernelId id : {KernelId::Intersect, KernelId::Light}) {
        if (id == KernelId::Light && !hasLights) continue;
        if (packets) kernels.push_back(packetKernel(id));
        if (!packets || goesOn) kernels.push_back(id);
    }
    return kernels;
}

}  // namespace glint::render
