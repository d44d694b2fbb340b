#include "import/load.h"

#include <algorithm>
#include <utility>

#include "core/error.h"
#include "core/text_file.h"
#include "import/parse_scene.h"
#include "import/readers.h"
#include "scene/cameras.h"
#include "scene/validate.h"

namespace glint {

namespace {

Scene loadModel(const std::filesystem::path& path, SceneFiles& files) {
    ImportedMesh imported = importMesh(path, files);
    Scene scene;
    scene.materials = std::move(imported.materials);
    scene.textures = std::move(imported.textures);
    scene.warnings = std::move(imported.warnings);
    if (scene.materials.empty()) scene.materials.emplace_back().name = "default";
    scene.objects.push_back(
        {"/objects/0", MeshShape{std::make_shared<const Mesh>(std::move(imported.mesh))}, 0});
    frameModel(scene, files.up().value_or(UpAxis::Y));
    validateFramedScene(scene, path.string());
    return scene;
}

// A faulty named camera must not make the file useless.
void dropFaultyCameras(Scene& scene, const std::filesystem::path& path) {
    std::erase_if(scene.cameras, [&](const NamedCamera& named) {
        try {
            validateCamera(named.camera, {path.string(), "camera \"" + named.name + '"'});
            return false;
        } catch (const Error& error) {
            scene.warnings.push_back(error.what() + std::string("; this camera is left out"));
            return true;
        }
    });
}

// Throws Error(Argument) if the options name an axis that points up, for a file with a camera.
void checkUpIsOpen(const SceneFiles& files, const std::string& name) {
    if (files.up())
        throw Error(ErrorKind::Argument, name + ": has a camera of its own, which decides what is up (--up)");
}

// Adds a camera and lights if an imported scene lacks them, and validates the scene.
Scene completed(ImportedScene imported, const std::filesystem::path& path, const SceneFiles& files) {
    Scene scene = std::move(imported.scene);
    if (imported.hasCamera) {
        checkUpIsOpen(files, path.string());
        validateCamera(scene.camera, {path.string(), "camera"});
    } else {
        frameCamera(scene, files.up().value_or(UpAxis::Y));
    }
    dropFaultyCameras(scene, path);
    if (scene.lights.empty()) lightModel(scene);
    imported.hasCamera ? validateScene(scene, path.string()) : validateFramedScene(scene, path.string());
    return scene;
}

// Chooses the camera of that name; without a name, warns if a scene of another program has several.
void settleCamera(Scene& scene, const std::filesystem::path& path, const std::string& camera) {
    if (!camera.empty()) return chooseCamera(scene, camera, path.string());
    if (scene.cameras.size() < 2) return;
    scene.warnings.push_back(concat(path.string(), ": has ", scene.cameras.size(),
                                    " cameras; the first is used, \"", printable(scene.cameras.front().name),
                                    '"'));
}

// Part of a scene file's load time for its text; its objects take the rest.
constexpr double kJsonPart = 0.1;

JsonValue readJson(std::string_view text, const std::string& name, SceneFiles& files) {
    const ProgressPart part(files, 0, kJsonPart);
    return parseJson(text, name, files.context());
}

}  // namespace

Scene parseScene(std::string_view text, const std::string& name, const std::filesystem::path& folder,
                 const LoadOptions& options) {
    SceneFiles files(folder, options);
    const JsonValue document = readJson(text, name, files);
    const ProgressPart part(files, kJsonPart, 1);
    MeshMemory memory;
    return parseScene(document, name, folder, files, memory);
}

struct SceneReader::State {
    std::filesystem::path path, folder;
    std::string name;
    std::string camera;  // that was chosen; empty: the file's own
    SceneFiles files;
    MeshMemory meshes;
    JsonValue document;  // of a .json file, as it stands in it
    Animation animation;
    std::unique_ptr<GltfScene> gltf;  // of a .gltf or .glb file
    TrackValues values;               // of the animation, those that `scene` has; empty: the file's
    Scene scene;

    State(const std::filesystem::path& file, const LoadOptions& options)
        : path(file),
          folder(file.parent_path()),
          name(file == "-" ? "standard input" : file.string()),
          camera(options.camera),
          files(folder, options) {}

