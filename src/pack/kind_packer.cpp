#include "pack/kind_packer.h"

#include <stdexcept>

#include "scene/placement.h"

namespace glint {

const KindPacker& packerOf(shared::PrimitiveKind kind) {
    switch (kind) {
#define GLINT_CASE(number, Kind, kinds, one, many) \
    case shared::PrimitiveKind::Kind:              \
        return packerOf##Kind();
        GLINT_PRIMITIVES(GLINT_CASE, GLINT_CASE)
#undef GLINT_CASE
    }
    throw std::logic_error("no such kind of primitive");
}

shared::PrimitiveKind kindOf(const Object& object) {
    if (object.transform && !takesTransform(object.shape)) return shared::PrimitiveKind::Instance;
    for (uint32_t kind = 0; kind < shared::kKindCount; ++kind)
        if (packerOf(static_cast<shared::PrimitiveKind>(kind)).packs(object.shape))
            return static_cast<shared::PrimitiveKind>(kind);
    throw std::logic_error("a shape that no kind of primitive packs");
}

}  // namespace glint
