// The primitives of a glTF mesh as one Mesh.
#include <map>
#include <numeric>

#include "core/room.h"
#include "import/gltf_file.h"
#include "import/mesh_builder.h"

namespace glint {

namespace {

enum Mode { kPoints, kLines, kLineLoop, kLineStrip, kTriangles, kTriangleStrip, kTriangleFan };

constexpr glm::uvec3 kNone(Mesh::kNoIndex);

// Range that holds the elements of an accessor; primitives may share it.
struct Range {
    uint32_t first = 0;
    size_t count = 0;
};

class MeshReader {
  public:
    MeshReader(GltfFile& file, GltfMaterials& materials) : file_(file), materials_(materials) {}

    std::shared_ptr<const Mesh> read(size_t index) {
        const JsonCursor mesh = file_.item("meshes", index);
        const JsonCursor primitives = mesh.require("primitives");
        for (size_t i = 0; i < primitives.size(); i++) {
            const JsonCursor primitive = primitives.item(i);
            const ProgressPart part(file_.files(), i, primitives.size());
            readPrimitive(primitive);
        }
        if (mesh_.corners.empty()) return nullptr;
        dropUnusedAttributes(mesh_);
        return std::make_shared<const Mesh>(std::move(mesh_));
    }

  private:
    const Context& context() const { return file_.files().context(); }

    void readPrimitive(const JsonCursor& primitive) {
        const auto modeCursor = primitive.find("mode");
        const int mode = modeCursor ? modeCursor->integer(kPoints, kTriangleFan) : kTriangles;
        if (mode < kTriangles) {
            file_.warn("points and lines are ignored");
            return;
        }
        if (primitive.find("targets")) file_.warn("morph targets are ignored");
        const JsonCursor attributes = primitive.require("attributes");
        const auto position = attributes.find("POSITION");
        if (!position) {
            file_.warn(attributes.pointer(), ": no POSITION; not drawn");
            return;
        }
        const auto draco = extensionOf(primitive, "KHR_draco_mesh_compression");
        if (draco && (readsDraco() || !file_.at("accessors", *position).find("bufferView")))
            decodeDraco(file_, primitive, *draco);
        const auto material = primitive.find("material");
        const GltfMaterials::Use use = materials_.use(material);
        const Range positions = append(mesh_.positions, positions_, *position, {"VEC3"}, vector);
        context().report(0.3);
        const auto normal = attributes.find("NORMAL");
        const Range normals = normal ? append(mesh_.normals, normals_, *normal, {"VEC3"}, vector) : Range{};
        const std::string uvName = "TEXCOORD_" + std::to_string(use.texCoord);
        const auto uv = use.needsTexCoord ? attributes.find(uvName) : std::nullopt;
        if (use.needsTexCoord && !uv)
            file_.warn(attributes.pointer(), ": no ", uvName, ", which its material's texture goes by");
        context().report(0.5);
        const Range uvs = uv ? readUvs(*uv, use) : Range{};
        const auto color = attributes.find("COLOR_0");
        const Range colors = color ? readColors(*color) : Range{};
        for (const Range& range : {normals, uvs, colors})
            if (range.count != 0 && range.count != positions.count)
                attributes.fail("the attributes have ", positions.count, " and ", range.count,
                                " elements; they must have the same number");

        const auto add = [&](const glm::uvec3& v) {
            const auto cornersOf = [&v](const Range& range) {
                return range.count == 0 ? kNone : v + glm::uvec3(range.first);
            };
            mesh_.corners.push_back(cornersOf(positions));
            mesh_.normalCorners.push_back(cornersOf(normals));
            mesh_.uvCorners.push_back(cornersOf(uvs));
            mesh_.colorCorners.push_back(cornersOf(colors));
            mesh_.materials.push_back(use.material);
        };
        context().report(0.6);
        const std::vector<uint32_t> order = vertexOrder(primitive, positions.count);
        context().report(0.8);
        assemble(draco && readsDraco() ? kTriangles : mode, order, add);
    }

