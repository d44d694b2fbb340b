// The loop behind view.h: events in, a piece of work, a frame out.
#pragma once

#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/stopwatch.h"
#include "gpu/device.h"
#include "gpu/swapchain.h"
#include "view/camera_control.h"
#include "view/gui.h"
#include "view/jobs.h"
#include "view/keys.h"
#include "view/panel.h"
#include "view/scene_files.h"
#include "view/script.h"
#include "view/session.h"
#include "view/view.h"
#include "view/window.h"

namespace glint::view {

class Viewer {
  public:
    Viewer(const Options& options, std::ostream& out, std::ostream& err);
    ~Viewer();
    void run();

  private:
    // viewer.cpp
    void openDevice();
    void recover(const gpu::DeviceLost& lost);
    void round();
    void gatherEvents();
    bool hasWork() const;
    bool inputWaits() const;
    bool work();  // false: there was nothing to trace
    void useScene(std::shared_ptr<const ViewScene> scene);
    void pollJobs();
    void pollFiles();
    void startLoading();
    void drawFrame();
    void fillModel();
    void takeModel();
    void takeSettings();
    const Canvas& background();
    void reportValidation();
    bool moving() const { return motion_.seconds() < kRestSeconds; }
    void touchMotion() { motion_.restart(); }
    void say(const std::string& text);

    // viewer_input.cpp
    void handleEvents();
    bool handle(const Event& event);  // false: the rest waits for the next frame
    void handleButton(const Event& event);
    void handleKey(const Event& event);
    void drag(double dx, double dy);
    void perform(Action action);
    bool performCamera(Action action);
    void flyOn(double seconds);
    void pick(int x, int y);
    void framePicked();
    void printCamera();
    void startSaving(const std::filesystem::path& file);
    void startVerifying();
    void changeLayer(int step);

    // viewer_script.cpp
    void runScript();
    void start(const ScriptCommand& command);
    bool startInput(const ScriptCommand& command);
    bool startExpectation(const ScriptCommand& command);
    void startFile(const ScriptCommand& command);
    void set(const ScriptCommand& command);
    void startPace(int frames);
    void startIdling(double seconds);
    bool scripted() const { return nextCommand_ < script_.size() || scriptWait_; }
    void push(const Event& event) { queue_.push_back(event); }
    void waitFrames(int frames);
    [[noreturn]] static void failScript(const ScriptCommand& command, const std::string& what);
    bool settled() const;

    static constexpr double kRestSeconds = 0.2;  // without motion, after which the picture sharpens

    Options options_;
    std::ostream& out_;
    std::ostream& err_;
    std::shared_ptr<const ViewScene> scene_;
    Window window_;
    // Destroyed from the last to the first.
    std::unique_ptr<gpu::Device> device_;
    std::unique_ptr<gpu::Swapchain> swapchain_;
    std::unique_ptr<Session> session_;
    Job<std::string> saving_;
    Job<VerifyResult> verifying_;
    Job<std::shared_ptr<const ViewScene>> loading_;
    Gui gui_;
    CameraControl control_;
    Pace pace_;
    FileWatch files_;
    PanelModel model_;

    std::deque<Event> queue_;
    std::optional<Button> dragging_;
    bool dragged_ = false;
    int dragMods_ = 0;
    double cursorX_ = 0, cursorY_ = 0, pressX_ = 0, pressY_ = 0;
    std::set<int> held_;
    bool fastFlight_ = false;

    std::optional<Pick> pick_;
    std::optional<Canvas> difference_;  // of the last verify, while it is shown
    std::vector<std::string> validation_;
    Canvas background_, frame_;
    uint64_t shownVersion_ = ~uint64_t{0};
    double shownExposure_ = 0;
    bool showsDifference_ = false;
    std::vector<float> frameTimes_;
    Stopwatch motion_, frameWatch_, roundWatch_, fileWatch_;
    int dirty_ = 3;  // frames to draw even if nothing happens
    bool closing_ = false, wasLost_ = false;
    bool traced_ = false, follows_ = false;  // a new coarse picture in this round; in the one before too
    uint64_t frames_ = 0, reloads_ = 0;

    std::vector<ScriptCommand> script_;
    size_t nextCommand_ = 0;
    std::function<bool()> scriptWait_;  // true: go on
    bool scriptStays_ = false, scriptIdles_ = false;
};

}  // namespace glint::view
