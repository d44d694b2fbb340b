// The loop behind view.h: events in, a piece of work, a frame out.
#pragma once

#include <deque>
#include <glm/vec2.hpp>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/stopwatch.h"
#include "gpu/device.h"
#include "gpu/swapchain.h"
#include "view/camera_control.h"
#include "view/compare.h"
#include "view/gui.h"
#include "view/hints.h"
#include "view/history.h"
#include "view/jobs.h"
#include "view/keys.h"
#include "view/moments.h"
#include "view/panel.h"
#include "view/recent_files.h"
#include "view/scene_files.h"
#include "view/session.h"
#include "view/timeline.h"
#include "view/toasts.h"
#include "view/view.h"
#include "view/window.h"

namespace glint::view {

namespace test {
class Driver;
}

class Viewer {
  public:
    Viewer(const Options& options, std::ostream& out, std::ostream& err);
    ~Viewer();

    // Opens the device; then step() until it returns false; then close(), which throws what the user must
    // know.
    void open();
    bool step();
    void close();

    // Handled in the next step, after the events that came before it.
    void push(const Event& event) { queue_.push_back(event); }
    // Draws a frame in every step, even if nothing has changed.
    void setRestless(bool restless) { restless_ = restless; }

  private:
    friend class test::Driver;  // tests/view, until the model is separate

    // viewer.cpp
    void openDevice();
    void checkRoom(PixelSize size) const;
    void recover(const gpu::DeviceLost& lost);
    void round();
    void gatherEvents();
    bool hasWork() const;
    double restSeconds() const;  // how long nothing will happen by itself
    bool inputWaits() const;
    void showView();
    bool work();  // false: there was nothing to trace
    void drawFrame();
    void reportValidation();
    void askToClose();
    bool covered() const { return gui_.covers(cursorX_ + left_, cursorY_); }  // the mouse, by the panel
    bool flash() const;  // of flicker, whether it is the other picture's turn
    bool moving() const { return motion_.seconds() < kRestSeconds; }
    void touchMotion() { motion_.restart(); }
    void say(const std::string& text, ToastKind kind = ToastKind::Info);

    // viewer_jobs.cpp
    struct Loaded {
        std::shared_ptr<Moments> moments;
        Moment shown;
    };
    void useScene(Loaded loaded);
    void pollJobs();
    void pollLoading();
    void showScene(std::shared_ptr<const ViewScene> scene);
    void pollFiles();
    void startLoading();
    void open(const std::filesystem::path& scene);
    void startSaving(const std::filesystem::path& file, bool seen);
    void saveAs();
    void startVerifying();
    void startReference();
    void keepPicture();
    void compareWith(const std::filesystem::path& picture);
    void drop(const std::vector<std::string>& files);
    const Image* comparable() const;  // the window's linear colours; null: not there

    // viewer_moments.cpp
    void playOn();
    void pollPacking();
    void takeMoment(Moment moment);
    bool performTime(Action action);
    std::string momentText() const;  // how `glint render` is asked for the moment that is shown; may be empty

    // viewer_model.cpp
    void fillModel();
    void fillPixel();
    void fillPick();
    void takeModel();
    void takeSettings();
    void takeCamera();
    void grant(Wish wish);
    const Canvas& background();

    // viewer_input.cpp
    void handleEvents();
    bool handle(const Event& event);  // false: the rest waits for the next frame
    void handleButton(const Event& event);
    void handleKey(const Event& event);
    void drag(double dx, double dy);
    void perform(Action action);
    bool performView(Action action);
    bool performFile(Action action);
    void sayComparison();
    bool performCamera(Action action);
    void flyOn(double seconds);
    void noteCamera();
    void follow(Hint hint);
    void forgetPick(bool evenPinned);
    void travel(const std::optional<Camera>& camera, const char* otherwise);
    void pick(int x, int y);
    void focusAt(int x, int y);
    void framePicked();
    void printCamera();
    void changeLayer(int step);

    // viewer_cameras.cpp
    const std::vector<NamedCamera>& fileCameras() const { return fileScene_->cameras; }
    void keepCamera();
    void goToCamera(size_t index);  // of the file's, then the bookmarks
    void writeCameras();

    static constexpr double kRestSeconds = 0.2;   // without motion, after which the picture sharpens
    static constexpr double kFileSeconds = 0.25;  // between looks at the scene's files

    Options options_;
    std::ostream& out_;
    std::ostream& err_;
    std::shared_ptr<Moments> moments_;
    std::shared_ptr<const Scene> fileScene_;   // of the moment that is shown, without the panel's edits
    std::shared_ptr<const ViewScene> scene_;   // that is shown
    SceneEdits editsAtWork_;                   // of packing_, or of scene_
    std::optional<double> timeAtWork_, time_;  // of packing_, or of scene_; of scene_
    Timeline timeline_;
    Window window_;
    // Destroyed from the last to the first.
    std::unique_ptr<gpu::Device> device_;
    std::unique_ptr<gpu::Swapchain> swapchain_;
    std::unique_ptr<Session> session_;
    Job<std::string> saving_;
    Job<VerifyResult> verifying_;
    Job<Image> referring_;
    Job<Loaded> loading_;
    Job<Moment> packing_;
    Gui gui_;
    CameraControl control_;
    CameraHistory history_;
    std::vector<NamedCamera> bookmarks_;  // not in the file
    Pace pace_;
    FileWatch files_;
    RecentFiles recent_;
    Hints hints_;
    PanelModel model_;
    Toasts toasts_;
    Comparison comparison_;
    Stopwatch clock_;  // of toasts and flicker

    std::deque<Event> queue_;
    std::optional<Button> dragging_;
    bool dragged_ = false, draggingWipe_ = false;
    int dragMods_ = 0;
    int left_ = 0;  // of the picture in the window, see PanelModel
    // In pixels of the picture.
    double cursorX_ = -1, cursorY_ = -1, pressX_ = 0, pressY_ = 0;
    std::set<int> held_;
    bool fastFlight_ = false;
    Camera seenCamera_;         // of the last round
    bool gestureEnded_ = true;  // the next movement is another one to undo
    Stopwatch sinceMove_;

    std::optional<glm::ivec2> inspected_;  // the last pixel under the mouse
    std::optional<Pick> pick_;
    bool pickIsOld_ = false;
    std::optional<Canvas> difference_;  // of the last verify, while it is shown
    std::vector<std::string> validation_;
    Canvas background_, frame_;
    struct Shown {
        uint64_t version = ~uint64_t{0};
        Display display;
        bool difference = false, flash = false;
        CompareMode mode = CompareMode::Off;
        double wipe = 0, gain = 0;
        uint64_t compared = 0;
        bool operator==(const Shown&) const = default;
    } shown_;
    uint64_t compared_ = 0;  // grows with each other picture, and each time that it is measured
    uint64_t measured_ = ~uint64_t{0};
    std::vector<float> frameTimes_;
    Stopwatch motion_, frameWatch_, roundWatch_, fileWatch_;
    int dirty_ = 3;  // frames to draw even if nothing happens
    bool restless_ = false, closing_ = false, closingAsked_ = false, wasLost_ = false, opensAnother_ = false;
    std::string lastSaid_, lostPicture_;
    bool traced_ = false, follows_ = false;  // a new coarse picture in this round; in the one before too
    uint64_t frames_ = 0, reloads_ = 0;
};

}  // namespace glint::view