    std::vector<uint32_t> vertexOrder(const JsonCursor& primitive, size_t count) {
        std::vector<uint32_t> order;
        if (const auto reference = primitive.find("indices")) {
            order = readIndexAccessor(file_, file_.index("accessors", *reference));
            for (size_t i = 0; i < order.size(); i++)
                if (order[i] >= count)
                    reference->fail("element ", i, " is vertex ", order[i], ", there are ", count,
                                    " (numbered from 0)");
        } else {
            order.resize(count);
            std::iota(order.begin(), order.end(), 0u);
        }
        return order;
    }

    // Section 3.7.2.1. Corners repeated to join strips make no triangle.
    template <typename Add>
    void assemble(int mode, const std::vector<uint32_t>& v, const Add& add) {
        if (mode == kTriangles) {
            for (size_t i = 0; i + 2 < v.size(); i += 3) {
                context().pace(i / 3);
                add({v[i], v[i + 1], v[i + 2]});
            }
            return;
        }
        for (size_t i = 0; i + 2 < v.size(); i++) {
            context().pace(i);
            const glm::uvec3 corners = mode == kTriangleFan
                                           ? glm::uvec3(v[i + 1], v[i + 2], v[0])
                                           : glm::uvec3(v[i], v[i + 1 + i % 2], v[i + 2 - i % 2]);
            if (corners.x != corners.y && corners.y != corners.z && corners.z != corners.x) add(corners);
        }
    }

    // Appends an accessor's elements to `array`, unless they are there already.
    template <typename Element, typename Convert>
    Range append(std::vector<Element>& array, std::map<size_t, Range>& known, const JsonCursor& reference,
                 std::initializer_list<std::string_view> types, const Convert& convert) {
        const size_t accessor = file_.index("accessors", reference);
        if (const auto at = known.find(accessor); at != known.end()) return at->second;
        const GltfNumbers numbers = readAccessor(file_, accessor, types);
        if (array.size() + numbers.count() >= Mesh::kNoIndex) reference.fail("more than 2^32 - 2 vertices");
        const Range range{static_cast<uint32_t>(array.size()), numbers.count()};
        reserveMore(array, numbers.count());
        for (size_t i = 0; i < range.count; i++) {
            context().pace(i);
            array.push_back(convert(&numbers.values[i * numbers.components], numbers.components));
        }
        return known[accessor] = range;
    }

    static glm::dvec3 vector(const double* v, size_t) { return {v[0], v[1], v[2]}; }

    Range readUvs(const JsonCursor& reference, const GltfMaterials::Use& use) {
        const GltfUvTransform turn = use.turned.value_or(GltfUvTransform{});
        std::map<size_t, Range>& known = use.turned ? turnedUvs_[use.material] : uvs_;
        return append(mesh_.uvs, known, reference, {"VEC2"}, [&turn](const double* v, size_t) {
            const glm::dvec2 uv = turn({v[0], v[1]});
            return glm::dvec2(uv.x, 1 - uv.y);  // glTF counts v downwards
        });
    }
    Range readColors(const JsonCursor& reference) {
        return append(mesh_.colors, colors_, reference, {"VEC3", "VEC4"},
                      [this](const double* v, size_t size) {
                          if (size == 4 && v[3] < 1)
                              file_.warn("the alpha of vertex colours (COLOR_0) is ignored");
                          return Color(v[0], v[1], v[2]);
                      });
    }

    GltfFile& file_;
    GltfMaterials& materials_;
    Mesh mesh_;
    std::map<size_t, Range> positions_, normals_, uvs_, colors_;
    std::map<uint32_t, std::map<size_t, Range>> turnedUvs_;  // by material
};

}  // namespace

std::shared_ptr<const Mesh> readGltfMesh(GltfFile& file, GltfMaterials& materials, size_t index) {
    return MeshReader(file, materials).read(index);
}

}  // namespace glint
