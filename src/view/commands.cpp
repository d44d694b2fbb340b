#include "view/commands.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ostream>
#include <utility>

#include "core/content_hash.h"
#include "core/error.h"
#include "core/file_io.h"
#include "core/text_file.h"
#include "import/camera_writer.h"

namespace glint::view {

namespace {

constexpr double kKeyTurn = 0.0873;  // 5 degrees
constexpr double kDollyStep = 0.9;
constexpr double kFovStep = 1.1;

template <NamedEnum E>
E nextOf(E value) {
    return static_cast<E>((static_cast<size_t>(value) + 1) % kEnumNames<E>.size());
}

void toggle(bool& flag) {
    flag = !flag;
}

}  // namespace

Commands::Commands(Model& model, Host host)
    : m_(model), host_(std::move(host)), editsAtWork_(model.edits), timeAtWork_(model.time) {
    files_.watch(sceneFiles(m_.path, *m_.file));
}

void Commands::fail(const std::string& what) {
    lastError_ = what;
    m_.say(what, ToastKind::Error);
    host_.err << "glint: " << what << '\n';
}

void Commands::perform(Action action) {
    m_.dirty = 3;
    if (performCamera(action)) {
        m_.touch();
        return;
    }
    if (performView(action) || performTime(action) || performComparison(action)) return;
    performFile(action);
}

bool Commands::performView(Action action) {
    switch (action) {
        case Action::Help:
            toggle(m_.helpVisible);
            return true;
        case Action::HidePanel:
            toggle(m_.panelVisible);
            return true;
        case Action::DockPanel:
            m_.docked = !m_.docked || !m_.panelVisible;
            m_.panelVisible = true;
            return true;
        case Action::Close:
            m_.helpVisible = m_.saveAsVisible = m_.saveSceneVisible = m_.openVisible = false;
            m_.sceneError.clear();
            m_.toasts.clear();
            m_.comparison.mode = CompareMode::Off;
            m_.forgetView(true);
            return true;
        case Action::NextLayer:
        case Action::PreviousLayer: {
            const int step = action == Action::NextLayer ? 1 : kViewLayers - 1;
            m_.settings.layer =
                static_cast<ViewLayer>((static_cast<int>(m_.settings.layer) + step) % kViewLayers);
            takeSettings();
            return true;
        }
        case Action::ExposureDown:
        case Action::ExposureUp:
            m_.display.exposure =
                steppedExposure(m_.display.exposure, action == Action::ExposureUp ? 0.5 : -0.5);
            return true;
        case Action::ToneMapping:
            m_.display.toneMap = nextOf(m_.display.toneMap);
            m_.say("tone map: " + std::string(nameOf(m_.display.toneMap)));
            return true;
        case Action::Inspect:
            toggle(m_.inspects);
            return true;
        case Action::Fullscreen:
            host_.toggleFullscreen();
            return true;
        case Action::ToggleFly:
            toggle(m_.flying);
            return true;
        case Action::Quit:
            askToClose();
            return true;
        default:
            return false;
    }
}

// ---- camera ----

bool Commands::performCamera(Action action) {
    const auto turn = [&](double x, double y) { m_.flying ? m_.control.look(x, y) : m_.control.orbit(x, y); };
    switch (action) {
        case Action::ViewFront:
        case Action::ViewRight:
        case Action::ViewBack:
        case Action::ViewLeft:
        case Action::ViewTop:
        case Action::ViewBottom:
            m_.control.view(static_cast<Side>(static_cast<int>(action) - static_cast<int>(Action::ViewFront)),
                            boundsOf(*m_.scene));
            return true;
        case Action::Reset:
            m_.control.reset();
            return true;
        case Action::Projection:
            m_.say("camera: " + m_.control.nextProjection());
            return true;
        case Action::FramePicked:
            framePicked();
            return true;
        case Action::NarrowView:
            m_.control.zoom(1 / kFovStep);
            return true;
        case Action::WidenView:
            m_.control.zoom(kFovStep);
            return true;
        case Action::TurnLeft:
            turn(-kKeyTurn, 0);
            return true;
        case Action::TurnRight:
            turn(kKeyTurn, 0);
            return true;
        case Action::TurnUp:
            turn(0, -kKeyTurn);
            return true;
        case Action::TurnDown:
            turn(0, kKeyTurn);
            return true;
        case Action::Nearer:
            m_.control.dolly(kDollyStep);
            return true;
        case Action::Farther:
            m_.control.dolly(1 / kDollyStep);
            return true;
        case Action::Undo:
            travel(m_.history.undo(), "nothing to undo");
            return true;
        case Action::Redo:
            travel(m_.history.redo(), "nothing to redo");
            return true;
        case Action::Bookmark:
            keepCamera();
            return true;
        case Action::NextBookmark:
            goToCamera(m_.camera + 1);
            return true;
        case Action::GoToCamera:
            goToCamera(m_.camera);
            return true;
        case Action::FocusPicked:
            if (m_.pick) focusAt(m_.pick->x, m_.pick->y);
            return true;
        default:
            return false;
    }
}

void Commands::travel(const std::optional<Undoable>& state, const char* otherwise) {
    if (!state) {
        m_.say(otherwise);
        return;
    }
    m_.restore(*state);
    takeSettings();
}

void Commands::framePicked() {
    const Ball ball = m_.pick && m_.pick->hit() ? boundsOf(*m_.scene, m_.pick->data.object,
                                                           m_.pick->data.position, m_.pick->data.depth)
                                                : boundsOf(*m_.scene);
    m_.control.frame(ball);
}

void Commands::pick(int x, int y) {
    if (x < 0 || y < 0 || x >= m_.session->width() || y >= m_.session->height()) return;
    m_.pick = pickPixel(*m_.session, x, y);
    m_.pickIsOld = false;
    if (m_.pick->hit()) m_.material = m_.pick->data.material;
    follow(Hint::Pick);
    host_.out << pickCsv(*m_.pick) << std::flush;
}

void Commands::focusAt(int x, int y) {
    if (x < 0 || y < 0 || x >= m_.session->width() || y >= m_.session->height()) return;
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

void Commands::keepCamera() {
    const auto taken = [](const std::vector<NamedCamera>& list, const std::string& name) {
        return std::any_of(list.begin(), list.end(), [&](const NamedCamera& c) { return c.name == name; });
    };
    std::string name;
    for (size_t i = 1; name.empty() || taken(m_.file->cameras, name) || taken(m_.bookmarks, name); ++i)
        name = "bookmark " + std::to_string(i);
    m_.bookmarks.push_back({name, m_.control.camera()});
    m_.camera = m_.file->cameras.size() + m_.bookmarks.size() - 1;
    m_.say(name + "; N goes to the next camera");
}

void Commands::goToCamera(size_t index) {
    const size_t inFile = m_.file->cameras.size(), all = inFile + m_.bookmarks.size();
    if (all == 0) {
        m_.say("M keeps a bookmark");
        return;
    }
    m_.camera = index % all;
    const NamedCamera& camera =
        m_.camera < inFile ? m_.file->cameras[m_.camera] : m_.bookmarks[m_.camera - inFile];
    m_.control.set(camera.camera);
    m_.say(camera.name + " (" + std::to_string(m_.camera + 1) + " of " + std::to_string(all) + ")");
    m_.history.endStep();
}

// ---- text of scenes ----

void Commands::copyJson() {
    std::string json = cameraJson(m_.control.camera());
    std::string what = "camera";
    if (m_.settings.lights != m_.fileSettings.lights) {
        json += ",\n\"lights\": " + lightsJson(m_.settings.lights, *m_.file);
        what += ", lights";
    }
    const std::string materials = materialsJson(m_.edits.materials, m_.fileEdits.materials);
    if (!materials.empty()) {
        json += ",\n\"materials\": " + materials;
        what += ", what has changed of materials";
    }
    host_.out << json << std::endl;
    host_.copy(json);
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
        if (m_.bookmarks.empty()) throw Error(ErrorKind::Argument, "M keeps a bookmark");
        for (const NamedCamera& bookmark : m_.bookmarks)
            if (bookmark.name.empty()) throw Error(ErrorKind::Argument, "give each bookmark a name");
        const std::string text = readWholeFile(path);
        checkUnchanged(text);
        writeTextFile(path, withCameras(text, path.string(), m_.bookmarks));
        const std::string line = "wrote " + std::to_string(m_.bookmarks.size()) +
                                 (m_.bookmarks.size() == 1 ? " camera" : " cameras") + " to " + path.string();
        m_.bookmarks.clear();
        m_.say(line);
        host_.out << line << std::endl;
        startLoading();
    } catch (const Error& e) {
        fail(e.what());
    }
}

// Lights and materials into a copy of the scene's file, beside it unless the user gives another folder.
void Commands::writeScene() {
    const std::filesystem::path target = m_.scene->path.parent_path() / m_.sceneName.data();
    try {
        if (std::filesystem::exists(target) && !m_.replacesFile)
            throw Error(ErrorKind::Argument,
                        target.string() + " exists: choose another name, or \"replace the file\"");
        const std::string text = readWholeFile(m_.scene->path);
        checkUnchanged(text);
        writeTextFile(target, editedSceneText(text, *m_.file, m_.undoable()));
        m_.saveSceneVisible = m_.replacesFile = false;
        const std::string line = "wrote lights and materials to " + target.string();
        m_.say(line);
        host_.out << line << std::endl;
    } catch (const std::exception& e) {
        fail(e.what());
    }
}

// ---- animation ----

bool Commands::performTime(Action action) {
    if (action < Action::PlayPause || action > Action::LastFrame) return false;
    Timeline& t = m_.timeline;
    if (!t.any()) {
        m_.say("this scene has no animation");
    } else if (action == Action::PlayPause) {
        t.playing() ? t.pause() : t.play(m_.clock.seconds());
    } else if (action == Action::FrameBack || action == Action::FrameOn) {
        t.step(action == Action::FrameOn ? 1 : -1);
    } else {
        t.goTo(action == Action::FirstFrame ? t.first() : t.last());
    }
    return true;
}

// ---- the rest ----

void Commands::follow(Hint hint) {
    if (m_.hints.done(hint)) m_.say("That is all it takes. F1 lists every key.");
}

// After all events of a round.
void Commands::noteChanges() {
    if (!m_.changed()) return;
    const bool moved = !sameCamera(m_.control.camera(), m_.history.seen().camera);
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
    if (!saving_.running() || m_.isClosing) {
        closing_ = true;
        return;
    }
    m_.isClosing = true;
    m_.say("closing once the image is saved; again: at once");
}

}  // namespace glint::view
