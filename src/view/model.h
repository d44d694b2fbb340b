// The state of the window: scene, edits, image, messages, controls. Commands (commands.h) change it.
#pragma once

#include <deque>
#include <filesystem>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/device_layout.h"
#include "core/stopwatch.h"
#include "gpu/device.h"
#include "reference/tracer.h"
#include "trace/picture.h"
#include "view/camera_control.h"
#include "view/display.h"
#include "view/files.h"
#include "view/jobs.h"
#include "view/session.h"
#include "view/settings.h"
#include "view/timeline.h"
#include "view/view.h"
#include "view/view_scene.h"

namespace glint::view {

// ---- a picked pixel: what was hit, the tree of rays behind its color, and where they are in the image ----

// One ray of the tree that makes a pixel's colour, as the reference follows it.
struct PickRay {
    reference::RayClass kind = reference::RayClass::Primary;
    uint32_t depth = 0;         // rays before it
    glm::dvec3 from{0}, to{0};  // world; of a ray that hits nothing, `to` is a little way off
    double share = 0;           // its own contribution to the pixel's colour, 0..1 (luminance, Rec. 709)
    std::string text;           // "reflected: /objects/3 (sphere) face 0, t = 2.5, chrome"
};

struct Pick {
    int x = 0, y = 0;           // of the picture
    PixelData data;             // from the device
    std::vector<PickRay> rays;  // in the order they are followed: each after the one that it comes from

    bool hit() const { return data.object != PixelData::kNoIndex; }
};

Pick pickPixel(Session& session, int x, int y);

// The two lines that `glint trace --pixel` prints.
std::string pickCsv(const Pick& pick);

struct Segment {
    glm::dvec2 from{0}, to{0};  // pixels, from the picture's top left corner
};

// The part of the line from `from` to `to` (local coordinates, as the camera's) that lies before the eye;
// empty if none does.
std::optional<Segment> projected(const shared::Camera& camera, const glm::dvec3& from, const glm::dvec3& to);

// ---- messages that expire ----

enum class ToastKind { Info, Error };

struct Toast {
    std::string text;
    ToastKind kind = ToastKind::Info;
    double until = 0;  // seconds of the clock that add() was given
};

class Toasts {
  public:
    // An error stays twice as long. A toast with the text of a shown one replaces it.
    void add(const std::string& text, ToastKind kind, double now);
    // Drops what has expired; true if anything has.
    bool expire(double now);
    void clear() { toasts_.clear(); }
    const std::deque<Toast>& shown() const { return toasts_; }

    static constexpr double kSeconds = 5;  // to read a line of text and look back at the image
    static constexpr size_t kMost = 4;

  private:
    std::deque<Toast> toasts_;
};

class Commands;
struct Model;
// The effect of a key or a button.
using Command = void (*)(Model&, Commands&);

struct Model {
    // Loads the scene. Throws Error as loadScene does.
    explicit Model(const Options& start);

    // ---- the scene ----
    std::filesystem::path path;  // of the scene to show; that of `scene` while another one is loading
    Loading options;             // of every load
    std::shared_ptr<Moments> moments;
    std::shared_ptr<const Scene> file;       // of the moment that is shown, without the user's edits
    std::shared_ptr<const ViewScene> scene;  // that is shown
    std::optional<double> time;              // of `scene`, seconds; empty: as the file says it
    Timeline timeline;
    std::string sceneError;  // of the file on disk, while an older scene is shown

    // ---- what the user edits; undo covers camera, lights, background and materials ----
    CameraControl control;
    PictureSettings settings, fileSettings;  // fileSettings: as the file says it
    History history;
    std::vector<NamedCamera> bookmarks;  // not in the file
    static constexpr size_t kNoCamera = ~size_t{0};
    size_t camera = kNoCamera;  // last chosen, of the file's cameras, then the bookmarks

    // ---- the image ----
    std::unique_ptr<Session> session;
    Display display;
    Comparison comparison;
    std::optional<Pick> pick;
    bool pickIsOld = false;           // from an earlier view
    std::optional<glm::ivec2> pixel;  // that the inspector shows
    std::string verdict;              // of the last verification; empty: none to show
    bool verdictPassed = false;
    std::optional<Canvas> difference;  // of a failed verification, while it is shown
    Canvas picture;                    // as shown, without the panel

    // ---- messages ----
    Toasts toasts;
    Hints hints;
    RecentFiles recent;
    std::vector<std::string> warnings;  // of the scene's files, until Esc

    // ---- jobs beside the window ----
    Job saving, verifying, referring, loading, packing;
    bool isClosing = false;  // once the image is saved

    // ---- controls of the panel ----
    int left = 0;  // of the image in the window: width of the docked panel
    bool panelVisible = true, docked = true, helpVisible = false, inspects = false;
    bool saveAsVisible = false, saveSceneVisible = false, openVisible = false;
    bool flying = false, pinsPick = false, drawsRays = true;
    double flySpeed = 1;
    size_t material = 0;  // shown in the group "materials"
    int zoom = 9;         // pixels across the inspector's magnifier
    std::string saveName, sceneName, openName;
    bool savesSeen = true;      // save as: as shown, or at the scene's own sampling
    bool replacesFile = false;  // save scene: over an existing file
    std::filesystem::path openFolder;
    std::vector<std::string> openFiles;  // in openFolder
    double helpScroll = 0;               // pixels
    float timelineHeight = 0;            // pixels, in the previous frame; 0: hidden
    Command wish = nullptr;              // of a button, for the next round

    // ---- speed ----
    double targetSeconds = 0;  // of a frame while the camera moves
    double frameSeconds = 0, drawSeconds = 0, presentSeconds = 0;
    std::vector<float> frameTimes;  // milliseconds, oldest first

    int dirty = 3;     // frames to draw even if nothing happens
    Stopwatch clock;   // of toasts, flicker and the timeline
    Stopwatch motion;  // since the image last changed as a whole

    static constexpr double kRestSeconds = 0.2;  // without motion until the image is refined
    bool moving() const { return motion.seconds() < kRestSeconds; }
    void touch() { motion.restart(); }
    void say(const std::string& text, ToastKind kind = ToastKind::Info);

    bool compares() const { return comparison.any() && comparison.mode != CompareMode::Off; }
    // Linear colours of the image; null before the first sample.
    const Image* comparable() const;
    // The scene's file can hold cameras, lights and materials.
    bool hasJsonFile() const;

    // Shows the warnings of loading, and writes them to `err`.
    void sayWarnings(std::ostream& err);
    // Lights or materials differ from the file.
    bool edited() const {
        return settings.lights != fileSettings.lights || settings.edits != fileSettings.edits;
    }
    // While a comparison cannot be shown yet: what it waits for; else empty.
    std::string waitingComparison() const;

    // The file's cameras, then the bookmarks.
    std::vector<const NamedCamera*> cameras() const;
    void goToCamera(size_t index);  // round and round
    // Keeps this camera as a bookmark.
    void keepCamera();

    // The state that undo restores; whether it differs from the one that the history has seen.
    Undoable undoable() const { return {control.camera(), settings, fileSettings}; }
    bool changed() const;
    void restore(const Undoable& state);

    // Forgets what belongs to an earlier view: pick (unless it is pinned), verdict and difference.
    void forgetView(bool evenPinned = false);
};

}  // namespace glint::view
