#include "view/commands.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ostream>
#include <string_view>
#include <utility>

#include "core/content_hash.h"
#include "core/error.h"
#include "core/file_io.h"
#include "core/text_file.h"
#include "import/camera_writer.h"

namespace glint::view {

// ---- the list of keys ----

namespace {

constexpr double kKeyTurn = 0.0873;  // 5 degrees
constexpr double kDollyStep = 0.9;
constexpr double kFovStep = 1.1;

template <bool Model::*kFlag>
void flip(Model& m, Commands&) {
    m.*kFlag = !(m.*kFlag);
}

template <Side kSide>
void viewFrom(Model& m, Commands&) {
    m.control.view(kSide, boundsOf(*m.scene));
}

void turn(Model& m, double x, double y) {
    m.flying ? m.control.look(x, y) : m.control.orbit(x, y);
}

void nextProjection(Model& m, Commands&) {
    m.say("camera: " + m.control.nextProjection());
}

template <int kStep>
void changeLayer(Model& m, Commands&) {
    m.settings.layer = nextOf(m.settings.layer, kStep);
}

template <int kHalfStops>
void expose(Model& m, Commands&) {
    m.display.exposure = std::clamp(m.display.exposure + 0.5 * kHalfStops, -kMostExposure, kMostExposure);
}

void nextToneMap(Model& m, Commands&) {
    m.display.toneMap = nextOf(m.display.toneMap);
    m.say("tone map: " + std::string(nameOf(m.display.toneMap)));
}

void dockPanel(Model& m, Commands&) {
    m.docked = !m.docked || !m.panelVisible;
    m.panelVisible = true;
}

void closeAll(Model& m, Commands&) {
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

void playOrPause(Model& m, Commands&) {
    if (animated(m)) m.timeline.toggle(m.clock.seconds());
}

template <int kFrames>
void step(Model& m, Commands&) {
    if (animated(m)) m.timeline.step(kFrames);
}

void firstFrame(Model& m, Commands&) {
    if (animated(m)) m.timeline.goTo(m.timeline.first());
}

void lastFrame(Model& m, Commands&) {
    if (animated(m)) m.timeline.goTo(m.timeline.last());
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
    {GLFW_KEY_F11, 0, "F11", "full screen, or a window again", call<&Commands::toggleFullscreen>},
    {'Q', kControl, "Ctrl+Q", "quit", call<&Commands::askToClose>},
    {GLFW_KEY_TAB, 0, "Tab", "fly or orbit", flip<&Model::flying>, "camera"},
    {'R', 0, "R", "back to the scene's camera", [](Model& m, Commands&) { m.control.reset(); }},
    {'F', 0, "F", "frame the picked object, or everything", call<&Commands::framePicked>},
    {'P', 0, "P", "next camera: orthographic, oblique", nextProjection},
    {'1', 0, "1", "everything from the front", viewFrom<Side::Front>},
    {'2', 0, "2", "from the right", viewFrom<Side::Right>},
    {'3', 0, "3", "from behind", viewFrom<Side::Back>},
    {'4', 0, "4", "from the left", viewFrom<Side::Left>},
    {'5', 0, "5", "from above", viewFrom<Side::Top>},
    {'6', 0, "6", "from below", viewFrom<Side::Bottom>},
    {'[', 0, "[", "narrower field of view", [](Model& m, Commands&) { m.control.zoom(1 / kFovStep); }},
    {']', 0, "]", "wider field of view", [](Model& m, Commands&) { m.control.zoom(kFovStep); }},
    {GLFW_KEY_LEFT, 0, "Left", "turn, as dragging does", [](Model& m, Commands&) { turn(m, -kKeyTurn, 0); }},
    {GLFW_KEY_RIGHT, 0, "Right", "turn", [](Model& m, Commands&) { turn(m, kKeyTurn, 0); }},
    {GLFW_KEY_UP, 0, "Up", "turn", [](Model& m, Commands&) { turn(m, 0, -kKeyTurn); }},
    {GLFW_KEY_DOWN, 0, "Down", "turn", [](Model& m, Commands&) { turn(m, 0, kKeyTurn); }},
    {GLFW_KEY_PAGE_UP, 0, "PageUp", "nearer", [](Model& m, Commands&) { m.control.dolly(kDollyStep); }},
    {GLFW_KEY_PAGE_DOWN, 0, "PageDown", "farther",
     [](Model& m, Commands&) { m.control.dolly(1 / kDollyStep); }},
    {'M', 0, "M", "keep this camera as a bookmark", [](Model& m, Commands&) { m.keepCamera(); }},
    {'N', 0, "N", "go to the next bookmark", [](Model& m, Commands&) { m.goToCamera(m.camera + 1); }},
    {'L', 0, "L", "next layer: color, depth, normal, ...", changeLayer<1>, "image"},
    {'L', kShift, "Shift+L", "previous layer", changeLayer<-1>},
    {'-', 0, "-", "darker by half a stop", expose<-1>},
    {GLFW_KEY_KP_SUBTRACT, 0, "KP-", "darker by half a stop", expose<-1>},
    {'=', 0, "=", "brighter by half a stop", expose<1>},
    {'=', kShift, "+", "the same (also on the keypad)", expose<1>},
    {GLFW_KEY_KP_ADD, 0, "KP+", "the same", expose<1>},
    {'T', 0, "T", "next tone map: linear, reinhard, aces, false color", nextToneMap},
    {'I', 0, "I", "inspect the pixel under the mouse", flip<&Model::inspects>},
    {'K', 0, "K", "keep this image to compare others with", call<&Commands::keepPicture>},
    {'B', 0, "B", "compare with the kept image: wipe, difference, flicker, off",
     call<&Commands::nextComparison>},
    {'V', 0, "V", "verify this view against the reference", call<&Commands::verify>},
    {' ', 0, "Space", "play the animation, or pause it", playOrPause, "animation"},
    {',', 0, ",", "a frame back", step<-1>},
    {'.', 0, ".", "a frame on", step<1>},
    {GLFW_KEY_HOME, 0, "Home", "the animation's first frame", firstFrame},
    {GLFW_KEY_END, 0, "End", "its last frame", lastFrame},
    {'Z', kControl, "Ctrl+Z", "undo the last change of camera, lights, background or materials",
     call<&Commands::undo>, "edits and files"},
    {'Y', kControl, "Ctrl+Y", "redo", call<&Commands::redo>},
    {'C', 0, "C", "print and copy camera, changed lights and changed materials as JSON",
     call<&Commands::copyJson>},
    {'S', 0, "S", "save the image as shown, as PNG (flying: Ctrl+S)", call<&Commands::savePng>},
    {'S', kControl, "Ctrl+S", "the same", call<&Commands::savePng>},
    {'S', kShift, "Shift+S", "save the image as EXR, with every layer", call<&Commands::saveExr>},
    {'S', kAlt, "Alt+S", "render at the scene's own sampling, to PNG", call<&Commands::renderPng>},
    {'S', kAlt | kShift, "Alt+Shift+S", "the same, to EXR with every layer", call<&Commands::renderExr>},
    {'S', kControl | kShift, "Ctrl+Shift+S", "save under a name of your choice", flip<&Model::saveAsVisible>},
    {'O', kControl, "Ctrl+O", "open a scene, or an image to compare with", flip<&Model::openVisible>},
    {GLFW_KEY_F5, 0, "F5", "load the scene's files again now", call<&Commands::reload>},
};

}  // namespace

std::span<const KeyBinding> keyBindings() {
    return kBindings;
}

bool isFlyKey(int key) {
    return std::string_view("WASDQE").find(static_cast<char>(key)) != std::string_view::npos && key < 128;
}

const KeyBinding* bindingOf(int key, int mods, bool flying) {
    if (flying && isFlyKey(key) && (mods & (kControl | kAlt)) == 0) return nullptr;
    const auto found = std::find_if(std::begin(kBindings), std::end(kBindings), [&](const KeyBinding& b) {
        return b.run != nullptr && b.key == key && b.mods == (mods & (kShift | kControl | kAlt));
    });
    return found == std::end(kBindings) ? nullptr : found;
}

// ---- any command ----

Commands::Commands(Model& model, Window& window, std::ostream& out, std::ostream& err)
    : m_(model),
      window_(window),
      out_(out),
      err_(err),
      editsAtWork_(model.settings.edits),
      timeAtWork_(model.time) {
    files_.watch(sceneFiles(m_.path, *m_.file));
}

void Commands::fail(const std::string& what) {
    lastError_ = what;
    m_.say(what, ToastKind::Error);
    err_ << "glint: " << what << '\n';
}

void Commands::report(const std::string& line) {
    m_.say(line);
    out_ << line << std::endl;
}

void Commands::perform(Command command) {
    m_.dirty = 3;
    command(m_, *this);
    takeSettings();
}

void Commands::follow(Hint hint) {
    if (m_.hints.done(hint)) m_.say("That is all it takes. F1 lists every key.");
}

// After all events of a round.
void Commands::noteChanges() {
    if (!m_.changed()) return;
    const bool moved = m_.control.camera() != m_.history.seen().camera;
    m_.history.note(m_.undoable(), m_.clock.seconds());
    if (!moved) return;
    follow(Hint::Turn);
    m_.forgetView();
    m_.touch();
}

void Commands::takeSettings() {
    if (m_.settings == m_.session->settings()) return;
    m_.session->apply(m_.settings);
    if (!m_.session->ready()) {
        m_.touch();
        m_.forgetView(true);
    }
    m_.dirty = 3;
}

void Commands::askToClose() {
    if (!m_.saving.running() || m_.isClosing) {
        closing_ = true;
        return;
    }
    m_.isClosing = true;
    m_.say("closing once the image is saved; again: at once");
}

// ---- camera ----

void Commands::travel(const Undoable* state, const char* otherwise) {
    state != nullptr ? m_.restore(*state) : m_.say(otherwise);
}

void Commands::framePicked() {
    const Ball ball = m_.pick && m_.pick->hit() ? boundsOf(*m_.scene, m_.pick->data.object,
                                                           m_.pick->data.position, m_.pick->data.depth)
                                                : boundsOf(*m_.scene);
    m_.control.frame(ball);
}

void Commands::pick(int x, int y) {
    if (!m_.session->contains(x, y)) return;
    m_.pick = pickPixel(*m_.session, x, y);
    m_.pickIsOld = false;
    if (m_.pick->hit()) m_.material = m_.pick->data.material;
    follow(Hint::Pick);
    out_ << pickCsv(*m_.pick) << std::flush;
}

void Commands::focusAt(int x, int y) {
    if (!m_.session->contains(x, y)) return;
    const PixelData data = m_.session->pixel(x, y);
    const Camera& camera = m_.control.camera();
    const bool hit = data.object != PixelData::kNoIndex;
    if (!hit || camera.projection != Projection::Perspective || !m_.control.focusAt(data.position)) {
        m_.say(hit ? "parallel rays have no focus" : "nothing there to focus on", ToastKind::Error);
        return;
    }
    char text[96];
    std::snprintf(text, sizeof(text), "focus distance %.6g%s", camera.focusDistance,
                  camera.lensRadius > 0 ? "" : "; give the lens a radius to see it");
    m_.say(text);
    m_.history.endStep();
    m_.touch();
}

// ---- text of scenes ----

void Commands::copyJson() {
    std::string json = cameraJson(m_.control.camera());
    std::string what = "camera";
    for (const auto& [name, value] : changedMembers(m_.settings, m_.fileSettings)) {
        json += ",\n\"" + name + "\": " + value;
        what += ", changed " + name;
    }
    out_ << json << std::endl;
    window_.setClipboard(json);
    m_.say("copied as scene JSON: " + what);
}

// Throws Error(Failed) if another program has changed the scene's file since it was read.
void Commands::checkUnchanged(const std::string& text) const {
    const uint64_t hash = contentHash(text);
    const std::vector<SourceFile>& read = m_.file->sources;
    if (std::none_of(read.begin(), read.end(), [&](const SourceFile& s) { return s.hash == hash; }))
        throw Error(ErrorKind::Failed,
                    m_.scene->path.string() +
                        " has changed since it was read; nothing written. It is loaded again: "
                        "look, and try once more");
}

void Commands::writeCameras() {
    const std::filesystem::path& path = m_.scene->path;
    try {
        for (const NamedCamera& bookmark : m_.bookmarks)
            if (bookmark.name.empty()) throw Error(ErrorKind::Argument, "give each bookmark a name");
        const std::string text = readWholeFile(path);
        checkUnchanged(text);
        writeTextFile(path, withCameras(text, path.string(), m_.bookmarks));
        const std::string line = "wrote " + counted(m_.bookmarks.size(), "camera") + " to " + path.string();
        m_.bookmarks.clear();
        report(line);
        reload();
    } catch (const Error& e) {
        fail(e.what());
    }
}

// Lights and materials into a copy of the scene's file, beside it unless the user gives another folder.
void Commands::writeScene() {
    const std::filesystem::path target = m_.scene->path.parent_path() / m_.sceneName;
    try {
        if (std::filesystem::exists(target) && !m_.replacesFile)
            throw Error(ErrorKind::Argument,
                        target.string() + " exists: choose another name, or \"replace the file\"");
        const std::string text = readWholeFile(m_.scene->path);
        checkUnchanged(text);
        writeTextFile(target, editedSceneText(text, m_.settings, m_.fileSettings));
        m_.saveSceneVisible = m_.replacesFile = false;
        report("wrote lights and materials to " + target.string());
    } catch (const std::exception& e) {
        fail(e.what());
    }
}

}  // namespace glint::view
