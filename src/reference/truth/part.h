// Contents of one BVH on the way into the model; internal to truth.
#pragma once

#include "reference/model.h"
#include "reference/truth/tree.h"
#include "scene/scene.h"

namespace glint::reference::truth {

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

// Identity of a primitive.
struct Identity {
    uint32_t id = 0, object = 0, face = 0, material = 0;
};

template <class Row>
void identify(const Identity& who, Row& row) {
    row.id = who.id;
    row.object = who.object;
    row.primitive = who.face;
    row.material = who.material;
}

// The world's primitives, or a prototype's, in the order of the scene.
struct Part {
    Model model;  // the arrays of primitives and what belongs to them
    std::vector<Item> items;

    // Counts from `origin`.
    void addSphere(const SphereShape& sphere, const glm::dvec3& origin, const glm::dvec3& eye,
                   const Identity& who);
    void addPlane(const PlaneShape& plane, const glm::dvec3& origin, const Identity& who);
    void addDisc(const DiscShape& disc, const glm::dvec3& origin, const Identity& who);
    void addPolygon(const PolygonShape& polygon, const glm::dvec3& origin, const Identity& who);
    void addBox(const BoxShape& box, const Place* place, const glm::dvec3& origin, const Identity& who);
    // Adds any shape that is a quadric.
    void addQuadric(const Shape& shape, const Place& place, const glm::dvec3& origin, const glm::dvec3& eye,
                    const Identity& who);
    void addTriangle(const glm::dvec3 (&vertices)[3], const glm::dvec3& origin, const Identity& who);
    // The triangle added last: what the mesh knows of it.
    void addAttributes(const Mesh& mesh, uint32_t face);
    void addMesh(const Mesh& mesh, const glm::dvec3& origin, const Identity& first);

    // gain: of rounding, in the primitive's own coordinates.
    void addItem(shared::PrimitiveKind kind, size_t index, Bounds box, double gain = 1);
};

// Brings the part's primitives into the order of leaves behind those of the model. The tree's root, kNone of
// nothing.
uint32_t append(Part&& part, const Context& context, std::vector<rows::Node>& nodes, Model& model);

// A unit vector, of any length but 0.
glm::dvec3 unit(const glm::dvec3& v);

}  // namespace glint::reference::truth
