// The commands of the window, by key, button, mouse or dropped file, and the list of all keys and gestures.
// The window uses the list, F1 shows it, and a test compares it with docs/guide/window.md.
#pragma once

#include <iosfwd>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "view/model.h"
#include "view/window.h"

namespace glint::view {

struct KeyBinding {
    int key;           // GLFW_KEY_*
    int mods;          // GLFW_MOD_*
    const char* name;  // "Shift+S"
    const char* help;
    Command run;                    // null for gestures of the mouse and keys that fly
    const char* heading = nullptr;  // of the group of keys that starts here
};

std::span<const KeyBinding> keyBindings();

inline constexpr int kShift = GLFW_MOD_SHIFT, kControl = GLFW_MOD_CONTROL, kAlt = GLFW_MOD_ALT;

// While flying, the keys that move have no other meaning.
bool isFlyKey(int key);

// Null for a key without a command.
const KeyBinding* bindingOf(int key, int mods, bool flying);

class Commands {
  public:
    // `out`: results (CSV of a pick, JSON, names of files); `err`: errors of files and jobs.
    Commands(Model& model, Window& window, std::ostream& out, std::ostream& err);

    // Shows the scene on this device. Jobs on an earlier device are stopped.
    void setDevice(const gpu::Device& device);
    void releaseDevice();

    void perform(Command command);

    // ---- camera ----
    void undo() { travel(m_.history.undo(), "nothing to undo"); }
    void redo() { travel(m_.history.redo(), "nothing to redo"); }
    void framePicked();
    // Pixels of the image; ignored outside of it.
    void pick(int x, int y);
    void focusAt(int x, int y);

    // ---- files ----
    // Opens a scene, or compares with an image.
    void open(const std::filesystem::path& file);
    void reload();
    void copyJson();
    void writeCameras();
    void writeScene();
    // With the scene's own sampling, or if `seen` as shown.
    void save(const std::filesystem::path& file, bool seen);
    // Under the next free name.
    void savePng() { saveNumbered(".png", true); }
    void saveExr() { saveNumbered(".exr", true); }
    void renderPng() { saveNumbered(".png", false); }
    void renderExr() { saveNumbered(".exr", false); }
    void saveNamed();

    // ---- comparison ----
    void keepPicture();
    void nextComparison();
    void verify();
    void traceReference();

    // ---- window ----
    void toggleFullscreen() { window_.toggleFullscreen(); }
    // Closes after the save at hand; at once if asked twice.
    void askToClose();
    bool closing() const { return closing_; }
    // Stops all jobs. Throws Error(Failed) if an image was not saved that the user waited for.
    void close();

    // ---- each round of the loop ----
    // Takes what the panel or a script changed in Model::settings.
    void takeSettings();
    // Records changes for undo, and forgets what belongs to the view before.
    void noteChanges();
    // Takes results of jobs, looks at the scene's files, advances the animation.
    void poll();
    // The image with comparison or verification, in Model::picture.
    const Canvas& refreshPicture();
    bool flashChanged() const;  // the other image of a flicker is due
    bool hasJobs() const;
    // No job is running, and all edits are packed and shown.
    bool settled() const;

    uint64_t reloads() const { return reloads_; }
    const std::string& lastError() const { return lastError_; }

  private:
    void fail(const std::string& what);
    void report(const std::string& line);  // a message and a line of `out`
    void follow(Hint hint);
    bool saves();  // says so
    void saveNumbered(const char* extension, bool seen);
    void travel(const Undoable* state, const char* otherwise);
    void checkUnchanged(const std::string& text) const;

    void showScene(std::shared_ptr<const ViewScene> scene);
    void useScene(std::shared_ptr<Moments> moments, Moment shown);
    void takeMoment(Moment moment);
    void takeVerdict(const verify::Report& report);
    void watchFiles();
    void pack();
    std::string momentText() const;

    void compareWith(const std::string& name, std::optional<Image> linear, Canvas canvas = {});
    bool flash() const;

    Model& m_;
    Window& window_;
    std::ostream &out_, &err_;
    const gpu::Device* device_ = nullptr;
    SceneEdits editsAtWork_;            // of Model::packing, or of the scene that is shown
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
        uint64_t other = 0;
        bool measured = false;
        bool operator==(const Shown&) const = default;
    } shown_;
    std::pair<uint64_t, uint64_t> measured_;  // version of the image, number of the other image
};

// A function of Commands as a command.
template <void (Commands::*kFunction)()>
void call(Model&, Commands& c) {
    (c.*kFunction)();
}

}  // namespace glint::view
