// The state of the window: scene, edits, image, messages, controls. Commands (commands.h) change it.
#pragma once

#include <algorithm>
#include <array>
#include <atomic>
#include <deque>
#include <filesystem>
#include <functional>
#include <future>
#include <glm/glm.hpp>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/device_layout.h"
#include "core/stopwatch.h"
#include "core/text_file.h"
#include "reference/tracer.h"
#include "trace/picture.h"
#include "view/camera_control.h"
#include "view/display.h"
#include "view/files.h"
#include "view/session.h"
#include "view/settings.h"
#include "view/view.h"
#include "view/view_scene.h"

namespace glint::view {

// ---- a picked pixel: its hit, the tree of rays behind its color, and their positions in the image ----

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

// ---- work in the background, a thread for each job ----

struct JobControl {
    std::atomic<double> progress{0};
    std::atomic<bool> cancelled{false};
};

// At most one run at a time. Destruction cancels and waits.
class Job {
  public:
    // The rest of the work, on the window's thread, with the result.
    using Rest = std::function<void()>;

    explicit Job(const char* name) : name_(name) {}
    ~Job() { stop(); }
    Job(const Job&) = delete;
    Job& operator=(const Job&) = delete;

    // Stops an earlier run. Wakes the window when the work ends.
    void start(std::function<Rest(JobControl&)> work);
    bool running() const { return future_.valid(); }
    double progress() const { return control_ ? control_->progress.load() : 0; }
    const char* name() const { return name_; }
    // Does the rest if the work has ended; else returns false. Throws gpu::DeviceLost.
    bool finish();
    void stop();

    // Takes the message of any other exception, on the window's thread.
    std::function<void(const std::string& what)> failed;

  private:
    const char* name_;  // for people; empty: not shown
    std::unique_ptr<JobControl> control_;
    std::future<Rest> future_;
};

class Window;
struct Model;
// The effect of a key or a button.
using Command = void (*)(Model&);

struct Model {
    // Loads the scene. Throws Error as loadScene does. `out`: results (CSV of a pick, JSON, names of files);
    // `err`: errors of files and jobs.
    Model(const Options& start, std::ostream& out, std::ostream& err);

    std::ostream &out, &err;
    Window* window = nullptr;
    const gpu::Device* device = nullptr;

    // ---- the scene ----
    std::filesystem::path path;  // of the scene to show; that of `scene` while another one is loading
    Loading options;             // of every load
    const Wishes wishes;
    std::shared_ptr<Moments> moments;
    std::shared_ptr<const Scene> file;       // of the moment that is shown, without the user's edits
    std::shared_ptr<const ViewScene> scene;  // that is shown
    std::optional<double> time;              // of `scene`, seconds; empty: as the file says it
    Timeline timeline;
    std::string sceneError;  // of the file on disk, while an older scene is shown
    FileWatch files;         // of the scene
    Stopwatch fileWatch;     // since the last look at them
    uint64_t reloads = 0;

    // ---- what the user edits; undo covers camera, lights, background and materials ----
    CameraControl control;
    PictureSettings settings, fileSettings;  // fileSettings: as the file says it
    PictureSettings written;                 // lights and edits, when they were last written or copied
    bool warned = false;                     // that work is unsaved()
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
    struct Shown {                     // the state that `picture` shows
        uint64_t version = ~uint64_t{0};
        Display display;
        bool difference = false, flash = false;
        CompareMode mode = CompareMode::Off;
        double wipe = 0, gain = 0;
        uint64_t other = 0;
        bool measured = false;
        bool operator==(const Shown&) const = default;
    } shown;
    std::pair<uint64_t, uint64_t> measured;  // of Comparison::figures: version, number of the other image

    // ---- messages ----
    Toasts toasts;
    Hints hints;
    RecentFiles recent;
    std::vector<std::string> warnings;  // of the scene's files, until Esc

