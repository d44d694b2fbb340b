#include "core/vectors.h"
#include "pack/area_vector.h"
#include "pack/primitives.h"

namespace glint {

std::optional<Corners> roundTriangle(const std::array<glm::dvec3, 3>& world, const glm::dvec3& origin) {
    Corners corners{};
    for (size_t i = 0; i < 3; ++i) {
        const auto p = roundPoint(world[i] - origin);
        if (!p) return std::nullopt;
        corners[i] = *p;
    }
    return corners;
}

bool vertexNormals(const Mesh* mesh, uint32_t face, shared::VertexNormals& out) {
    if (mesh == nullptr || mesh->normalCorners.empty()) return false;
    const glm::uvec3 corners = mesh->normalCorners[face];
    glm::vec3* const normals[3] = {&out.n0, &out.n1, &out.n2};
    for (int i = 0; i < 3; ++i) {
        if (corners[i] == Mesh::kNoIndex) return false;
        const auto unit = unitVector(mesh->normals[corners[i]]);
        if (!unit) return false;
        *normals[i] = glm::vec3(*unit);
    }
    return true;
}

namespace {

uint32_t materialOf(const Object& object, uint32_t face) {
    const Mesh* mesh = TriangleSource(object).mesh();
    return mesh != nullptr && !mesh->materials.empty() ? mesh->materials[face] : object.material;
}

// The rows that a triangle of this material has in PackedScene::vertexAttributes, as shared::kAttribute...
// flags; 0: none. Coordinates are kept only where the material has a texture.
uint32_t attributeFlags(const Scene& scene, const Mesh* mesh, uint32_t face, uint32_t material) {
    if (mesh == nullptr) return 0;
    const glm::uvec3 none(Mesh::kNoIndex);
    const bool uvs =
        !mesh->uvCorners.empty() && mesh->uvCorners[face] != none && hasTexture(scene.materials[material]);
    const bool colors = !mesh->colorCorners.empty() && mesh->colorCorners[face] != none;
    return (uvs ? shared::kAttributeUvs : 0) | (colors ? shared::kAttributeColors : 0);
}

uint32_t attributeRows(uint32_t flags) {
    return ((flags & shared::kAttributeUvs) != 0 ? 2 : 0) + ((flags & shared::kAttributeColors) != 0 ? 3 : 0);
}

void writeAttributes(const Mesh& mesh, uint32_t face, uint32_t flags, shared::VertexAttribute* rows) {
    if (flags & shared::kAttributeUvs) {
        const glm::uvec3 corners = mesh.uvCorners[face];
        for (int i = 0; i < 3; ++i) {
            rows[0].value[i] = static_cast<float>(mesh.uvs[corners[i]].x);
            rows[1].value[i] = static_cast<float>(mesh.uvs[corners[i]].y);
        }
        rows += 2;
    }
    if (flags & shared::kAttributeColors) {
        for (int i = 0; i < 3; ++i) rows[i].value = glm::vec3(mesh.colors[mesh.colorCorners[face][i]]);
    }
}

class TrianglePacker final : public KindPacker {
  public:
    bool packs(const Shape& shape) const override {
        return std::holds_alternative<TriangleShape>(shape) || std::holds_alternative<MeshShape>(shape);
    }
    // No area means exactly collinear after rounding. A needle that fp32 can distinguish from a line has a
    // plane and a normal and is kept. A degenerate triangle has none, and watertight intersection tests would
    // hit some of them (M. Pharr, W. Jakob, G. Humphreys, "Physically Based Rendering", 4th ed., 6.5.3).
    PrimitiveStatus statusOf(const Object& object, uint32_t face, const Frame& frame) const override {
        const auto v = roundTriangle(TriangleSource(object).vertices(face), frame.origin);
        if (!v) return PrimitiveStatus::NotFinite;
        return areaVector((*v)[0], (*v)[1], (*v)[2]) == glm::dvec3(0) ? PrimitiveStatus::NoArea
                                                                      : PrimitiveStatus::Kept;
    }
    void extend(const Object& object, uint32_t begin, uint32_t end, Extent& extent) const override {
        const TriangleSource source(object);
        for (uint32_t face = begin; face < end; ++face)
            for (const glm::dvec3& vertex : source.vertices(face)) extent.include(vertex);
    }
    Box box(const Object& object, uint32_t face, const Frame& frame) const override {
        Box box;
        const Corners corners = roundTriangle(TriangleSource(object).vertices(face), frame.origin).value();
        for (const glm::vec3& p : corners) box.include(p);
        return withEdgeMargin(box);
    }
    void count(const Packing& packing, Primitives::Source source, FurtherRows& rows) const override {
        const Object& object = packing.objectOf(source);
        const Mesh* mesh = TriangleSource(object).mesh();
        shared::VertexNormals normals;
        rows.normals += vertexNormals(mesh, source.face, normals);
        rows.attributes +=
            attributeRows(attributeFlags(packing.scene, mesh, source.face, materialOf(object, source.face)));
    }
    void write(const Packing& packing, Primitives::Source source, uint32_t slot,
               FurtherRows& next) const override;
    void balls(const PackedScene& scene, uint32_t index, const VisitBall& visit) const override {
        const shared::Triangle& t = scene.triangles[index];
        for (const glm::vec3& v : {t.v0, t.v1, t.v2}) visit(v, 0);
    }
};

void TrianglePacker::write(const Packing& packing, Primitives::Source source, uint32_t slot,
                           FurtherRows& next) const {
    const Object& object = packing.objectOf(source);
    const TriangleSource triangles(object);
    PackedScene& packed = packing.packed;
    const Corners v = roundTriangle(triangles.vertices(source.face), packing.frame.origin).value();
    shared::Triangle& triangle = packed.triangles[slot];
    triangle.v0 = v[0];
    triangle.v1 = v[1];
    triangle.v2 = v[2];
    triangle.id = packing.numbers.firstId(source.object) + source.face;

    const Mesh* mesh = triangles.mesh();
    shared::TriangleSurface& surface = packed.triangleSurfaces[slot];
    triangleNormal(v[0], v[1], v[2], surface.normal);  // it has one, or it would have been dropped
    surface.object = source.object;
    surface.primitive = mesh != nullptr && !mesh->faces.empty() ? mesh->faces[source.face] : source.face;
    surface.material = materialOf(object, source.face);
    packing.materials.use(surface.material);
    surface.vertexNormals = shared::kNone;
    shared::VertexNormals normals;
    if (vertexNormals(mesh, source.face, normals)) {
        packed.vertexNormals[next.normals] = normals;
        surface.vertexNormals = next.normals++;
    }
    const uint32_t flags = attributeFlags(packing.scene, mesh, source.face, surface.material);
    if (flags == 0) return;
    surface.attributes = next.attributes | flags;
    writeAttributes(*mesh, source.face, flags, &packed.vertexAttributes[next.attributes]);
    next.attributes += attributeRows(flags);
}

}  // namespace

const KindPacker& packerOfTriangle() {
    static const TrianglePacker packer;
    return packer;
}

}  // namespace glint
