// The backends, and the intersection tests of triangles and spheres: the robust ones and those of textbooks
// (docs/guide/numbers-to-trust.md).
#pragma once

#include <cstdint>

#include "core/enum_names.h"

namespace glint {

enum class Backend {
    Gpu,  // the shaders, on a Vulkan device
    Cpu   // the reference in double precision, on the host
};
constexpr auto entriesOf(Backend) {
    return std::to_array<EnumEntry<Backend>>({{Backend::Gpu, "gpu"}, {Backend::Cpu, "cpu"}});
}

// The values are those of INTERSECTOR and SPHERE_FORM in shaders/shared/dispatch.h.
enum class TriangleMethod : uint32_t { Watertight, Barycentric, Projection, Planar3d };
constexpr auto entriesOf(TriangleMethod) {
    return std::to_array<EnumEntry<TriangleMethod>>({{TriangleMethod::Watertight, "watertight"},
                                                     {TriangleMethod::Barycentric, "barycentric"},
                                                     {TriangleMethod::Projection, "projection"},
                                                     {TriangleMethod::Planar3d, "planar3d"}});
}

enum class SphereMethod : uint32_t { Robust, Algebraic, Geometric };
constexpr auto entriesOf(SphereMethod) {
    return std::to_array<EnumEntry<SphereMethod>>({{SphereMethod::Robust, "robust"},
                                                   {SphereMethod::Algebraic, "algebraic"},
                                                   {SphereMethod::Geometric, "geometric"}});
}

// By how much the far planes of boxes are moved away: 1 + 2 (gamma_7 + 11 u) (kFarPad in
// shaders/traversal/ray.glsl), 1 + 2 gamma_3, not at all; and how far
// from a surface rays start that leave it: by the error box of the point, by 1e-4, not at all. Of the device
// alone, and for `glint report` alone, which shows what the defaults are worth (docs/lab/accuracy.md).
enum class SlabPad : uint32_t { Gamma7, Gamma3, None };
constexpr auto entriesOf(SlabPad) {
    return std::to_array<EnumEntry<SlabPad>>(
        {{SlabPad::Gamma7, "gamma7"}, {SlabPad::Gamma3, "gamma3"}, {SlabPad::None, "none"}});
}

enum class OriginOffset : uint32_t { ErrorBox, Fixed, None };
constexpr auto entriesOf(OriginOffset) {
    return std::to_array<EnumEntry<OriginOffset>>(
        {{OriginOffset::ErrorBox, "errorBox"}, {OriginOffset::Fixed, "fixed"}, {OriginOffset::None, "none"}});
}

struct Methods {
    TriangleMethod triangles = TriangleMethod::Watertight;
    SphereMethod spheres = SphereMethod::Robust;
    SlabPad slabs = SlabPad::Gamma7;
    OriginOffset offsets = OriginOffset::ErrorBox;
    auto operator<=>(const Methods&) const = default;
};

}  // namespace glint
