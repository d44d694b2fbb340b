// A scene as the window holds it, at the moments of its animation, and the files that it is made of.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "import/load.h"
#include "pack/build_tree.h"
#include "pack/packed_scene.h"
#include "scene/scene.h"
#include "view/camera_control.h"
#include "view/settings.h"
#include "view/view.h"

namespace glint::view {

struct ViewScene {
    std::filesystem::path path;
    Scene scene;
    PackedScene packed;  // as loaded: every light on
    // Features that the panel may switch on though the scene does without: mirrors, if a material reflects,
    // cameras with parallel rays, and a lens.
    SceneFeatures also;
};

// `memory`: of trees, may be null; see pack/build_tree.h.
std::shared_ptr<const ViewScene> packViewScene(const std::filesystem::path& path, Scene scene,
                                               BuildQuality quality, TreeMemory* memory = nullptr);

// Around everything that is finite; around eye and target if nothing is.
Ball boundsOf(const ViewScene& scene);
// Around an object; around `hit` (world), as large as a tenth of the way there, for one without end.
Ball boundsOf(const ViewScene& scene, uint32_t object, const glm::dvec3& hit, double distance);

struct Moment {
    std::optional<double> time;              // seconds; empty: as the file says it
    std::shared_ptr<const Scene> file;       // without the panel's changes
    SceneEdits edits;                        // that `scene` has
    std::shared_ptr<const ViewScene> scene;  // null: as before, the camera aside
};

// For one thread at a time.
class Moments {
  public:
    // Reads the file. Throws Error(Scene) as loadScene does.
    Moments(const std::filesystem::path& path, const Loading& loading, std::optional<double> time);

    // The scene as it is now, or at a time, with those of `edits` that differ from the file's earlier state,
    // `before`. Geometry that has not moved keeps its tree; if only the camera moves, nothing is packed.
    // Throws Error(Scene) if the animation leads to an invalid scene; then the moment before stays.
    Moment show(std::optional<double> time = {}, const SceneEdits& edits = {}, const SceneEdits& before = {});

    uint64_t treesBuilt() const { return memory_.built(); }

  private:
    std::filesystem::path path_;
    Loading loading_;
    SceneReader reader_;
    std::optional<double> time_;
    TreeMemory memory_;
    bool remembers_ = false, moved_ = true;  // moved: since the last time that it was packed
    std::shared_ptr<const ViewScene> last_;  // that was packed
    SceneEdits lastEdits_;
};

// The time of an animation that is shown, and how it plays.
class Timeline {
  public:
    static constexpr int kMostFrames = 10'000'000;

    // Takes the span of the scene that is shown; without a span nothing moves. The moment stays.
    void follow(const std::optional<AnimationSpan>& span);
    bool any() const { return span_.has_value(); }

    // The requested time in seconds; empty: the scene as its file states it.
    std::optional<double> time() const { return time_; }
    void setTime(std::optional<double> time);  // stops there
    // The frame nearest to the moment, counted as by `glint render --frames`.
    int frame() const;
    // Frames of the first and the last keyframe.
    int first() const;
    int last() const;

    bool loops = true;  // from the end on to the beginning

    // `now`: of any clock, in seconds. Playing begins at the time that is shown, or at 0 after the end.
    bool playing() const { return playing_; }
    void play(double now);
    void toggle(double now) { playing_ ? void(playing_ = false) : play(now); }
    // True if there is another moment to show. Skips frames that are late.
    bool advance(double now);

    // All of them stop playing, at the first or the last frame at the farthest.
    void goTo(int frame);
    void step(int frames);

  private:
    double rate() const { return span_ ? span_->framesPerSecond : 24; }  // frames a second

    std::optional<AnimationSpan> span_;
    std::optional<double> time_;
    bool playing_ = false;
    double position_ = 0, since_ = 0;  // while playing: the moment between frames, and when it was reached
};

// "?" for an unknown index.
std::string objectName(const Scene& scene, uint32_t object);
std::string materialName(const Scene& scene, uint32_t material);

}  // namespace glint::view
