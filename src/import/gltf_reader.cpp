// glTF 2.0 (Khronos, The glTF 2.0 Specification, 2021): nodes, cameras, lights. docs/lab/file-readers.md
// states what assimp and tinygltf lose.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/error.h"
#include "core/vectors.h"
#include "import/gltf_file.h"
#include "import/parse_scene.h"
#include "import/readers.h"
#include "scene/cameras.h"
#include "scene/frame_model.h"
#include "scene/keyframes.h"
#include "scene/limits.h"
#include "scene/transform.h"

namespace glint {

namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

Affine matrixOf(const JsonCursor& node, const std::vector<double>& m) {
    if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
        node.fail("the last row of the matrix must be 0 0 0 1");
    return {{{m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}}, {m[12], m[13], m[14]}};
}

glm::dvec3 vectorOf(const std::vector<double>& v) {
    return {v[0], v[1], v[2]};
}

// Scales, turns by a quaternion unless it is empty, then moves.
Affine composed(const JsonCursor& node, const glm::dvec3& scale, const std::vector<double>& quaternion,
                const glm::dvec3& translation) {
    Affine place = scaling(scale);
    if (!quaternion.empty()) {
        const auto turn = rotation({quaternion[0], quaternion[1], quaternion[2], quaternion[3]});
        if (!turn) node.fail("the rotation must not be zero");
        place.linear = turn->linear * place.linear;
    }
    place.offset = translation;
    return place;
}

Affine placeOf(const JsonCursor& node) {
    const std::vector<double> matrix = node.numbers("matrix", 16);
    if (!matrix.empty()) return matrixOf(node, matrix);
    const glm::dvec3 scale = node.vector3("scale", glm::dvec3(1));
    const std::vector<double> quaternion = node.numbers("rotation", 4);
    return composed(node, scale, quaternion, node.vector3("translation", glm::dvec3(0)));
}

// ---- Animations (section 3.11), interpolation by appendix C

Interpolation interpolationOf(const JsonCursor& sampler) {
    const auto name = sampler.find("interpolation");
    if (!name || name->string() == "LINEAR") return Interpolation::Linear;
    if (name->string() == "STEP") return Interpolation::Step;
    if (name->string() == "CUBICSPLINE") return Interpolation::Cubic;
    name->failWanted("must be LINEAR, STEP or CUBICSPLINE");
}

void checkKeyframes(const JsonCursor& sampler, const Keyframes& keyframes) {
    const std::vector<double>& times = keyframes.times;
    if (times.empty()) sampler.fail("has no keyframes");
    for (size_t i = 1; i < times.size(); ++i)
        if (!(times[i] > times[i - 1])) sampler.fail("its times must ascend");
    if (keyframes.values.size() != times.size() * keyframes.stride())
        sampler.fail("has ", times.size(), " times, and values for ",
                     keyframes.values.size() / keyframes.stride());
    if (keyframes.rotation && zeroRotation(keyframes) < times.size())
        sampler.fail("a rotation must not be zero");
}

Keyframes readSampler(GltfFile& file, const JsonCursor& sampler, bool rotation) {
    Keyframes keyframes;
    keyframes.interpolation = interpolationOf(sampler);
    keyframes.rotation = rotation;
    keyframes.components = rotation ? 4 : 3;
    keyframes.times =
        readAccessor(file, file.index("accessors", sampler.require("input")), {"SCALAR"}).values;
    keyframes.values =
        readAccessor(file, file.index("accessors", sampler.require("output")), {rotation ? "VEC4" : "VEC3"})
            .values;
    checkKeyframes(sampler, keyframes);
    return keyframes;
}

// Nothing for what glint does not move.
std::optional<AnimationTrack> readChannel(GltfFile& file, const JsonCursor& samplers,
                                          const JsonCursor& channel) {
    const JsonCursor target = channel.require("target");
    const auto node = target.find("node");
    if (!node) return std::nullopt;  // an extension's
    const size_t nodeIndex = file.index("nodes", *node);
    const JsonCursor pathCursor = target.require("path");
    const std::string& path = pathCursor.string();
    if (path == "weights") {
        file.warn("morph targets are ignored");
        return std::nullopt;
    }
    if (path != "translation" && path != "rotation" && path != "scale")
        pathCursor.failWanted("must be translation, rotation, scale or weights");
    if (file.item("nodes", nodeIndex).find("matrix")) node->fail("a node with a matrix cannot be animated");
    const JsonCursor reference = channel.require("sampler");
    const auto index = static_cast<size_t>(reference.integer(0, std::numeric_limits<int>::max()));
    if (index >= samplers.size()) reference.fail("there is no such sampler");
    Keyframes keyframes = readSampler(file, samplers.item(index), path == "rotation");
    return AnimationTrack{{"nodes", std::to_string(nodeIndex), path}, std::move(keyframes), true};
}

// The channels of the file's first animation; none if it has no animation. Other animations, weights of morph
// targets and faulty channels cause a warning.
std::vector<AnimationTrack> readChannels(GltfFile& file) {
    std::vector<AnimationTrack> result;
    const auto animations = file.root().find("animations");
    if (!animations || animations->size() == 0) return result;
    const JsonCursor first = animations->item(0);
    if (animations->size() > 1) file.warn("of ", animations->size(), " animations only the first is shown");
    try {
        const JsonCursor samplers = first.require("samplers"), channels = first.require("channels");
        for (size_t i = 0; i < channels.size(); ++i)
            if (auto channel = readChannel(file, samplers, channels.item(i)))
                result.push_back(std::move(*channel));
    } catch (const Error& error) {
        file.warnOf(error, "nothing is animated");
        result.clear();
    }
    return result;
}

class Reader final : public GltfScene {
  public:
    Reader(const std::filesystem::path& path, SceneFiles& files, bool asMesh)
        : file_(path, files), asMesh_(asMesh) {}

