// Every key and mouse gesture, once: the window obeys this list, shows it (F1), and a test holds
// docs/guide/window.md to it.
#pragma once

#include <optional>
#include <span>

namespace glint::view {

enum class Action {
    Help,
    Close,
    Quit,
    HidePanel,
    DockPanel,
    NextLayer,
    PreviousLayer,
    ExposureDown,
    ExposureUp,
    ToggleFly,
    Projection,
    Reset,
    FramePicked,
    ViewFront,
    ViewRight,
    ViewBack,
    ViewLeft,
    ViewTop,
    ViewBottom,
    NarrowView,
    WidenView,
    TurnLeft,
    TurnRight,
    TurnUp,
    TurnDown,
    Nearer,
    Farther,
    Undo,
    Redo,
    PlayPause,
    FrameBack,
    FrameOn,
    FirstFrame,
    LastFrame,
    Bookmark,
    NextBookmark,
    ToneMapping,
    Inspect,
    Keep,
    CompareMode,
    PrintCamera,
    Verify,
    SavePng,
    SaveExr,
    RenderPng,
    RenderExr,
    SaveAs,
    Open,
    Fullscreen,
    Reload
};

struct KeyBinding {
    Action action;
    int key;
    int mods;
    const char* name;  // "Shift+S"
    const char* help;
};

struct MouseHelp {
    const char* gesture;
    const char* help;
};

std::span<const KeyBinding> keyBindings();
std::span<const MouseHelp> mouseHelp();

// While flying, the keys that move have no other meaning.
bool isFlyKey(int key);

std::optional<Action> actionOf(int key, int mods, bool flying);

}  // namespace glint::view
