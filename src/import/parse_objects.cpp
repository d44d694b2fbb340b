// The "objects" of a scene file and the meshes and materials that they name.
#include <algorithm>

#include "core/enum_names.h"
#include "core/error.h"
#include "import/parse_scene.h"
#include "import/readers.h"
#include "scene/limits.h"
#include "scene/transform.h"
#include "scene/validate.h"

namespace glint {

namespace {

PolygonShape parsePolygon(const JsonCursor& vertices) {
    if (!vertices.value().array() || vertices.size() < 3)
        vertices.failWanted("must be three points or more [[x, y, z], ...]");
    PolygonShape polygon;
    for (size_t i = 0; i < vertices.size(); i++) polygon.vertices.push_back(vertices.item(i).vector3());
    return polygon;
}

QuadricShape parseQuadric(const JsonCursor& object) {
    QuadricShape shape;
    const std::vector<double> coefficients =
        object.require("coefficients").numbers(10, "ten numbers [A, B, C, D, E, F, G, H, I, J]");
    std::ranges::copy(coefficients, shape.coefficients);
    const JsonCursor bounds = object.require("bounds");
    bounds.expectItems(2, "two points [[x, y, z], [x, y, z]]");
    shape.lo = bounds.item(0).vector3();
    shape.hi = bounds.item(1).vector3();
    return shape;
}

const KeyTable kObjects[] = {
    {"object/sphere", {"type", "center", "radius", "material", "transform"}},
    {"object/plane", {"type", "point", "normal", "material", "transform"}},
    {"object/disc", {"type", "center", "normal", "radius", "material", "transform"}},
    {"object/box", {"type", "min", "max", "material", "transform"}},
    {"object/triangle", {"type", "vertices", "material", "transform"}},
    {"object/polygon", {"type", "vertices", "material", "transform"}},
    {"object/quadric", {"type", "coefficients", "bounds", "material", "transform"}},
    {"object/ellipsoid", {"type", "center", "radii", "material", "transform"}},
    {"object/cylinder", {"type", "base", "top", "radius", "capped", "material", "transform"}},
    {"object/cone", {"type", "base", "apex", "radius", "topRadius", "capped", "material", "transform"}},
    {"object/hyperboloid", {"type", "base", "top", "radius", "waist", "capped", "material", "transform"}},
    {"object/paraboloid", {"type", "vertex", "top", "radius", "capped", "material", "transform"}},
    {"object/mesh", {"type", "mesh", "material", "transform"}},
    {"object/group", {"type", "objects", "material", "transform"}},
};

// Every type of object but meshes and groups.
Shape parseShape(std::string_view type, const JsonCursor& object) {
    const auto point = [&](std::string_view key) { return object.require(key).vector3(); };
    const auto number = [&](std::string_view key) { return object.require(key).number(); };
    const bool capped = object.flag("capped");
    if (type == "sphere") return SphereShape{point("center"), number("radius")};
    if (type == "plane") return PlaneShape{point("point"), point("normal")};
    if (type == "disc") return DiscShape{point("center"), point("normal"), number("radius")};
    if (type == "box") return BoxShape{point("min"), point("max")};
    if (type == "polygon") return parsePolygon(object.require("vertices"));
    if (type == "quadric") return parseQuadric(object);
    if (type == "ellipsoid") return EllipsoidShape{point("center"), point("radii")};
    if (type == "cylinder") return CylinderShape{point("base"), point("top"), number("radius"), capped};
    if (type == "cone")
        return ConeShape{point("base"), point("apex"), number("radius"), object.number("topRadius", 0),
                         capped};
    if (type == "hyperboloid")
        return HyperboloidShape{point("base"), point("top"), number("radius"), number("waist"), capped};
    if (type == "paraboloid") return ParaboloidShape{point("vertex"), point("top"), number("radius"), capped};
    if (type != "triangle") throw std::logic_error("parseShape does not read this type");
    const JsonCursor vertices = object.require("vertices");
    vertices.expectItems(3, "three points [[x, y, z], ...]");
    return TriangleShape{
        {vertices.item(0).vector3(), vertices.item(1).vector3(), vertices.item(2).vector3()}};
}

// ---- Transforms

Affine parseMatrix(const JsonCursor& list) {
    if (list.size() != 16) list.fail("a matrix must have 16 numbers, row after row (got ", list.size(), ")");
    double rows[16];
    for (size_t i = 0; i < 16; i++) rows[i] = list.item(i).number();
    if (rows[12] != 0 || rows[13] != 0 || rows[14] != 0 || rows[15] != 1)
        list.fail("the last row of the matrix must be 0 0 0 1 (got ", describe(rows[12]), " ",
                  describe(rows[13]), " ", describe(rows[14]), " ", describe(rows[15]), ")");
    Affine result;
    for (int row = 0; row < 3; row++) {
        for (int column = 0; column < 3; column++) result.linear[column][row] = rows[4 * row + column];
        result.offset[row] = rows[4 * row + 3];
    }
    return result;
}

Affine parseRotation(const JsonCursor& turn) {
    const std::vector<double> v = turn.numbers(4, "[x, y, z, degrees]");
    const glm::dvec3 axis(v[0], v[1], v[2]);
    if (axis == glm::dvec3(0)) turn.failWanted("the axis must not be zero");
    return rotation(axis, v[3]);
}

Affine parseQuaternion(const JsonCursor& turn) {
    const std::vector<double> v = turn.numbers(4, "four numbers [x, y, z, w]");
    const auto result = rotation({v[0], v[1], v[2], v[3]});
    if (!result) turn.failWanted("must not be zero, and its length finite");
    return *result;
}

Affine parseStep(const JsonCursor& step) {
    expectKeys(step, "transformStep");
    const auto members = step.members();
    if (members.size() != 1)
        step.fail("must hold exactly one of \"scale\", \"rotate\", \"quaternion\" and \"translate\"");
    const auto& [kind, value] = members.front();
    if (kind == "rotate") return parseRotation(value);
    if (kind == "quaternion") return parseQuaternion(value);
    if (kind == "translate") return translation(value.vector3());
    if (value.value().number()) return scaling(glm::dvec3(value.number()));
    const std::vector<double> v = value.numbers(3, "a number or [x, y, z]");
    return scaling({v[0], v[1], v[2]});
}

// A list of steps, applied first to last, or 16 numbers by rows.
Affine parseTransform(const JsonCursor& transform) {
    if (!transform.value().array()) transform.failWanted("must be a list of steps or 16 numbers");
    Affine result;
    if (transform.size() > 0 && transform.item(0).value().number()) {
        result = parseMatrix(transform);
    } else {
        for (size_t i = 0; i < transform.size(); i++) result = then(result, parseStep(transform.item(i)));
    }
    if (const std::string fault = transformFault(result); !fault.empty()) transform.fail(fault);
    return result;
}

// First the object's own transform, then that of its group.
std::optional<Affine> composed(const JsonCursor& object, const std::optional<Affine>& around) {
    const auto own = object.find("transform");
    if (!own) return around;
    const Affine affine = parseTransform(*own);
    if (!around) return affine;
    const Affine both = then(affine, *around);
    if (const std::string fault = transformFault(both); !fault.empty())
        own->fail(fault, " together with the transforms of the groups around it");
    return both;
}

// Refuses a name that is no key of `known`.
template <typename Map>
[[noreturn]] void failName(const JsonCursor& cursor, const std::string& what, const Map& known) {
    std::vector<std::string_view> names;
    for (const auto& entry : known) names.push_back(entry.first);
    const std::string hint = suggestion(cursor.string(), names, "defined");
    cursor.fail("no ", what, " \"", cursor.string(), "\" (", (hint.empty() ? "the scene defines none" : hint),
                ")");
}

class ObjectParser {
  public:
    // `meshes` is the scene's object of that name, if it has one.
    ObjectParser(const SceneParsing& in, const std::optional<JsonCursor>& meshes) : in_(in) {
        for (uint32_t i = 0; i < in.scene.materials.size(); i++)
            materials_.emplace(in.scene.materials[i].name, i);
        if (!meshes) return;
        for (const auto& [name, mesh] : meshes->members())
            meshes_.try_emplace(name, NamedMesh{mesh, nullptr});
    }

