// The arrays that the reference traces: those of shaders/shared/layout.h, in double. Widened from the rounded
// ones of the device, or made from the scene as it was read, with nothing rounded (truth/truth.h).
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "core/device_layout.h"

namespace glint {
struct PackedScene;  // truth/ includes this header and must not see pack/packed_scene.h
}

namespace glint::reference {

// Each row list of the layout once more, with dvec3 for vec3 and double for float.
namespace rows {
#define GLINT_ROW_V3F(A, a, b) \
    glm::dvec3 a{0};           \
    double b = 0;
#define GLINT_ROW_V3U(A, a, b) \
    glm::dvec3 a{0};           \
    uint32_t b = 0;
#define GLINT_ROW_U4(A, a, b, c, d) uint32_t a = 0, b = 0, c = 0, d = 0;
#define GLINT_WIDEN_V3(A, a, b) \
    a = glm::dvec3(from.a);     \
    b = decltype(b)(from.b);
#define GLINT_WIDEN_U4(A, a, b, c, d) \
    a = from.a;                       \
    b = from.b;                       \
    c = from.c;                       \
    d = from.d;
#define GLINT_NUMBERS_V3F(A, a, b) \
    change(a);                     \
    change(b);
#define GLINT_NUMBERS_V3U(A, a, b) change(a);
#define GLINT_NUMBERS_U4(A, a, b, c, d)
#define GLINT_ROW_STRUCT(binding, array, Name, ROWS)                                               \
    struct Name {                                                                                  \
        ROWS(GLINT_ROW_V3F, GLINT_ROW_V3U, GLINT_ROW_U4, 0)                                        \
        Name() = default;                                                                          \
        /* Exact: each float is a double. */                                                       \
        Name(const shared::Name& from) { ROWS(GLINT_WIDEN_V3, GLINT_WIDEN_V3, GLINT_WIDEN_U4, 0) } \
        /* change(double&) or change(dvec3&) for each of its numbers that packing rounds. */       \
        template <class Change>                                                                    \
        void changeNumbers([[maybe_unused]] const Change& change) {                                \
            ROWS(GLINT_NUMBERS_V3F, GLINT_NUMBERS_V3U, GLINT_NUMBERS_U4, 0)                        \
        }                                                                                          \
        bool operator==(const Name&) const = default;                                              \
    };
GLINT_SCENE_ARRAYS(GLINT_ROW_STRUCT)
#undef GLINT_ROW_STRUCT
#undef GLINT_ROW_V3F
#undef GLINT_ROW_V3U
#undef GLINT_ROW_U4
#undef GLINT_WIDEN_V3
#undef GLINT_WIDEN_U4
#undef GLINT_NUMBERS_V3F
#undef GLINT_NUMBERS_V3U
#undef GLINT_NUMBERS_U4
}  // namespace rows

// The map of a solid, a quadric or box, into its own coordinates, and the rows of its matrix.
template <class Solid>
glm::dmat3 rowsOf(const Solid& solid) {
    return {solid.toLocal0, solid.toLocal1, solid.toLocal2};
}
template <class Solid>
glm::dmat3 toLocal(const Solid& solid) {
    return glm::transpose(rowsOf(solid));
}

// Levels below a tree's root at most, of the world's and of each prototype's.
inline constexpr size_t kMaxTreeDepth = 63;

struct Model {
    glm::dvec3 origin{0};  // world = origin + local; every position below is local
    std::shared_ptr<const std::vector<rows::Node>> nodes = std::make_shared<const std::vector<rows::Node>>();
// triangles, spheres, ...: of each kind those that are in leaves in leaf order
#define GLINT_MODEL_ARRAY(number, Kind, KINDS, kinds, one, many) std::vector<rows::Kind> kinds;
    GLINT_PRIMITIVES(GLINT_MODEL_ARRAY, GLINT_MODEL_ARRAY)
#undef GLINT_MODEL_ARRAY
    std::vector<rows::TriangleSurface> triangleSurfaces;  // parallel to triangles
    std::vector<rows::VertexNormals> vertexNormals;
    std::vector<rows::PolygonVertex> polygonVertices;
    std::vector<rows::Material> materials;
    std::vector<rows::Optics> optics;
    std::vector<rows::Light> lights;
    std::vector<rows::Texture> textures;
    std::vector<rows::VertexAttribute> vertexAttributes;
    std::vector<rows::ObjectFrame> objectFrames;  // of every object, or none
    rows::Environment environment;
    // Images are floats as they are read, and stay so.
    std::shared_ptr<const std::vector<shared::Texel>> texels =
        std::make_shared<const std::vector<shared::Texel>>();
    bool alphaMask = false;               // some material's image cuts holes
    bool coloredShadows = false;          // light passes through what transmits
    double instanceGain = 0;              // see PackedScene
    glm::dvec3 boundsLo{0}, boundsHi{0};  // of everything in the tree
};

// The device's rounded numbers, unchanged. The texels are not copied: the scene must outlive the model.
Model widened(const PackedScene& scene);

// A model that rounding to fp32 could have produced: each number is moved by up to `units` * 2^-24 of itself,
// at random by its value and `seed`. Equal numbers stay equal, meshes stay closed, zero stays zero; texels
// and counts stay. The BVH is the same: its boxes have room for kDisturbanceRoom units.
Model disturbed(const Model& model, uint64_t seed, double units);
rows::Camera disturbed(const rows::Camera& camera, uint64_t seed, double units);
inline constexpr double kDisturbanceRoom = 32;

}  // namespace glint::reference