    // ---- jobs in the background ----
    Job saving{"saving"}, verifying{"verifying"}, referring{"tracing the reference"},
        loading{"loading the scene"}, packing{""};
    const std::array<Job*, 5> jobs = {&saving, &verifying, &referring, &loading, &packing};
    bool isClosing = false;              // once the image is saved
    bool closes = false;                 // now
    bool opensAnother = false;           // scene: `loading` does
    bool loadsAgain = false;             // once `loading` has ended, whose result is not wanted
    SceneEdits editsAtWork;              // of `packing`, or of the scene that is shown
    std::optional<double> timeAtWork;    // likewise
    std::string lastError, lostPicture;  // lostPicture: the error of the last image that was not saved

    // ---- controls of the panel ----
    int left = 0;  // of the image in the window: width of the docked panel
    bool panelVisible = true, docked = true, helpVisible = false, inspects = false;
    bool saveAsVisible = false, saveSceneVisible = false, openVisible = false;
    bool flying = false, pinsPick = false, drawsRays = true;
    double flySpeed = 1;
    size_t material = 0;  // shown in the group "materials"
    std::string saveName, sceneName, openName;
    bool savesSeen = true;      // save as: as shown, or at the scene's own sampling
    bool replacesFile = false;  // over an existing file
    std::filesystem::path openFolder;
    std::vector<std::string> openFiles;  // in openFolder
    float timelineHeight = 0;            // pixels, in the previous frame; 0: hidden
    Command wish = nullptr;              // of a button, for the next round

    // ---- speed ----
    double targetSeconds = 0;  // of a frame while the camera moves
    double frameSeconds = 0, drawSeconds = 0, presentSeconds = 0;

    int dirty = 3;     // frames to draw even if nothing happens
    Stopwatch clock;   // of toasts, flicker and the timeline
    Stopwatch motion;  // since the image last changed as a whole

    bool busy() const {
        return std::any_of(jobs.begin(), jobs.end(), [](const Job* job) { return job->running(); });
    }
    static constexpr double kRestSeconds = 0.2;  // without motion until the image is refined
    bool moving() const { return motion.seconds() < kRestSeconds; }
    void touch() { motion.restart(); }
    // Draws at least so many frames; the panel may need three to settle after a command.
    void redraw(int frames = 3) { dirty = std::max(dirty, frames); }
    void say(const std::string& text, ToastKind kind = ToastKind::Info);

    bool compares() const { return comparison.any() && comparison.mode != CompareMode::Off; }
    // Linear colours of the image; null before the first pass.
    const Image* comparable() const;
    // The scene's file can hold cameras, lights and materials.
    bool hasJsonFile() const { return lowerExtension(scene->path) == ".json"; }

    void fail(const std::string& what);    // a message, also to `err`
    void report(const std::string& line);  // a message, also to `out`
    void follow(Hint hint);
    // Shows the warnings of loading, and writes them to `err`.
    void sayWarnings();
    // Lights or materials differ from the file.
    bool edited() const {
        return settings.lights != fileSettings.lights || settings.edits != fileSettings.edits;
    }
    // Bookmarks, lights or materials are neither in the file nor written or copied.
    bool unsaved() const {
        return !bookmarks.empty() ||
               (edited() && (settings.lights != written.lights || settings.edits != written.edits));
    }
    // False, after a message, the first time that a command would lose what is unsaved().
    bool mayLeave();
    // True, after a message, if the file exists and is not to be replaced.
    bool keeps(const std::filesystem::path& existing);
    // The reason why a comparison cannot be shown yet; else empty.
    std::string waitingComparison() const;

    // The file's cameras, then the bookmarks.
    std::vector<const NamedCamera*> cameras() const;
    void goToCamera(size_t index);  // round and round
    // Keeps this camera as a bookmark.
    void keepCamera();

    // The state that undo restores. changed(): it differs from the latest in the history.
    Undoable undoable() const { return {control.camera(), settings, fileSettings}; }
    bool changed() const;
    void restore(const Undoable& state);

    // Forgets what belongs to an earlier view: pick (unless it is pinned), verdict and difference.
    void forgetView(bool evenPinned = false);
};

}  // namespace glint::view
