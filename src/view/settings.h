// Changes by the panel (settings that tracing depends on, edits that need the scene packed again), and its
// undo.
#pragma once

#include <glm/glm.hpp>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "converge/converge.h"
#include "scene/scene.h"
#include "trace/methods.h"
#include "view/display.h"

namespace glint::view {

struct LightSetting {
    bool on = true;
    float dim = 1;  // times the intensity
    Light light;
    bool operator==(const LightSetting&) const = default;
};

// Edits of the scene itself, which "save scene" writes into its file. They need the scene packed again. All
// other settings, lights included, are wishes, which Session puts into its requests.
struct SceneEdits {
    std::vector<Material> materials;  // as in Scene::materials
    TransmissiveShadows transmissiveShadows = TransmissiveShadows::Colored;
    bool operator==(const SceneEdits&) const = default;

    static SceneEdits of(const Scene& scene);
    // After the file has changed, as PictureSettings::follow. A material is identified by its place.
    void follow(const SceneEdits& before, const SceneEdits& now);
};

struct PathSettings {
    int maxDepth = 5;
    bool shadows = true;
    bool reflections = true;
    glm::vec3 background{0};
    Methods methods;
    bool operator==(const PathSettings&) const = default;
};

// Values of the command line in place of the file's, for every scene that the window loads.
struct Wishes {
    std::optional<uint32_t> depth;  // PathLimits::depth
    std::optional<int> samplesPerPixel;
};

struct PictureSettings : PathSettings {
    ViewLayer layer = ViewLayer::Color;
    std::vector<LightSetting> lights;
    ImageSettings sampling;              // of the file; its size is not used
    int sampleLimit = 64;                // of the window's image, unless `until` has an error
    converge::Target until{.error = 0};  // 0: a number of samples
    SceneEdits edits;
    bool operator==(const PictureSettings&) const = default;

    // The settings of the file, with `wishes`.
    static PictureSettings of(const Scene& scene, const Wishes& wishes = {});
    uint32_t depth() const { return reflections ? static_cast<uint32_t>(maxDepth) : 0u; }
    // After the file has changed: values that are as in `before` become those of `now`; the user's own values
    // stay.
    void follow(const PictureSettings& before, const PictureSettings& now);
};

// Changes the diffuse color, and the ambient color with it while both are equal: in a scene file "ambient" is
// "diffuse" unless it is given.
void setDiffuse(Material& material, const Color& diffuse);

// Members of a scene file for what differs from `file`, as JSON: "lights" (all that are on), "materials" (the
// changed fields), "transmissiveShadows".
std::map<std::string, std::string> changedMembers(const PictureSettings& settings,
                                                  const PictureSettings& file);

// The text of a JSON scene with the lights and edits that differ from `file`; comments are lost. Throws
// Error(Argument) if a changed material is not in the text.
std::string editedSceneText(const std::string& text, const PictureSettings& settings,
                            const PictureSettings& file);

// Undo restores camera, lights, background and edits.
struct Undoable {
    Camera camera;
    PictureSettings settings;
    // The file at that time: values equal to it follow the file when the state is restored.
    PictureSettings file;
};

class History {
  public:
    // `now` becomes the state that changes are measured from, without a step to undo.
    void reset(Undoable now) { states_[at_] = std::move(now); }
    const Undoable& seen() const { return states_[at_]; }
    // Takes a change, which begins a step if endStep() was called since the last change.
    void note(Undoable now);
    void endStep() { stepEnded_ = true; }

    // The previous or next state; null at the ends of the history.
    const Undoable* undo() { return at_ > 0 ? go(at_ - 1) : nullptr; }
    const Undoable* redo() { return at_ + 1 < states_.size() ? go(at_ + 1) : nullptr; }

    static constexpr size_t kMost = 100;

  private:
    const Undoable* go(size_t at) {
        stepEnded_ = true;
        return &states_[at_ = at];
    }

    std::vector<Undoable> states_ = std::vector<Undoable>(1);
    size_t at_ = 0;
    bool stepEnded_ = true;
};

}  // namespace glint::view
