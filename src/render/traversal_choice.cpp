#include "render/traversal_choice.h"

#include "core/error.h"
#include "shared/layout.h"

namespace glint::render {

TraversalChoice chooseTraversal(Traversal wanted, const gpu::DeviceInfo& device,
                                const SceneFeatures& features) {
    if (wanted == Traversal::Lane) return {false, "as asked for"};
    const bool able = device.limits.subgroupSize == shared::kPacketWidth && device.limits.subgroupShuffle;
    if (wanted == Traversal::Packet && !able) {
        throw Error(ExitCode::Device,
                    "packets of rays need subgroups of " + std::to_string(shared::kPacketWidth) +
                        " lanes that can shuffle; \"" + device.name + "\" has " +
                        std::to_string(device.limits.subgroupSize) + " lanes: use --traversal auto or lane");
    }
    if (!able) return {false, "the device has no subgroups of 8 lanes that can shuffle"};
    if (features.discs || features.polygons)
        return {false, "the scene has primitives that packets do not know"};
    if (!features.triangles && !features.spheres) return {false, "the scene has no tree"};
    if (wanted == Traversal::Packet) return {true, "as asked for"};
    if (!device.llvmpipe) return {false, "packets pay on llvmpipe alone"};
    return {true, "llvmpipe, subgroups of 8 lanes"};
}

}  // namespace glint::render
