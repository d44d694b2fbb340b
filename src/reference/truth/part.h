// Contents of one BVH on the way into the model; internal to truth.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "core/vectors.h"
#include "reference/model.h"
#include "scene/scene.h"

namespace glint::reference::truth {

struct Bounds : BoundingBox {
    using BoundingBox::include;
    void include(const Bounds& other) {
        lo = glm::min(lo, other.lo);
        hi = glm::max(hi, other.hi);
    }
    double halfArea() const {
        const glm::dvec3 size = hi - lo;
        return empty() ? 0 : size.x * size.y + size.y * size.z + size.z * size.x;
    }
    // The greatest coordinate of a point in it.
    double reach() const { return greatestMagnitude(glm::max(glm::abs(lo), glm::abs(hi))); }
    void grow(double margin) {
        lo -= margin;
        hi += margin;
    }
    // Corner i of 8.
    glm::dvec3 corner(int i) const { return {i & 1 ? hi.x : lo.x, i & 2 ? hi.y : lo.y, i & 4 ? hi.z : lo.z}; }
};

// The box of a solid, a quadric or box, in the coordinates of its point.
template <class Solid>
Bounds boxOf(const Solid& solid) {
    const glm::dmat3 back = glm::inverse(toLocal(solid));
    Bounds local, box;
    local.include(solid.lo);
    local.include(solid.hi);
    for (int i = 0; i < 8; ++i) box.include(solid.point + back * local.corner(i));
    return box;
}

// x -> linear x + offset, and how many times the way there and back makes of a rounding: the greatest row sum
// of |A| |A^-1|.
struct Place {
    glm::dmat3 linear{1}, inverse{1};
    glm::dvec3 offset{0};
    double gain = 1;

    Place() = default;
    explicit Place(const Affine& transform);
    glm::dvec3 operator()(const glm::dvec3& p) const { return linear * p + offset; }
};

// Entry of a BVH: number `index` of its kind.
struct Item {
    Bounds box;
    shared::PrimitiveKind kind{};
    uint32_t index = 0;
};

// Identity of a primitive.
struct Identity {
    uint32_t id = 0, object = 0, face = 0, material = 0;
};

// An anchor at most so many times as far from the eye as the truth's own point replaces that point. Hits err
// by units of 2^-24 of the distance, so a farther anchor is a defect of packing.
inline constexpr double kAnchorRoom = 2;

// A shape's place in its BVH, and the origin of its coordinates. eye: near it, surfaces are measured from
// other points. anchor: see truthOf. ranks: kDielectricRank or 0, by material; empty if an instance has the
// rank.
struct Setting {
    Identity who = {};
    Place place = {};
    bool moved = false;  // by `place`
    glm::dvec3 origin{0}, eye{0};
    std::optional<glm::dvec3> anchor = {};
    std::span<const uint32_t> ranks = {};

    uint32_t id() const { return who.id | (ranks.empty() ? 0 : ranks[who.material]); }
};

template <class Row>
void identify(const Setting& at, Row& row) {
    row.id = at.id();
    row.object = at.who.object;
    row.primitive = at.who.face;
    row.material = at.who.material;
}

// The world's primitives, or a prototype's, in the order of the scene.
struct Part {
    Model& whole;      // takes planes, and what primitives refer to
    Model model = {};  // the other primitives and their surfaces
    std::vector<Item> items = {};

    void add(const Shape& shape, const Setting& at);
    // add() for a shape that is a quadric.
    void addQuadric(const Shape& shape, const Setting& at);

    // Adds a primitive to its array and the BVH. gain: amplification of rounding, in the primitive's own
    // coordinates.
    template <class Row>
    void put(shared::PrimitiveKind kind, std::vector<Row>& array, Row row, const Setting& at,
             const Bounds& box, double gain) {
        identify(at, row);
        array.push_back(row);
        addItem(kind, array.size() - 1, box, gain);
    }
    void addItem(shared::PrimitiveKind kind, size_t index, Bounds box, double gain);
};

// Appends the part's BVH to `nodes`, and its primitives to the whole model in the order of leaves. Returns
// the root, or kNone if the part is empty.
uint32_t append(Part&& part, std::vector<rows::Node>& nodes);

// v / |v|, or NaN.
inline glm::dvec3 unit(const glm::dvec3& v) {
    return unitVector(v).value_or(glm::dvec3(std::numeric_limits<double>::quiet_NaN()));
}

// Materials, media, lights, background, textures and the coordinates of objects. `used`: by material, whether
// a surface has it.
void addShading(const Scene& scene, const std::vector<bool>& used, Model& model);

}  // namespace glint::reference::truth
