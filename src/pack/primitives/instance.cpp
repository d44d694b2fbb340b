#include "pack/primitives.h"

namespace glint {
namespace {

// Any object whose shape cannot absorb its transform (kindOf). Class Instances places them.
class InstancePacker final : public KindPacker {
  public:
    bool packs(const Shape&) const override { return false; }
    void extend(const Object&, uint32_t, uint32_t, Extent&) const override {}
    Box box(const Object&, uint32_t, const Frame&) const override { return {}; }
    void write(const Packing& packing, Primitives::Source source, uint32_t slot,
               FurtherRows&) const override {
        shared::Instance& instance = packing.packed.instances[slot];
        instance = packing.frame.instances->of(source.object).row;
        if (instance.material != shared::kNone) return packing.materials.use(instance.material);
        for (const uint32_t material : std::get<MeshShape>(packing.objectOf(source).shape).mesh->materials)
            packing.materials.use(material);
    }
};

}  // namespace

const KindPacker& packerOfInstance() {
    static const InstancePacker packer;
    return packer;
}

}  // namespace glint