    ImportedScene take() override {
        scene_.background = kModelBackground;
        scene_.ambient = kModelAmbient;
        tracks_ = readChannels(file_);
        walk();
        if (moves_)
            scene_.animation = spanOf(tracks_, 24);
        else if (!tracks_.empty())
            file_.warn("the animation moves nothing that is shown");
        if (!scene_.cameras.empty()) {
            scene_.camera = scene_.cameras.front().camera;
            scene_.image.width = pictureWidth(scene_.image, scene_.cameras.front().aspect);
        }
        const bool lit = !asMesh_ && !scene_.lights.empty();
        const auto materials = gltfMaterials(file_, scene_, lit);
        readMeshes(*materials);
        addObjects();
        if (lit) scene_.ambient = Color(materials->anyEmission() ? 1 : 0);
        if (scene_.objects.empty()) file_.root().fail("the scene shows no triangles");
        scene_.warnings = file_.takeWarnings();
        const bool hasCamera = !scene_.cameras.empty();
        return {std::move(scene_), hasCamera};
    }

    TrackValues valuesAt(double time) const override { return glint::valuesAt(tracks_, time); }
    bool movesObjects() const override { return movesObjects_; }

    void show(const TrackValues& values, Scene& scene) override {
        setValues(file_.document(), tracks_, values);
        scene_ = {};
        instances_.clear();
        cameraNames_.clear();
        sameNames_.clear();
        walk();
        addObjects();
        scene.objects = std::move(scene_.objects);
        if (!scene_.lights.empty()) scene.lights = std::move(scene_.lights);
        if (scene_.cameras.empty()) return;
        scene.camera = scene_.cameras.front().camera;
        scene.cameras = std::move(scene_.cameras);
    }

  private:
    struct Visit {
        size_t node;
        Affine parent;
        bool moves = false;  // a node above it is animated
    };
    struct Instance {
        size_t node, mesh;
        Affine place;
        std::string name;
    };

    // Pushes the last item first.
    void push(const JsonCursor& list, const Affine& parent, bool moves, std::vector<Visit>& stack) {
        for (size_t i = list.size(); i-- > 0;)
            stack.push_back({file_.index("nodes", list.item(i)), parent, moves});
    }