    // Appends the object, or those of a group, to the scene.
    void parse(const JsonCursor& object) { parse(object, {}); }
    void warnOfUnusedMeshes() {
        for (const auto& [name, mesh] : meshes_)
            if (!mesh.loaded)
                in_.scene.warnings.push_back(in_.name + ": " + mesh.source.pointer() +
                                             ": no object uses this mesh");
    }

  private:
    struct LoadedMesh {
        std::shared_ptr<const Mesh> own;    // with the file's materials, if it names some
        std::shared_ptr<const Mesh> plain;  // without
        uint32_t material = 0;              // the first of the file's materials in the scene
    };
    struct NamedMesh {
        JsonCursor source;
        std::shared_ptr<LoadedMesh> loaded;  // null before its first use
    };

    // Settings that an object inherits from the groups around it.
    struct Surrounding {
        std::optional<Affine> transform;
        std::optional<uint32_t> material;  // of objects that name none
        size_t depth = 0;
    };

    void parse(const JsonCursor& object, const Surrounding& around) {
        const std::string type(readType(object.require("type"), "object"));
        if (type == "group") return parseGroup(object, around);
        expectKeys(object, "object/" + type);

        Object result;
        result.name = object.pointer();
        std::optional<uint32_t> material = around.material;
        if (const auto name = object.find("material")) material = findMaterial(*name);
        if (type == "mesh") {
            result.material = material.value_or(Mesh::kNoIndex);
            result.shape = MeshShape{parseMesh(object, result.material)};
        } else {
            result.material = material ? *material : defaultMaterial();
            result.shape = parseShape(type, object);
            // Before the transform, so that the message shows the number in the file; meshes are looked at
            // once, at the end.
            validateShape(result.shape, {in_.name, result.name}, 0);
        }
        result.transform = composed(object, around.transform);
        in_.scene.objects.push_back(std::move(result));
    }

