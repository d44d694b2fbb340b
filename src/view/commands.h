// The commands of the window, by key, button, mouse or dropped file, and the list of all keys and gestures.
// The window uses the list, F1 shows it, and a test compares it with docs/guide/window.md.
#pragma once

#include <filesystem>
#include <span>

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
bool isFlyKey(int key, int mods);

// Null for a key without a command.
const KeyBinding* bindingOf(int key, int mods);

void perform(Model& m, Command command);

// ---- commands ----

// Pixels of the image; ignored outside of it.
void pick(Model& m, int x, int y);
void focusAt(Model& m, int x, int y);
// Opens a scene, or compares with an image.
void open(Model& m, const std::filesystem::path& file);
void reload(Model& m);
void writeCameras(Model& m);
void writeScene(Model& m);
// With the scene's own sampling, or if `seen` with that of the display.
void save(Model& m, const std::filesystem::path& file, bool seen);
void saveNamed(Model& m);  // under the name of the dialog
bool saves(Model& m);      // true, after a message, while an image is being saved
void keepImage(Model& m);
void nextComparison(Model& m);
void verify(Model& m);
void traceReference(Model& m);
// Closes after the current save; the second time at once.
void askToClose(Model& m);

// ---- the loop ----

// Shows the scene on this device. Jobs on an earlier device are stopped.
void setDevice(Model& m, const gpu::Device& device);
void releaseDevice(Model& m);
// Takes changes of Model::settings by the panel or a script.
void takeSettings(Model& m);
// Records changes for undo, and forgets what belongs to the view before.
void noteChanges(Model& m);
// Takes results of jobs, looks at the scene's files, advances the animation.
void poll(Model& m);
// The image with comparison or verification, in Model::picture.
const Canvas& refreshPicture(Model& m);
bool flashChanged(const Model& m);  // the other image of a flicker is due
// No job is running, and all edits are packed and shown.
bool settled(const Model& m);
// Stops all jobs. The reason why an image was not saved that the user waited for; else empty.
std::string close(Model& m);

}  // namespace glint::view