    void walk() {
        std::vector<Visit> stack;
        const auto chosen = file_.root().find("scene");
        if (file_.count("scenes") > 0) {
            const size_t index = chosen ? file_.index("scenes", *chosen) : 0;
            if (file_.count("scenes") > 1)
                file_.warn("of ", file_.count("scenes"), " scenes only number ", index, " is shown");
            const JsonCursor scene = file_.item("scenes", index);
            if (const auto nodes = scene.find("nodes")) push(*nodes, {}, false, stack);
        } else {
            pushRoots(stack);
        }
        std::set<std::string> animated;
        for (const AnimationTrack& track : tracks_) animated.insert(track.steps[1]);
        // Every node has at most one parent: a node that is visited twice is in a cycle or in two trees.
        std::vector<bool> seen(file_.count("nodes"));
        while (!stack.empty()) {
            const Visit visit = stack.back();
            stack.pop_back();
            const JsonCursor node = file_.item("nodes", visit.node);
            if (seen[visit.node]) node.fail("is reached twice: nodes must form trees");
            seen[visit.node] = true;
            const Affine place = then(placeOf(node), visit.parent);
            const bool moves = visit.moves || animated.contains(std::to_string(visit.node));
            const bool showsObjects = node.find("mesh") || node.find("extensions");
            movesObjects_ = movesObjects_ || (moves && showsObjects);
            moves_ = moves_ || (moves && (showsObjects || node.find("camera")));
            readNode(node, visit.node, place);
            if (const auto children = node.find("children")) push(*children, place, moves, stack);
        }
    }

    // Without scenes, the roots are the nodes without a parent.
    void pushRoots(std::vector<Visit>& stack) {
        std::vector<bool> child(file_.count("nodes"));
        for (size_t i = 0; i < child.size(); i++) {
            const JsonCursor node = file_.item("nodes", i);
            const auto children = node.find("children");
            for (size_t k = 0; children && k < children->size(); k++)
                child[file_.index("nodes", children->item(k))] = true;
        }
        for (size_t i = child.size(); i-- > 0;)
            if (!child[i]) stack.push_back({i, {}});
    }

    void readNode(const JsonCursor& node, size_t index, const Affine& place) {
        if (const auto mesh = node.find("mesh"))
            addInstances(node, {index, file_.index("meshes", *mesh), place, node.pointer()});
        if (node.find("skin")) file_.warn("skins are ignored: meshes stand as they were modelled");
        if (const auto camera = node.find("camera")) addCamera(*camera, node, place);
        if (const auto extension = extensionOf(node, "KHR_lights_punctual"))
            readLight(file_.at("lights", extension->require("light")), place);
    }

    // One, or as many as EXT_mesh_gpu_instancing gives places for.
    void addInstances(const JsonCursor& node, const Instance& instance) {
        const auto extension = extensionOf(node, "EXT_mesh_gpu_instancing");
        if (!extension) {
            instances_.push_back(instance);
            return;
        }
        const JsonCursor attributes = extension->require("attributes");
        const auto read = [&](std::string_view key, std::string_view type) {
            const auto accessor = attributes.find(key);
            return accessor ? readAccessor(file_, file_.index("accessors", *accessor), {type})
                            : GltfNumbers{};
        };
        const GltfNumbers move = read("TRANSLATION", "VEC3"), turn = read("ROTATION", "VEC4"),
                          scale = read("SCALE", "VEC3");
        const size_t count = std::max({move.count(), turn.count(), scale.count()});
        for (const GltfNumbers* list : {&move, &turn, &scale})
            if (list->count() != 0 && list->count() != count)
                attributes.fail("the attributes must have the same number of elements");
        file_.files().take(count * 2 * sizeof(Object), file_.name() + ": " + node.pointer());
        for (size_t i = 0; i < count; i++) {
            const auto element = [i](const GltfNumbers& list, const std::vector<double>& missing) {
                if (list.values.empty()) return missing;
                const double* const first = &list.values[i * list.components];
                return std::vector<double>(first, first + list.components);
            };
            const Affine local = composed(node, vectorOf(element(scale, {1, 1, 1})), element(turn, {}),
                                          vectorOf(element(move, {0, 0, 0})));
            instances_.push_back({instance.node, instance.mesh, then(local, instance.place),
                                  instance.name + "/" + std::to_string(i)});
        }
    }

