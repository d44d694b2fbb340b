#include "import/scene_reader.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/text_file.h"
#include "import/gltf_scene.h"
#include "import/parse_scene.h"
#include "scene/cameras.h"
#include "scene/validate.h"

namespace glint {

struct SceneReader::State {
    std::filesystem::path path, folder;
    std::string name;
    std::string camera;  // that was chosen; empty: the file's own
    SceneFiles files;
    MeshMemory meshes;
    JsonValue document;  // of a .json file, as it stands in it
    Animation animation;
    std::vector<std::vector<double>> values;  // of each track, those that `scene` has; empty: the file's
    std::unique_ptr<GltfScene> gltf;          // of a .gltf or .glb file
    GltfPlaces places;                        // of the animated nodes that `scene` shows
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
    // Updates the cameras; an exception leaves them unchanged.
    void moveCameras(const JsonValue& json) {
        const Camera own = scene.camera;
        const std::vector<NamedCamera> named = scene.cameras;
        try {
            parseCameras(JsonCursor(json, name), scene);
            validateCameras(scene, name);
        } catch (const Error&) {
            scene.camera = own;
            scene.cameras = named;
            throw;
        }
        if (!camera.empty()) chooseCamera(scene, camera, name);
    }
    Change show(double time, bool everything);
    Change showGltf(double time);
};

// Nodes move; their contents stay the same.
SceneReader::Change SceneReader::State::showGltf(double time) {
    GltfPlaces next = gltf->placesAt(time);
    if (next == places) return Change::Nothing;
    Scene moved = scene;
    gltf->show(next, moved);
    std::erase_if(moved.cameras, [&](const NamedCamera& c) {  // those that were left out
        return std::ranges::find(scene.cameras, c.name, &NamedCamera::name) == scene.cameras.end();
    });
    try {
        if (!camera.empty()) chooseCamera(moved, camera, name);
        validateScene(moved, name);
    } catch (const Error& error) {
        throw Error(error.kind(), error.what() + (" (at " + describe(time) + " s of the animation)"));
    }
    places = std::move(next);
    scene = std::move(moved);
    return gltf->movesObjects() ? Change::Scene : Change::Camera;
}

SceneReader::Change SceneReader::State::show(double time, bool everything) {
    JsonValue moved = document;
    Change change = everything ? Change::Scene : Change::Nothing;
    std::vector<std::vector<double>> next = values;  // taken once the scene is known to be one
    for (size_t i = 0; i < animation.tracks.size(); ++i) {
        const AnimationTrack& track = animation.tracks[i];
        std::vector<double> value = valueAt(track.keyframes, time);
        setValue(moved, track, value);
        if (value == values[i]) continue;
        next[i] = std::move(value);
        change = std::max(change, track.movesCamera() ? Change::Camera : Change::Scene);
    }
    try {
        if (change == Change::Camera) moveCameras(moved);
        if (change == Change::Scene) scene = parsed(moved);
        values = std::move(next);
    } catch (const Error& error) {
        throw Error(error.kind(), error.what() + (" (at " + describe(time) + " s of the animation)"));
    }
    return change;
}

SceneReader::SceneReader(const std::filesystem::path& path, const LoadOptions& options,
                         std::optional<double> time)
    : state_(std::make_unique<State>(path, options)) {
    State& s = *state_;
    const std::string extension = path == "-" ? ".json" : lowerExtension(path);
    if (extension == ".gltf" || extension == ".glb") {
        s.gltf = openGltf(path, s.files);
        s.scene = completed(s.gltf->take(), path, s.files);
        s.scene.sources = s.files.sources();
        settleCamera(s.scene, path, options.camera);
        if (time && s.scene.animation) s.showGltf(*time);
        return;
    }
    if (extension != ".json") {
        s.scene = loadScene(path, options);
        return;
    }
    checkUpIsOpen(s.files, s.name);
    s.document = parseJson(s.files.read(path), s.name, s.files.context());
    s.animation = parseAnimation(JsonCursor(s.document, s.name));
    s.values.resize(s.animation.tracks.size());
    if (time)
        s.show(*time, true);
    else
        s.scene = s.parsed(s.document);
}

SceneReader::~SceneReader() = default;
SceneReader::SceneReader(SceneReader&&) noexcept = default;

SceneReader::Change SceneReader::moveTo(double time) {
    State& s = *state_;
    if (!s.gltf) return s.show(time, false);
    return s.scene.animation ? s.showGltf(time) : Change::Nothing;
}

const Scene& SceneReader::scene() const {
    return state_->scene;
}

}  // namespace glint
