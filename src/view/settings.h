// Changes by the panel (settings that tracing depends on, edits that need the scene packed again), and its
// undo.
#pragma once

#include <deque>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

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

// Stops sampling at an error instead of a number of samples (docs/design/error-targets.md).
struct ErrorSetting {
    double error = 0;  // linear radiance, root mean square over the picture; 0: a number of samples
    double confidence = 0.95;
    bool withinDepth = false;  // what lies beyond the depth is not counted
    bool operator==(const ErrorSetting&) const = default;
};

// Values that need the scene packed again.
struct SceneEdits {
    std::vector<Material> materials;  // as in Scene::materials
    TransmissiveShadows transmissiveShadows = TransmissiveShadows::Colored;
    bool operator==(const SceneEdits& other) const;

    static SceneEdits of(const Scene& scene);
    // After the file has changed, as PictureSettings::follow. Materials are told apart by their place.
    void follow(const SceneEdits& before, const SceneEdits& now);
};

struct PictureSettings {
    ViewLayer layer = ViewLayer::Color;
    int maxDepth = 5;
    bool shadows = true;
    bool reflections = true;
    std::vector<LightSetting> lights;
    glm::vec3 background{0};
    Methods methods;
    ImageSettings sampling;  // its size is not used
    int sampleLimit = 64;    // of the picture in the window, unless `until` says it
    ErrorSetting until;
    SceneEdits edits;
    bool operator==(const PictureSettings&) const = default;

    // The settings of the file.
    static PictureSettings of(const Scene& scene);
    uint32_t depth() const { return reflections ? static_cast<uint32_t>(maxDepth) : 0u; }
    // After the file has changed: what was as in `before` is now as in `now`; what the user has moved stays.
    void follow(const PictureSettings& before, const PictureSettings& now);
};

// A multiple of 0.5 stops further, within kMostExposure.
double steppedExposure(double exposure, double step);

Scene edited(Scene scene, const SceneEdits& edits);

// Changes the diffuse color, and the ambient color with it while both are equal: in a scene file "ambient" is
// "diffuse" unless it is given.
void setDiffuse(Material& material, const Color& diffuse);

// Values of "lights" and "materials" in a scene file: all lights that are on, and the changed fields of
// materials (empty if nothing differs from `before`).
std::string lightsJson(const std::vector<LightSetting>& lights);
std::string materialsJson(const std::vector<Material>& materials, const std::vector<Material>& before);

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
    void reset(Undoable now) { seen_ = std::move(now); }
    const Undoable& seen() const { return seen_; }
    // Takes a change, at `seconds` of any clock. It is a step of its own if endStep() was called since the
    // last change, or if that one is older than kStepSeconds.
    void note(Undoable now, double seconds);
    void endStep() { stepEnded_ = true; }

    // The state before or after; empty if there is none.
    std::optional<Undoable> undo();
    std::optional<Undoable> redo();

    static constexpr size_t kMost = 100;
    static constexpr double kStepSeconds = 0.5;

  private:
    Undoable seen_;
    std::deque<Undoable> before_, after_;
    bool stepEnded_ = true;
    double changedAt_ = 0;
};

}  // namespace glint::view