    // The camera's own name, or its node's; each once.
    std::string cameraName(const JsonCursor& object, const JsonCursor& node, size_t index) {
        std::string name = object.text("name");
        if (name.empty()) name = node.text("name");
        if (name.empty()) name = "camera " + std::to_string(index);
        const std::string wanted = name;
        while (!cameraNames_.insert(name).second)
            name = wanted + " (" + std::to_string(++sameNames_[wanted] + 1) + ")";
        return name;
    }

    // Adds a camera. An invalid camera after the first one only causes a warning, so that the file stays
    // usable.
    void addCamera(const JsonCursor& reference, const JsonCursor& node, const Affine& place) {
        const size_t index = file_.index("cameras", reference);
        const JsonCursor object = file_.item("cameras", index);
        const std::string name = cameraName(object, node, index);
        try {
            scene_.cameras.push_back(readCamera(object, place));
            scene_.cameras.back().name = name;
        } catch (const Error& error) {
            if (scene_.cameras.empty()) throw;
            file_.warnOf(error, "this camera is left out");
        }
    }

    NamedCamera readCamera(const JsonCursor& object, const Affine& place) const {
        NamedCamera named;
        named.camera.eye = place.offset;
        named.camera.target = place.offset - glm::normalize(place.linear[2]);
        named.camera.up = place.linear[1];
        const JsonCursor type = object.require("type");
        if (type.string() == "perspective")
            readPerspective(object.require("perspective"), named);
        else if (type.string() == "orthographic")
            readOrthographic(object.require("orthographic"), named);
        else
            type.failWanted("must be perspective or orthographic");
        return named;
    }

    void readPerspective(const JsonCursor& lens, NamedCamera& named) const {
        Camera& camera = named.camera;
        const double yfov = lens.require("yfov").number();
        camera.fovY = yfov * kDegrees;
        if (!(camera.fovY > 0 && camera.fovY < 180))
            lens.require("yfov").fail("must be between 0 and pi (got ", describe(yfov), ")");
        named.aspect = lens.number("aspectRatio", 0);
        if (!(named.aspect > 0)) named.aspect = 1.0 * scene_.image.width / scene_.image.height;
        camera.nearT = std::max(lens.number("znear", 0), 0.0);
        // zfar is a plane, farT a distance: what lies in front of the plane is no farther than its corners.
        const double zfar = lens.number("zfar", 0);
        const double tangent = std::tan(yfov / 2);
        const double aspect = 1.0 * pictureWidth(scene_.image, named.aspect) / scene_.image.height;
        if (zfar > 0) camera.farT = zfar * std::sqrt(1 + tangent * tangent * (1 + aspect * aspect));
    }

    static void readOrthographic(const JsonCursor& lens, NamedCamera& named) {
        Camera& camera = named.camera;
        camera.projection = Projection::Orthographic;
        const double xmag = lens.require("xmag").number(), ymag = lens.require("ymag").number();
        if (xmag == 0 || ymag == 0) lens.fail("xmag and ymag must not be 0");
        camera.height = 2 * std::abs(ymag);
        named.aspect = std::abs(xmag / ymag);
        camera.nearT = std::max(lens.number("znear", 0), 0.0);
        const double zfar = lens.number("zfar", 0);
        if (zfar > 0) camera.farT = zfar;
    }

    // Candela and lux over pi: glint's diffuse colour is pi times the reflectance distribution that glTF
    // divides by pi.
    void readLight(const JsonCursor& light, const Affine& place) {
        const Color intensity =
            light.vector3("color", Color(1)) * (light.number("intensity", 1) / std::numbers::pi);
        const glm::dvec3 direction = -place.linear[2];
        const JsonCursor type = light.require("type");
        if (light.find("range")) file_.warn("the range of lights is ignored: they fall off by the square");
        if (type.string() == "directional") {
            scene_.lights.emplace_back(DirectionalLight{direction, intensity});
        } else if (type.string() == "point") {
            scene_.lights.emplace_back(PointLight{place.offset, intensity, Falloff::InverseSquare});
        } else if (type.string() == "spot") {
            SpotLight spot{place.offset, direction, 0, 45, intensity, Falloff::InverseSquare};
            if (const auto cone = light.find("spot")) readCone(*cone, spot);
            scene_.lights.emplace_back(spot);
        } else {
            type.failWanted("must be directional, point or spot");
        }
    }