    Scene parsed(const JsonValue& json) {
        Scene made = parseScene(json, name, folder, files, meshes);
        made.sources = files.sources();
        if (!camera.empty()) chooseCamera(made, camera, name);
        return made;
    }
    void moveCameras(const JsonValue& json) {
        Scene moved;  // its cameras
        parseCameras(JsonCursor(json, name), moved);
        validateCameras(moved, name);
        if (!camera.empty()) chooseCamera(moved, camera, name);
        scene.camera = moved.camera;
        scene.cameras = std::move(moved.cameras);
    }

    void readDocument(std::optional<double> time) {
        checkUpIsOpen(files, name);
        document = readJson(files.read(path), name, files);
        const ProgressPart part(files, kJsonPart, 1);
        if (!time) scene = parsed(document);
        SceneErrors errors(document, name);
        errors.attempt([&] { animation = parseAnimation(JsonCursor(document, name)); });
        errors.finish();
        if (time) show(*time, true);
    }

    // An exception leaves the scene as it was. `everything`: reads also what does not change.
    Change show(double time, bool everything = false) {
        try {
            return gltf ? showNodes(time) : showDocument(time, everything);
        } catch (const Error& error) {
            throw Error(error.kind(), error.what() + (" (at " + describe(time) + " s of the animation)"));
        }
    }

    // Nodes of glTF move; their contents stay the same.
    Change showNodes(double time) {
        TrackValues next = gltf->valuesAt(time);
        if (next == values) return Change::Nothing;
        Scene moved = scene;
        gltf->show(next, moved);
        std::erase_if(moved.cameras, [&](const NamedCamera& c) {  // those that were left out
            return std::ranges::find(scene.cameras, c.name, &NamedCamera::name) == scene.cameras.end();
        });
        if (!camera.empty()) chooseCamera(moved, camera, name);
        validateScene(moved, name);
        values = std::move(next);
        scene = std::move(moved);
        return gltf->movesObjects() ? Change::Scene : Change::Camera;
    }

    Change showDocument(double time, bool everything) {
        JsonValue moved = document;
        Change change = everything ? Change::Scene : Change::Nothing;
        TrackValues next = valuesAt(animation.tracks, time);
        setValues(moved, animation.tracks, next);
        for (size_t i = 0; i < next.size(); ++i)
            if (values.empty() || next[i] != values[i])
                change = std::max(change, animation.tracks[i].movesCamera() ? Change::Camera : Change::Scene);
        if (change == Change::Camera) moveCameras(moved);
        if (change == Change::Scene) scene = parsed(moved);
        values = std::move(next);
        return change;
    }
};

SceneReader::SceneReader(const std::filesystem::path& path, const LoadOptions& options,
                         std::optional<double> time)
    : state_(std::make_unique<State>(path, options)) {
    State& s = *state_;
    const std::string extension = path == "-" ? ".json" : lowerExtension(path);
    if (extension == ".json") {
        s.readDocument(time);
        return;
    }
    if (extension == ".gltf" || extension == ".glb") {
        s.gltf = openGltf(path, s.files);
        s.scene = completed(s.gltf->take(), path, s.files);
    } else if (extension == ".nff") {
        s.scene = completed(readNff(path, s.files), path, s.files);
    } else if (isMeshFile(path)) {
        s.scene = loadModel(path, s.files);
    } else {
        if (!s.files.isFile(path)) s.files.read(path);  // throws with the reason
        throw Error(ErrorKind::Scene,
                    path.string() +
                        ": unknown kind of file (a scene is .json, .gltf, .glb or .nff, a model "
                        ".obj, .ply or .stl)");
    }
    s.scene.sources = s.files.sources();
    settleCamera(s.scene, path, options.camera);
    if (time && s.scene.animation) s.show(*time);
}

SceneReader::~SceneReader() = default;
SceneReader::SceneReader(SceneReader&&) noexcept = default;

Scene SceneReader::take() {
    return std::move(state_->scene);
}

SceneReader::Change SceneReader::moveTo(double time) {
    return state_->gltf && !state_->scene.animation ? Change::Nothing : state_->show(time);
}

const Scene& SceneReader::scene() const {
    return state_->scene;
}

Scene loadScene(const std::filesystem::path& path, const LoadOptions& options) {
    return SceneReader(path, options).take();
}

bool isSceneFile(const std::filesystem::path& path) {
    const std::string extension = lowerExtension(path);
    return extension == ".json" || extension == ".nff" || isMeshFile(path);
}

}  // namespace glint
