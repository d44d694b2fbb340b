#include "render/traversal_choice.h"

#include <algorithm>
#include <iterator>
#include <string_view>

#include "core/error.h"
#include "pack/scene_arrays.h"
#include "render/path_limits.h"
#include "shared/dispatch.h"

namespace glint::render {

namespace {

// Of the features that are no kinds of primitives, those that packets know or need not know. Any other, also
// one that comes to the list later, is traced by lanes.
constexpr std::string_view kKnown[] = {
    "anchoredSpheres", "vertexNormals", "pointLights",    "directionalLights", "spotLights",
    "specular",        "mirrors",       "parallelCamera", "splitTriangles",    "environmentMap",
    "thinLens",        "slivers",       "openPlanes",     "texturedGlass"};

// Whether packets know a kind, by its role (shaders/shared/primitives.h).
namespace packets {
constexpr bool TRIANGLES = true, PACKETS = true, UNBOUNDED = true, LEAVES = false, INSTANCES = false;
}

bool isKnown(std::string_view feature) {
#define GLINT_KNOWN(A, ROLE, number, Kind, kinds, binding, ROWS, FEATURE, ID, one, many, crossings, loops, \
                    uv)                                                                                    \
    if (feature == #kinds) return packets::ROLE;
    GLINT_PRIMITIVES(GLINT_KNOWN, 0)
#undef GLINT_KNOWN
    return std::find(std::begin(kKnown), std::end(kKnown), feature) != std::end(kKnown);
}

// Primitives in the leaves that packets come to; `features` tells of kinds that are none of these.
size_t primitivesOfPackets(const PackedScene& scene) {
    size_t sum = 0;
#define GLINT_SUM(A, ROLE, number, Kind, kinds, binding, ROWS, FEATURE, ID, one, many, crossings, loops, uv) \
    if (packets::ROLE && loops > 0) sum += scene.kinds.size();
    GLINT_PRIMITIVES(GLINT_SUM, 0)
#undef GLINT_SUM
    return sum;
}

bool anyForPackets(const SceneFeatures& features) {
#define GLINT_ANY(A, ROLE, number, Kind, kinds, binding, ROWS, FEATURE, ID, one, many, crossings, loops, uv) \
    || (packets::ROLE && loops > 0 && features.kinds)
    return false GLINT_PRIMITIVES(GLINT_ANY, 0);
#undef GLINT_ANY
}

std::string unknownToPackets(const SceneFeatures& features) {
    std::string unknown;
#define GLINT_CHECK(ID, NAME, field) \
    if (features.field && !isKnown(#field)) unknown += (unknown.empty() ? "" : ", ") + std::string(#field);
    GLINT_FEATURES(GLINT_CHECK)
#undef GLINT_CHECK
    return unknown;
}

bool isGpu(const gpu::DeviceInfo& device) {
    return device.type == "discrete GPU" || device.type == "integrated GPU" || device.type == "virtual GPU";
}

// Of the tree, instances as one each.
size_t primitivesIn(const PackedScene& scene) {
    size_t sum = 0;
    visitPrimitiveArrays(scene, [&](shared::PrimitiveKind kind, const auto& array) {
        sum += kind == shared::PrimitiveKind::Plane ? 0 : array.size();
    });
    return sum;
}

TraversalChoice chooseWide(Traversal wanted, const PackedScene& scene, const Methods& methods) {
    if (scene.nodes.empty()) return {false, "the scene has no tree"};
    if (wanted == Traversal::Bvh4 && scene.nodes.size() > kMostFourNodes)
        return {false, "more nodes than a word of the stack can number"};
    if (methods.slabs != SlabPad::Gamma7)
        return {false, "wide nodes know no other padding of boxes than the default one"};
    if (wanted == Traversal::Bvh4) return {false, "as asked for", NodeFormat::Four};
    if (wanted == Traversal::Cwbvh) return {false, "as asked for", NodeFormat::Compressed};
    if (primitivesIn(scene) < kFewestForWide) return {false, "so few primitives that wide nodes do not pay"};
    return {false, "a GPU: fewest steps and bytes a ray, by counts", NodeFormat::Compressed};
}

// Not where a walk's order is in a picture's last bits, which are to be those of other devices
// (docs/design/reproducibility.md).
bool picturesMayTakeFour(const PackedScene& scene, const Methods& methods) {
    return methods.slabs == SlabPad::Gamma7 && !scene.features.coloredShadows;
}

bool suitsFour(const PackedScene& scene) {
    return scene.nodes.size() >= kFewestForFour && scene.nodes.size() <= kMostFourNodes;
}

bool fourPaysForPictures(const PackedScene& scene, uint64_t rays) {
    return suitsFour(scene) && rays >= kFewestOfPictureForFour &&
           rays >= kPictureRaysOfPrimitiveForFour * primitivesIn(scene);
}

TraversalChoice chooseOnProcessor(Traversal wanted, const gpu::DeviceInfo& device, const PackedScene& scene,
                                  const Methods& methods) {
    const bool able = runsPackets(device);
    if (wanted == Traversal::Packet && !able) {
        throw Error(ErrorKind::Device, "packets of rays need subgroups of " +
                                           std::to_string(shared::kPacketWidth) +
                                           " lanes that can shuffle; \"" + device.name + "\" has " +
                                           std::to_string(device.limits.subgroupSize) +
                                           " lanes: choose the traversal auto or lane");
    }
    if (!able) return {false, "the device has no subgroups of 8 lanes that can shuffle"};
    if (const std::string name = unknownToPackets(scene.features); !name.empty())
        return {false, "packets do not know " + name};
    if (methods != Methods{}) return {false, "packets know no other tests than the default ones"};
    if (!anyForPackets(scene.features)) return {false, "the scene has no tree"};
    if (scene.nodes.size() > kMostPacketNodes) return {false, "more nodes than packets can number"};
    if (wanted == Traversal::Packet) return {true, "as asked for"};
    if (!device.llvmpipe) return {false, "packets pay on llvmpipe alone"};
    if (primitivesOfPackets(scene) < kFewestForPackets)
        return {false, "so few primitives that packets do not pay"};
    return {true, "llvmpipe, subgroups of 8 lanes"};
}

}  // namespace

bool fourPays(const PackedScene& scene, uint64_t raysOfKernels, uint64_t raysOfTree) {
    return suitsFour(scene) && raysOfKernels >= kFewestRaysForFour &&
           raysOfTree >= kRaysOfPrimitiveForFour * primitivesIn(scene);
}

bool leavesWait(const SceneFeatures& features) {
    bool others = features.alphaMask || features.instances;
#define GLINT_OTHER(A, ROLE, number, Kind, kinds, binding, ROWS, FEATURE, ID, one, many, crossings, loops, \
                    uv)                                                                                    \
    others = others || (loops > 0 && shared::PrimitiveKind::Kind != shared::PrimitiveKind::Triangle &&     \
                        features.kinds);
    GLINT_PRIMITIVES(GLINT_OTHER, 0)
#undef GLINT_OTHER
    return !others;
}

bool runsPackets(const gpu::DeviceInfo& device) {
    return device.limits.subgroupSize == shared::kPacketWidth && device.limits.subgroupShuffle;
}

bool walksConverge(const gpu::DeviceInfo& device, NodeFormat nodes, StackPlace stack) {
    return device.llvmpipe && runsPackets(device) && nodes != NodeFormat::Compressed &&
           stack == StackPlace::Private;
}

std::string_view nameOf(const TraversalChoice& choice) {
    if (choice.packets) return glint::nameOf(Traversal::Packet);
    switch (choice.nodes) {
        case NodeFormat::Two:
            return glint::nameOf(Traversal::Lane);
        case NodeFormat::Four:
            return glint::nameOf(Traversal::Bvh4);
        case NodeFormat::Compressed:
            return glint::nameOf(Traversal::Cwbvh);
    }
    return "";
}

TraversalChoice chooseTraversal(Traversal wanted, const gpu::DeviceInfo& device, const PackedScene& scene,
                                const Methods& methods, uint64_t rays) {
    if (wanted == Traversal::Lane) return {false, "as asked for"};
    if (wanted == Traversal::Bvh4 || wanted == Traversal::Cwbvh ||
        (wanted == Traversal::Auto && isGpu(device)))
        return chooseWide(wanted, scene, methods);
    TraversalChoice choice = chooseOnProcessor(wanted, device, scene, methods);
    const bool byThemselves = !choice.packets || goesOnAfterHits(scene.features);
    if (wanted == Traversal::Auto && device.llvmpipe && byThemselves && picturesMayTakeFour(scene, methods) &&
        fourPaysForPictures(scene, rays)) {
        choice.nodes = NodeFormat::Four;
        choice.reason += "; so many rays that a tree of four children a node pays";
    }
    return choice;
}

}  // namespace glint::render