    void parseGroup(const JsonCursor& group, const Surrounding& around) {
        expectKeys(group, "object/group");
        if (around.depth == kMaxGroupDepth)
            group.fail("groups must not be nested deeper than ", kMaxGroupDepth);
        Surrounding inside = around;
        ++inside.depth;
        inside.transform = composed(group, around.transform);
        if (const auto material = group.find("material")) inside.material = findMaterial(*material);
        const JsonCursor objects = group.require("objects");
        if (!objects.value().array()) objects.failWanted("must be a list of objects");
        for (size_t i = 0; i < objects.size(); i++) parse(objects.item(i), inside);
    }

    // `material` is kNoIndex if the object names none; then it becomes the file's first one, or the default.
    std::shared_ptr<const Mesh> parseMesh(const JsonCursor& object, uint32_t& material) {
        LoadedMesh& loaded = load(object.require("mesh"));
        if (material == Mesh::kNoIndex) {
            material = loaded.own->materials.empty() ? defaultMaterial() : loaded.material;
            return loaded.own;
        }
        if (loaded.own->materials.empty()) return loaded.own;
        if (!loaded.plain) {
            in_.files.take(loaded.own->corners.size() * 2 * sizeof(glm::uvec3), in_.name);
            auto plain = std::make_shared<Mesh>(*loaded.own);
            plain->materials.clear();
            loaded.plain = std::move(plain);
        }
        return loaded.plain;
    }

