// The commands of the window, by key, button, mouse or dropped file. They need a device, but no window.
#pragma once

#include <functional>
#include <iosfwd>
#include <memory>
#include <string>
#include <vector>

#include "view/jobs.h"
#include "view/keys.h"
#include "view/model.h"

namespace glint::view {

// Services of the window for commands.
struct Host {
    std::ostream& out;  // results: CSV of a pick, JSON, names of files
    std::ostream& err;  // errors of files and jobs
    std::function<void(const std::string&)> copy = [](const std::string&) {};      // to the clipboard
    std::function<void(const std::string&)> setTitle = [](const std::string&) {};  // of the window
    std::function<void()> toggleFullscreen = [] {};
    std::function<void()> wake = [] {};  // a job has ended; from any thread
};

class Commands {
  public:
    Commands(Model& model, Host host);

    // Shows the scene on this device. Jobs on an earlier device are stopped.
    void setDevice(const gpu::Device& device);
    void releaseDevice();

    void perform(Action action);
    // Opens a scene, or compares with an image.
    void drop(const std::vector<std::string>& files);
    // Pixels of the image; outside of it nothing happens.
    void pick(int x, int y);
    void focusAt(int x, int y);

    // Takes what the panel or a script changed in Model::settings.
    void takeSettings();
    // Records changes for undo, and forgets what belongs to the view before.
    void noteChanges();
    // Takes results of jobs, looks at the scene's files, advances the animation.
    void poll();
    // The image with comparison or verification, in Model::picture.
    const Canvas& refreshPicture();

    bool hasJobs() const;
    // No job is running, and all edits are packed and shown.
    bool settled() const;
    void follow(Hint hint);
    // Closes after the save at hand; at once if asked twice.
    void askToClose();
    bool closing() const { return closing_; }
    // Stops all jobs. Throws Error(Failed) if an image was not saved that the user waited for.
    void close();

    uint64_t reloads() const { return reloads_; }
    const std::string& lastError() const { return lastError_; }
    // The other image of a flicker is shown.
    bool flash() const;
    bool flashChanged() const;
    void save(const std::filesystem::path& file, bool seen);

  private:
    struct Loaded {
        std::shared_ptr<Moments> moments;
        Moment shown;
    };
    void performTime(Action action);
    void performOther(Action action);
    void fail(const std::string& what);

    void travel(const std::optional<Undoable>& state, const char* otherwise);
    void framePicked();
    void copyJson();
    void keepCamera();
    void goToCamera(size_t index);
    void writeCameras();
    void writeScene();
    void checkUnchanged(const std::string& text) const;

    void showScene(std::shared_ptr<const ViewScene> scene);
    void startLoading();
    void open(const std::filesystem::path& scene);
    void useScene(Loaded loaded);
    void takeMoment(Moment moment);
    void pollLoading();
    void pollPacking();
    std::string momentText() const;

    void saveNumbered(Action action);
    void saveNamed();
    void startVerifying();
    void startReference();
    void keepPicture();
    void nextComparison();
    void compareWith(const std::filesystem::path& image);
    void takeVerdict(VerifyResult result);

    Model& m_;
    Host host_;
    const gpu::Device* device_ = nullptr;
    Job<std::string> saving_{host_.wake};
    Job<VerifyResult> verifying_{host_.wake};
    Job<Image> referring_{host_.wake};
    Job<Loaded> loading_{host_.wake};
    Job<Moment> packing_{host_.wake};
    SceneEdits editsAtWork_;            // of packing_, or of the scene that is shown
    std::optional<double> timeAtWork_;  // likewise
    FileWatch files_;
    Stopwatch fileWatch_;
    bool opensAnother_ = false, closing_ = false;
    uint64_t reloads_ = 0;
    std::string lastError_, lostPicture_;

    // The state that Model::picture shows.
    struct Shown {
        uint64_t version = ~uint64_t{0};
        Display display;
        bool difference = false, flash = false;
        CompareMode mode = CompareMode::Off;
        double wipe = 0, gain = 0;
        uint64_t compared = 0;
        bool operator==(const Shown&) const = default;
    } shown_;
    uint64_t measured_ = ~uint64_t{0};
};

}  // namespace glint::view
