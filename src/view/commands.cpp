#include "view/commands.h"

#include <imgui.h>

#include <algorithm>
#include <ostream>
#include <string_view>

#include "core/content_hash.h"
#include "core/error.h"
#include "core/file_io.h"
#include "core/format.h"
#include "core/text_file.h"
#include "import/camera_writer.h"
#include "trace/ray_batch.h"

namespace glint::view {

void perform(Model& m, Command command) {
    m.redraw();
    command(m);
    takeSettings(m);
}

// After all events of a round.
void noteChanges(Model& m) {
    if (!m.changed()) return;
    m.warned = false;
    const bool moved = m.control.camera() != m.history.seen().camera;
    m.history.note(m.undoable());
    if (!moved) return;
    m.follow(Hint::Turn);
    m.forgetView();
    m.touch();
}

void takeSettings(Model& m) {
    if (m.settings == m.session->settings()) return;
    m.session->apply(m.settings);
    if (!m.session->ready()) {
        m.touch();
        m.forgetView(true);
    }
    m.redraw();
}

void askToClose(Model& m) {
    if (!m.mayLeave()) return;
    if (!m.saving.running() || m.isClosing) {
        m.closes = true;
        return;
    }
    m.isClosing = true;
    m.say("closing once the image is saved; again: at once");
}

// ---- camera ----

void pick(Model& m, int x, int y) {
    if (!m.session->contains(x, y)) return;
    m.pick = pickPixel(*m.session, x, y);
    m.pickIsOld = false;
    if (m.pick->hit()) m.material = m.pick->data.material;
    m.follow(Hint::Pick);
    m.out << kHitCsvHeading + hitCsv(hitOf(m.pick->data), kDeviceDigits) << std::flush;
}

void focusAt(Model& m, int x, int y) {
    if (!m.session->contains(x, y)) return;
    const PixelData data = m.session->pixel(x, y);
    const Camera& camera = m.control.camera();
    const bool hit = data.object != PixelData::kNoIndex;
    if (!hit || camera.projection != Projection::Perspective || !m.control.focusAt(data.position)) {
        m.say(hit ? "parallel rays have no focus" : "nothing there to focus on", ToastKind::Error);
        return;
    }
    m.say(format("focus distance %.6g%s", camera.focusDistance,
                 camera.lensRadius > 0 ? "" : "; give the lens a radius to see it"));
    m.history.endStep();
    m.touch();
}

// ---- text of scenes ----

namespace {

// Text of the scene's file. Throws Error(Failed) if another program has changed it since the scene was read.
std::string unchangedText(const Model& m) {
    std::string text = readWholeFile(m.scene->path);
    const uint64_t hash = contentHash(text);
    const std::vector<SourceFile>& read = m.file->sources;
    if (std::none_of(read.begin(), read.end(), [&](const SourceFile& s) { return s.hash == hash; }))
        throw Error(ErrorKind::Failed,
                    m.scene->path.string() +
                        " has changed since it was read; nothing written. It is loaded again: "
                        "look, and try once more");
    return text;
}

}  // namespace

void writeCameras(Model& m) {
    const std::filesystem::path& path = m.scene->path;
    try {
        for (const NamedCamera& bookmark : m.bookmarks)
            if (bookmark.name.empty()) throw Error(ErrorKind::Argument, "give each bookmark a name");
        writeTextFile(path, withCameras(unchangedText(m), path.string(), m.bookmarks));
        const std::string line = "wrote " + counted(m.bookmarks.size(), "camera") + " to " + path.string();
        m.bookmarks.clear();
        m.report(line);
        reload(m);
    } catch (const Error& e) {
        m.fail(e.what());
    }
}

// Writes lights and materials into a copy of the scene's file, in the same folder unless the user gives
// another.
void writeScene(Model& m) {
    const std::filesystem::path target = m.scene->path.parent_path() / m.sceneName;
    if (m.keeps(target)) return;
    try {
        writeTextFile(target, editedSceneText(unchangedText(m), m.settings, m.fileSettings));
        m.saveSceneVisible = false;
        m.written = m.settings;
        m.report("wrote lights and materials to " + target.string());
    } catch (const std::exception& e) {
        m.fail(e.what());
    }
}

// ---- the list of keys ----

namespace {

constexpr double kKeyTurn = 0.0873;  // 5 degrees
constexpr double kDollyStep = 0.9;
constexpr double kFovStep = 1.1;

template <bool Model::*kFlag>
void flip(Model& m) {
    m.*kFlag = !(m.*kFlag);
}

template <Side kSide>
void viewFrom(Model& m) {
    m.control.view(kSide, boundsOf(*m.scene));
}

template <int kRight, int kDown>
void turn(Model& m) {
    const double x = kKeyTurn * kRight, y = kKeyTurn * kDown;
    m.flying ? m.control.look(x, y) : m.control.orbit(x, y);
}

template <int kStep>
void changeLayer(Model& m) {
    m.settings.layer = nextOf(m.settings.layer, kStep);
}

template <int kHalfStops>
void expose(Model& m) {
    m.display.exposure = std::clamp(m.display.exposure + 0.5 * kHalfStops, -kMostExposure, kMostExposure);
}

void nextToneMap(Model& m) {
    m.display.toneMap = nextOf(m.display.toneMap);
    m.say("tone map: " + std::string(nameOf(m.display.toneMap)));
}

void dockPanel(Model& m) {
    m.docked = !m.docked || !m.panelVisible;
    m.panelVisible = true;
}

void closeAll(Model& m) {
    m.helpVisible = m.saveAsVisible = m.saveSceneVisible = m.openVisible = false;
    m.sceneError.clear();
    m.warnings.clear();
    m.toasts.clear();
    m.comparison.mode = CompareMode::Off;
    m.forgetView(true);
}

bool animated(Model& m) {
    if (!m.timeline.any()) m.say("this scene has no animation");
    return m.timeline.any();
}

void playOrPause(Model& m) {
    if (animated(m)) m.timeline.toggle(m.clock.seconds());
}

template <void (Timeline::*kMove)(int), int kFrames>
void animate(Model& m) {
    if (animated(m)) (m.timeline.*kMove)(kFrames);
}

// Under the next free name.
template <bool kExr, bool kSeen>
void saveNext(Model& m) {
    if (saves(m)) return;
    try {
        save(m, claimName(".", m.scene->path.stem().string(), kExr ? ".exr" : ".png"), kSeen);
    } catch (const Error& e) {
        m.fail(e.what());
    }
}

void travel(Model& m, const Undoable* state, const char* otherwise) {
    state != nullptr ? m.restore(*state) : m.say(otherwise);
}

void framePicked(Model& m) {
    const Ball ball = m.pick && m.pick->hit()
                          ? boundsOf(*m.scene, m.pick->data.object, m.pick->data.position, m.pick->data.depth)
                          : boundsOf(*m.scene);
    m.control.frame(ball);
}

void copyJson(Model& m) {
    std::string json = "\"camera\": " + cameraText(m.control.camera());
    std::string what = "camera";
    for (const auto& [name, value] : changedMembers(m.settings, m.fileSettings)) {
        json += ",\n\"" + name + "\": " + value;
        what += ", changed " + name;
    }
    m.out << json << std::endl;
    ImGui::SetClipboardText(json.c_str());
    m.written = m.settings;
    m.say("copied as scene JSON: " + what);
}

constexpr KeyBinding kBindings[] = {
    {0, 0, "click", "pick: object, material and the tree of rays of the pixel", nullptr, "mouse"},
    {0, 0, "Ctrl+click", "focus the lens there", nullptr},
    {0, 0, "drag", "orbit around the target (flying: look around)", nullptr},
    {0, 0, "Shift+drag", "pan (also the middle button)", nullptr},
    {0, 0, "right drag", "dolly", nullptr},
    {0, 0, "drop a file", "open a scene, or compare with an image", nullptr},
    {0, 0, "wheel", "dolly", nullptr},
    {0, 0, "W A S D", "flying: forward, left, back, right", nullptr},
    {0, 0, "Q E", "flying: down, up; Shift is faster", nullptr},
    {GLFW_KEY_F1, 0, "F1", "show or hide this list (also ?)", flip<&Model::helpVisible>, "window"},
    {'H', 0, "H", "hide or show the panel", flip<&Model::panelVisible>},
    {'H', kShift, "Shift+H", "the panel beside the image, or over it", dockPanel},
    {GLFW_KEY_ESCAPE, 0, "Esc", "close lists, messages, pick and comparison", closeAll},
    {GLFW_KEY_F11, 0, "F11", "full screen, or a window again",
     [](Model& m) { m.window->toggleFullscreen(); }},
    {'Q', kControl, "Ctrl+Q", "quit", askToClose},
    {GLFW_KEY_TAB, 0, "Tab", "fly or orbit", flip<&Model::flying>, "camera"},
    {'R', 0, "R", "back to the scene's camera", [](Model& m) { m.control.reset(); }},
    {'F', 0, "F", "frame the picked object, or everything", framePicked},
    {'P', 0, "P", "next camera: orthographic, oblique",
     [](Model& m) { m.say("camera: " + m.control.nextProjection()); }},
    {'1', 0, "1", "everything from the front", viewFrom<Side::Front>},
    {'2', 0, "2", "from the right", viewFrom<Side::Right>},
    {'3', 0, "3", "from behind", viewFrom<Side::Back>},
    {'4', 0, "4", "from the left", viewFrom<Side::Left>},
    {'5', 0, "5", "from above", viewFrom<Side::Top>},
    {'6', 0, "6", "from below", viewFrom<Side::Bottom>},
    {'[', 0, "[", "narrower field of view", [](Model& m) { m.control.zoom(1 / kFovStep); }},
    {']', 0, "]", "wider field of view", [](Model& m) { m.control.zoom(kFovStep); }},
    {GLFW_KEY_LEFT, 0, "Left", "turn, as dragging does", turn<-1, 0>},
    {GLFW_KEY_RIGHT, 0, "Right", "turn", turn<1, 0>},
    {GLFW_KEY_UP, 0, "Up", "turn", turn<0, -1>},
    {GLFW_KEY_DOWN, 0, "Down", "turn", turn<0, 1>},
    {GLFW_KEY_PAGE_UP, 0, "PageUp", "nearer", [](Model& m) { m.control.dolly(kDollyStep); }},
    {GLFW_KEY_PAGE_DOWN, 0, "PageDown", "farther", [](Model& m) { m.control.dolly(1 / kDollyStep); }},
    {'M', 0, "M", "keep this camera as a bookmark", [](Model& m) { m.keepCamera(); }},
    {'N', 0, "N", "go to the next bookmark", [](Model& m) { m.goToCamera(m.camera + 1); }},
    {'L', 0, "L", "next layer: color, depth, normal, ...", changeLayer<1>, "image"},
    {'L', kShift, "Shift+L", "previous layer", changeLayer<-1>},
    {'-', 0, "-", "darker by half a stop", expose<-1>},
    {GLFW_KEY_KP_SUBTRACT, 0, "KP-", "darker by half a stop", expose<-1>},
    {'=', 0, "=", "brighter by half a stop", expose<1>},
    {'=', kShift, "+", "the same (also on the keypad)", expose<1>},
    {GLFW_KEY_KP_ADD, 0, "KP+", "the same", expose<1>},
    {'T', 0, "T", "next tone map: linear, reinhard, aces, false color", nextToneMap},
    {'I', 0, "I", "inspect the pixel under the mouse", flip<&Model::inspects>},
    {'K', 0, "K", "keep this image to compare others with", keepImage},
    {'B', 0, "B", "compare with the kept image: wipe, difference, flicker, off", nextComparison},
    {'V', 0, "V", "verify this view against the reference", verify},
    {' ', 0, "Space", "play the animation, or pause it", playOrPause, "animation"},
    {',', 0, ",", "a frame back", animate<&Timeline::step, -1>},
    {'.', 0, ".", "a frame on", animate<&Timeline::step, 1>},
    {GLFW_KEY_HOME, 0, "Home", "the animation's first frame", animate<&Timeline::goTo, 0>},
    {GLFW_KEY_END, 0, "End", "its last frame", animate<&Timeline::goTo, Timeline::kMostFrames>},
    {'Z', kControl, "Ctrl+Z", "undo the last change of camera, lights, background or materials",
     [](Model& m) { travel(m, m.history.undo(), "nothing to undo"); }, "edits and files"},
    {'Y', kControl, "Ctrl+Y", "redo", [](Model& m) { travel(m, m.history.redo(), "nothing to redo"); }},
    {'C', 0, "C", "print and copy camera, changed lights and changed materials as JSON", copyJson},
    {'S', 0, "S", "save the image as shown, as PNG (flying: Ctrl+S)", saveNext<false, true>},
    {'S', kControl, "Ctrl+S", "the same", saveNext<false, true>},
    {'S', kShift, "Shift+S", "save the image as EXR, with every layer", saveNext<true, true>},
    {'S', kAlt, "Alt+S", "render at the scene's own sampling, to PNG", saveNext<false, false>},
    {'S', kAlt | kShift, "Alt+Shift+S", "the same, to EXR with every layer", saveNext<true, false>},
    {'S', kControl | kShift, "Ctrl+Shift+S", "save under a name of your choice", flip<&Model::saveAsVisible>},
    {'O', kControl, "Ctrl+O", "open a scene, or an image to compare with", flip<&Model::openVisible>},
    {GLFW_KEY_F5, 0, "F5", "load the scene's files again now", reload},
};

}  // namespace

std::span<const KeyBinding> keyBindings() {
    return kBindings;
}

bool isFlyKey(int key, int mods) {
    return key < 128 && std::string_view("WASDQE").find(static_cast<char>(key)) != std::string_view::npos &&
           (mods & (kControl | kAlt)) == 0;
}

const KeyBinding* bindingOf(int key, int mods) {
    const auto found = std::find_if(std::begin(kBindings), std::end(kBindings), [&](const KeyBinding& b) {
        return b.run != nullptr && b.key == key && b.mods == (mods & (kShift | kControl | kAlt));
    });
    return found == std::end(kBindings) ? nullptr : found;
}

}  // namespace glint::view
