// Events of the window system, and the list of all keys and gestures: the window obeys it, F1 shows it, and a
// test holds docs/guide/window.md to it.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace glint::view {

// Keys with a printed sign are that sign in upper case ('A', '1', '['); the others have the numbers that GLFW
// gives them.
namespace key {
inline constexpr int kEscape = 256, kEnter = 257, kTab = 258, kBackspace = 259, kDelete = 261;
inline constexpr int kRight = 262, kLeft = 263, kDown = 264, kUp = 265, kPageUp = 266, kPageDown = 267;
inline constexpr int kHome = 268, kEnd = 269, kF1 = 290, kF5 = 294, kF11 = 300;
inline constexpr int kKeypadSubtract = 333, kKeypadAdd = 334, kKeypadEnter = 335;
inline constexpr int kLeftShift = 340, kLeftControl = 341, kLeftAlt = 342;
inline constexpr int kRightShift = 344, kRightControl = 345, kRightAlt = 346, kCount = 350;
}  // namespace key

inline constexpr int kShift = 1, kControl = 2, kAlt = 4;  // bits of Event::mods, as in GLFW

enum class Button { Left = 0, Right = 1, Middle = 2 };

struct Event {
    enum class Type { Cursor, Button, Wheel, Key, Text, Drop, Resize, Redraw, Close };
    Type type = Type::Redraw;
    double x = 0, y = 0;                  // Cursor: pixels of the window's picture; Wheel: steps
    int code = 0;                         // Button; Key; Text: a Unicode code point
    int mods = 0;                         // of Button and Key
    bool down = false;                    // of Button and Key
    bool repeat = false;                  // of Key: held down
    std::vector<std::string> files = {};  // of Drop
};

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
    SaveNamed,  // from here on some have no key
    SaveScene,
    WriteScene,
    Open,
    OpenNamed,
    TraceReference,
    GoToCamera,
    WriteCameras,
    FocusPicked,
    Fullscreen,
    Reload
};

struct KeyBinding {
    Action action;
    int key;
    int mods;
    const char* name;  // "Shift+S"
    const char* help;
    const char* heading = nullptr;  // of the group of keys that starts here
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
