// How rays are tried against triangles and spheres: the textbooks' ways, and the ones that hold
// (docs/reference/command-line.md).
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <string_view>

namespace glint {

// The values are those of INTERSECTOR and SPHERE_FORM in shaders/shared/dispatch.h.
enum class TriangleMethod : uint32_t { Watertight, Barycentric, Projection, Planar3d };
enum class SphereMethod : uint32_t { Robust, Algebraic, Geometric };
// By how much the far planes of boxes are moved away: 1 + 2 (gamma_7 + 11 u) (kFarPad in
// shaders/intersect.glsl), 1 + 2 gamma_3, not at all; and how far
// from a surface rays start that leave it: by the error box of the point, by 1e-4, not at all. Of the device
// alone, and for `glint report` alone, which shows what the defaults are worth (docs/lab/accuracy.md).
enum class SlabPad : uint32_t { Gamma7, Gamma3, None };
enum class OriginOffset : uint32_t { ErrorBox, Fixed, None };

inline constexpr std::array<std::string_view, 4> kTriangleMethodNames{"watertight", "barycentric",
                                                                      "projection", "planar3d"};
inline constexpr std::array<std::string_view, 3> kSphereMethodNames{"robust", "algebraic", "geometric"};

struct Methods {
    TriangleMethod triangles = TriangleMethod::Watertight;
    SphereMethod spheres = SphereMethod::Robust;
    SlabPad slabs = SlabPad::Gamma7;
    OriginOffset offsets = OriginOffset::ErrorBox;
    auto operator<=>(const Methods&) const = default;
};

inline std::string_view nameOf(TriangleMethod method) {
    return kTriangleMethodNames[static_cast<size_t>(method)];
}
inline std::string_view nameOf(SphereMethod method) {
    return kSphereMethodNames[static_cast<size_t>(method)];
}

}  // namespace glint