    LoadedMesh& load(const JsonCursor& nameCursor) {
        const auto found = meshes_.find(nameCursor.string());
        if (found == meshes_.end()) failName(nameCursor, "mesh", meshes_);
        std::shared_ptr<LoadedMesh>& loaded = found->second.loaded;
        if (loaded) return *loaded;

        const JsonCursor file = found->second.source.require("file");
        const std::filesystem::path path =
            file.here([&] { return in_.files.resolve(in_.folder, file.string()); });
        if (!in_.files.exists(path)) file.fail("no such file: ", path.string());
        if (!isMeshFile(path)) file.fail(path.string(), ": ", kNoMeshFile);
        std::shared_ptr<LoadedMesh>& shared = byFile_[in_.files.real(path)];
        if (!shared) shared = std::make_shared<LoadedMesh>(readMesh(path));
        loaded = shared;
        return *loaded;
    }

    // Reads the file unless that was done for an earlier moment of an animation, and adds its materials.
    LoadedMesh readMesh(const std::filesystem::path& path) {
        LoadedMesh mesh;
        mesh.material = static_cast<uint32_t>(in_.scene.materials.size());
        std::shared_ptr<const ImportedMesh>& read = in_.memory[{path, mesh.material}];
        if (!read) {
            auto imported = std::make_shared<ImportedMesh>(importMesh(path, in_.files));
            validateVertices(imported->mesh, path.string());
            for (uint32_t& material : imported->mesh.materials) material += mesh.material;
            read = std::move(imported);
        }
        mesh.own = {read, &read->mesh};
        in_.scene.warnings.insert(in_.scene.warnings.end(), read->warnings.begin(), read->warnings.end());
        const auto firstTexture = static_cast<uint32_t>(in_.scene.textures.size());
        in_.scene.textures.insert(in_.scene.textures.end(), read->textures.begin(), read->textures.end());
        for (Material material : read->materials) {
            for (const auto& [key, texture] : kMaterialTextures)
                if (material.*texture != Material::kNoTexture) material.*texture += firstTexture;
            in_.scene.materials.push_back(std::move(material));
        }
        return mesh;
    }

    uint32_t findMaterial(const JsonCursor& nameCursor) const {
        if (nameCursor.value().object())
            nameCursor.fail("must be a name: put the material into \"materials\": {\"NAME\": {...}}");
        const auto found = materials_.find(nameCursor.string());
        if (found != materials_.end()) return found->second;
        failName(nameCursor, "material", materials_);
    }

    uint32_t defaultMaterial() {
        if (default_ == Mesh::kNoIndex) {
            default_ = static_cast<uint32_t>(in_.scene.materials.size());
            in_.scene.materials.emplace_back().name = "default";
        }
        return default_;
    }

    const SceneParsing& in_;
    std::map<std::string_view, NamedMesh> meshes_;
    std::map<std::string, uint32_t, std::less<>> materials_;
    std::map<std::filesystem::path, std::shared_ptr<LoadedMesh>> byFile_;  // several names may share one
    uint32_t default_ = Mesh::kNoIndex;
};

}  // namespace

std::span<const KeyTable> objectKeys() {
    return kObjects;
}

void parseObjects(const JsonCursor& root, const SceneParsing& in) {
    const auto meshes = root.find("meshes");
    if (meshes) {
        for (const auto& member : meshes->members())
            in.errors.attempt([&] {
                expectKeys(member.second, "mesh");
                member.second.require("file").string();
            });
    }
    ObjectParser parser(in, meshes);
    if (const auto objects = root.find("objects"))
        for (size_t i = 0; i < objects->size(); i++) {
            const ProgressPart part(in.files, i, objects->size());
            in.files.context().checkCancelled();
            in.errors.attempt([&] { parser.parse(objects->item(i)); });
        }
    parser.warnOfUnusedMeshes();
}

}  // namespace glint