    static void readCone(const JsonCursor& cone, SpotLight& spot) {
        const double inner = cone.number("innerConeAngle", 0);
        const double outer = cone.number("outerConeAngle", std::numbers::pi / 4);
        if (!(inner >= 0 && inner <= outer && outer <= std::numbers::pi / 2))
            cone.fail("must have 0 <= innerConeAngle <= outerConeAngle <= pi/2 (got ", describe(inner),
                      " and ", describe(outer), ")");
        spot.angle = inner * kDegrees;
        spot.penumbra = (outer - inner) * kDegrees;
    }

    // To a plane, a line or a point.
    bool flattened(const Instance& instance) {
        const glm::dmat3& m = instance.place.linear;
        if (!(isFinite(m[0]) && isFinite(m[1]) && isFinite(m[2]) && isFinite(instance.place.offset)))
            file_.item("nodes", instance.node)
                .fail("its transform, with those of its parents, is not finite");
        return !(conditionNumber(m) <= kMaxCondition);
    }

    // To a line or a point.
    static bool vanishes(const glm::dmat3& m) {
        const double size = std::max({glm::length(m[0]), glm::length(m[1]), glm::length(m[2])});
        if (size == 0) return true;
        const glm::dmat3 unit = m / size;
        return std::max({glm::length(glm::cross(unit[0], unit[1])), glm::length(glm::cross(unit[1], unit[2])),
                         glm::length(glm::cross(unit[2], unit[0]))}) < 1 / kMaxCondition;
    }

    // Reads the meshes of the instances. An animated file also needs those of vanishing instances, which may
    // grow.
    void readMeshes(GltfMaterials& materials) {
        const ProgressPart all(file_.files(), 0.2, 1);  // the JSON text is done
        for (size_t i = 0; i < instances_.size(); i++) {
            const ProgressPart part(file_.files(), i, instances_.size());
            const Instance& instance = instances_[i];
            if (meshes_.count(instance.mesh) == 0 && (!tracks_.empty() || !vanishes(instance.place.linear)))
                meshes_[instance.mesh] = readGltfMesh(file_, materials, instance.mesh);
        }
    }

    // Rays cannot be taken back through a place that flattens, so the vertices are moved. The shape is a part
    // of a plane and needs no normals.
    std::shared_ptr<const Mesh> flattenedMesh(const Mesh& mesh, const Affine& place) {
        file_.files().take(mesh.positions.size() * sizeof(glm::dvec3), file_.name());
        Mesh flat = transformed(mesh, place);
        flat.normals.clear();
        flat.normalCorners.clear();
        return std::make_shared<const Mesh>(std::move(flat));
    }

    void addObjects() {
        for (const Instance& instance : instances_) {
            const JsonCursor node = file_.item("nodes", instance.node);
            const bool flat = flattened(instance);
            if (flat && vanishes(instance.place.linear)) {
                file_.warn(node.pointer(), ": flattened by its transform; not drawn");
                continue;
            }
            const std::shared_ptr<const Mesh>& mesh = meshes_.at(instance.mesh);
            if (!mesh) continue;
            Object object{instance.name, MeshShape{mesh}, mesh->materials.front()};
            if (flat) object.shape = MeshShape{flattenedMesh(*mesh, instance.place)};
            if (!flat && instance.place != Affine{}) object.transform = instance.place;
            scene_.objects.push_back(std::move(object));
        }
    }

    GltfFile file_;
    bool asMesh_;
    Scene scene_;
    std::vector<AnimationTrack> tracks_;
    bool moves_ = false;         // the animation moves something that is shown
    bool movesObjects_ = false;  // and not only cameras
    std::map<size_t, std::shared_ptr<const Mesh>> meshes_;
    std::vector<Instance> instances_;
    std::set<std::string> cameraNames_;
    std::map<std::string, int> sameNames_;
};

}  // namespace

std::unique_ptr<GltfScene> openGltf(const std::filesystem::path& path, SceneFiles& files, bool asMesh) {
    return std::make_unique<Reader>(path, files, asMesh);
}

}  // namespace glint
