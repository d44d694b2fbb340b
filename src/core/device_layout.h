// The lists, structs and constants of shaders/shared in C++, and limits that only the host checks.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace glint::shared {

// The shared headers have only macros and constants, which this namespace declares.
#define GLINT_CONST_UINT(name, value) inline constexpr uint32_t name = value
#define GLINT_CONST_FLOAT(name, value) inline constexpr float name = value
#include "shared/dispatch.h"

#define GLINT_CPP_V3F(A, a, b) \
    glm::vec3 a{0};            \
    float b = 0;
#define GLINT_CPP_V3U(A, a, b) \
    glm::vec3 a{0};            \
    uint32_t b = 0;
#define GLINT_CPP_U4(A, a, b, c, d) uint32_t a = 0, b = 0, c = 0, d = 0;
#define GLINT_CPP_STRUCT(binding, array, Name, ROWS)        \
    struct alignas(16) Name {                               \
        ROWS(GLINT_CPP_V3F, GLINT_CPP_V3U, GLINT_CPP_U4, 0) \
    };                                                      \
    static_assert(sizeof(Name) % 16 == 0 && alignof(Name) == 16);
GLINT_SCENE_ARRAYS(GLINT_CPP_STRUCT)
GLINT_CPP_STRUCT(0, dispatch, Dispatch, GLINT_DISPATCH_ROWS)
#undef GLINT_CPP_STRUCT
static_assert(sizeof(Dispatch) <= 128, "Vulkan guarantees 128 bytes of push constants");

// The numbers kKind... for `switch`. A `switch` over kinds has no `default`, so that -Wswitch checks it.
#define GLINT_KIND_NAME(number, Kind, KINDS, kinds, one, many) Kind = number,
enum class PrimitiveKind : uint8_t { GLINT_PRIMITIVES(GLINT_KIND_NAME, GLINT_KIND_NAME) };
#undef GLINT_KIND_NAME
#define GLINT_KIND_ONE(number, Kind, KINDS, kinds, one, many) +1u
inline constexpr uint32_t kKindCount = 0u GLINT_PRIMITIVES(GLINT_KIND_ONE, GLINT_KIND_ONE);
#undef GLINT_KIND_ONE
// No leaf holds planes, so as the last kind their number need not fit.
static_assert(kKindCount <= kLeafKindMask + 1 + (kKindPlane > kLeafKindMask),
              "a leaf has three bits for its kind");

inline constexpr uint32_t kMaxLeafSize = kLeafCountMask + 1;
inline constexpr uint32_t kPacketWidth = 8;  // children of a node of the packets' BVH; lanes of a subgroup
// A line hits a quadric's side at most twice, and each cap once.
inline constexpr uint32_t kQuadricHits = 4;
inline constexpr uint32_t kRankOfZero = 0x80000000u;  // Optics::rank of priority 0
// Each ray tests all planes: far fewer than the 65,535 trips after which lavapipe ends every loop.
inline constexpr uint32_t kMaxPlanes = 1024;
// Trips around a polygon: with a leaf of 2^11 trips and 16 lanes, lavapipe's 65,535 leave a ray some 700
// trips before it must be resumed (path_limits.cpp).
inline constexpr uint32_t kMaxPolygonTrips = 2048;

}  // namespace glint::shared
