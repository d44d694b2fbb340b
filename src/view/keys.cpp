#include "view/keys.h"

#include <string_view>

namespace glint::view {

namespace {

constexpr KeyBinding kBindings[] = {
    {Action::Help, key::kF1, 0, "F1", "show or hide this list (also ?)", "window"},
    {Action::HidePanel, 'H', 0, "H", "hide or show the panel"},
    {Action::DockPanel, 'H', kShift, "Shift+H", "the panel beside the image, or over it"},
    {Action::Close, key::kEscape, 0, "Esc", "close lists, messages, pick and comparison"},
    {Action::Fullscreen, key::kF11, 0, "F11", "full screen, or a window again"},
    {Action::Quit, 'Q', kControl, "Ctrl+Q", "quit"},
    {Action::ToggleFly, key::kTab, 0, "Tab", "fly or orbit", "camera"},
    {Action::Reset, 'R', 0, "R", "back to the scene's camera"},
    {Action::FramePicked, 'F', 0, "F", "frame the picked object, or everything"},
    {Action::Projection, 'P', 0, "P", "next camera: orthographic, oblique"},
    {Action::ViewFront, '1', 0, "1", "everything from the front"},
    {Action::ViewRight, '2', 0, "2", "from the right"},
    {Action::ViewBack, '3', 0, "3", "from behind"},
    {Action::ViewLeft, '4', 0, "4", "from the left"},
    {Action::ViewTop, '5', 0, "5", "from above"},
    {Action::ViewBottom, '6', 0, "6", "from below"},
    {Action::NarrowView, '[', 0, "[", "narrower field of view"},
    {Action::WidenView, ']', 0, "]", "wider field of view"},
    {Action::TurnLeft, key::kLeft, 0, "Left", "turn, as dragging does"},
    {Action::TurnRight, key::kRight, 0, "Right", "turn"},
    {Action::TurnUp, key::kUp, 0, "Up", "turn"},
    {Action::TurnDown, key::kDown, 0, "Down", "turn"},
    {Action::Nearer, key::kPageUp, 0, "PageUp", "nearer"},
    {Action::Farther, key::kPageDown, 0, "PageDown", "farther"},
    {Action::Bookmark, 'M', 0, "M", "keep this camera as a bookmark"},
    {Action::NextBookmark, 'N', 0, "N", "go to the next bookmark"},
    {Action::NextLayer, 'L', 0, "L", "next layer: color, depth, normal, ...", "image"},
    {Action::PreviousLayer, 'L', kShift, "Shift+L", "previous layer"},
    {Action::ExposureDown, '-', 0, "-", "darker by half a stop"},
    {Action::ExposureDown, key::kKeypadSubtract, 0, "KP-", "darker by half a stop"},
    {Action::ExposureUp, '=', 0, "=", "brighter by half a stop"},
    {Action::ExposureUp, '=', kShift, "+", "the same (also on the keypad)"},
    {Action::ExposureUp, key::kKeypadAdd, 0, "KP+", "the same"},
    {Action::ToneMapping, 'T', 0, "T", "next tone map: linear, reinhard, aces, false color"},
    {Action::Inspect, 'I', 0, "I", "inspect the pixel under the mouse"},
    {Action::Keep, 'K', 0, "K", "keep this image to compare others with"},
    {Action::CompareMode, 'B', 0, "B", "compare with the kept image: wipe, difference, flicker, off"},
    {Action::Verify, 'V', 0, "V", "verify this view against the reference"},
    {Action::PlayPause, ' ', 0, "Space", "play the animation, or pause it", "animation"},
    {Action::FrameBack, ',', 0, ",", "a frame back"},
    {Action::FrameOn, '.', 0, ".", "a frame on"},
    {Action::FirstFrame, key::kHome, 0, "Home", "the animation's first frame"},
    {Action::LastFrame, key::kEnd, 0, "End", "its last frame"},
    {Action::Undo, 'Z', kControl, "Ctrl+Z", "undo the last change of camera, lights, background or materials",
     "edits and files"},
    {Action::Redo, 'Y', kControl, "Ctrl+Y", "redo"},
    {Action::PrintCamera, 'C', 0, "C", "print and copy camera, changed lights and changed materials as JSON"},
    {Action::SavePng, 'S', 0, "S", "save the image as shown, as PNG (flying: Ctrl+S)"},
    {Action::SavePng, 'S', kControl, "Ctrl+S", "the same"},
    {Action::SaveExr, 'S', kShift, "Shift+S", "save the image as EXR, with every layer"},
    {Action::RenderPng, 'S', kAlt, "Alt+S", "render at the scene's own sampling, to PNG"},
    {Action::RenderExr, 'S', kAlt | kShift, "Alt+Shift+S", "the same, to EXR with every layer"},
    {Action::SaveAs, 'S', kControl | kShift, "Ctrl+Shift+S", "save under a name of your choice"},
    {Action::Open, 'O', kControl, "Ctrl+O", "open a scene, or an image to compare with"},
    {Action::Reload, key::kF5, 0, "F5", "load the scene's files again now"},
};

constexpr MouseHelp kMouse[] = {
    {"click", "pick: object, material and the tree of rays of the pixel"},
    {"Ctrl+click", "focus the lens there"},
    {"drag", "orbit around the target (flying: look around)"},
    {"Shift+drag", "pan (also the middle button)"},
    {"right drag", "dolly"},
    {"drop a file", "open a scene, or compare with an image"},
    {"wheel", "dolly"},
    {"W A S D", "flying: forward, left, back, right"},
    {"Q E", "flying: down, up; Shift is faster"},
};

}  // namespace

std::span<const KeyBinding> keyBindings() {
    return kBindings;
}
std::span<const MouseHelp> mouseHelp() {
    return kMouse;
}

bool isFlyKey(int key) {
    return std::string_view("WASDQE").find(static_cast<char>(key)) != std::string_view::npos && key < 128;
}

std::optional<Action> actionOf(int key, int mods, bool flying) {
    if (flying && isFlyKey(key) && (mods & (kControl | kAlt)) == 0) return std::nullopt;
    for (const KeyBinding& b : kBindings) {
        if (b.key == key && b.mods == (mods & (kShift | kControl | kAlt))) return b.action;
    }
    return std::nullopt;
}

}  // namespace glint::view
