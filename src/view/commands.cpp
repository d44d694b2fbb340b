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

template <NamedEnum E>
E nextOf(E value) {
    return static_cast<E>((static_cast<size_t>(value) + 1) % kEnumNames<E>.size());
}

void toggle(bool& flag) {
    flag = !flag;
}

}  // namespace

Commands::Commands(Model& model, Host host)
    : m_(model), host_(std::move(host)), editsAtWork_(model.settings.edits), timeAtWork_(model.time) {
    files_.watch(sceneFiles(m_.path, *m_.file));
}

void Commands::fail(const std::string& what) {
    lastError_ = what;
    m_.say(what, ToastKind::Error);
    host_.err << "glint: " << what << '\n';
}

namespace {

constexpr double kKeyTurn = 0.0873;  // 5 degrees
constexpr double kDollyStep = 0.9;
constexpr double kFovStep = 1.1;

void turn(Model& m, double x, double y) {
    m.flying ? m.control.look(x, y) : m.control.orbit(x, y);
}

void changeLayer(Model& m, int step) {
    m.settings.layer = static_cast<ViewLayer>((static_cast<int>(m.settings.layer) + step) % kViewLayers);
}

void closeAll(Model& m) {
    m.helpVisible = m.saveAsVisible = m.saveSceneVisible = m.openVisible = false;
    m.sceneError.clear();
    m.warnings.clear();
    m.toasts.clear();
    m.comparison.mode = CompareMode::Off;
    m.forgetView(true);
}

// Commands that change the model alone.
struct ModelCommand {
    Action action;
    void (*run)(Model& m);
};
constexpr ModelCommand kModelCommands[] = {
    {Action::Help, [](Model& m) { toggle(m.helpVisible); }},
    {Action::HidePanel, [](Model& m) { toggle(m.panelVisible); }},
    {Action::DockPanel,
     [](Model& m) {
         m.docked = !m.docked || !m.panelVisible;
         m.panelVisible = true;
     }},
    {Action::Close, closeAll},
    {Action::NextLayer, [](Model& m) { changeLayer(m, 1); }},
    {Action::PreviousLayer, [](Model& m) { changeLayer(m, kViewLayers - 1); }},
    {Action::ExposureDown, [](Model& m) { m.display.exposure = steppedExposure(m.display.exposure, -0.5); }},
    {Action::ExposureUp, [](Model& m) { m.display.exposure = steppedExposure(m.display.exposure, 0.5); }},
    {Action::ToneMapping,
     [](Model& m) {
         m.display.toneMap = nextOf(m.display.toneMap);
         m.say("tone map: " + std::string(nameOf(m.display.toneMap)));
     }},
    {Action::Inspect, [](Model& m) { toggle(m.inspects); }},
    {Action::ToggleFly, [](Model& m) { toggle(m.flying); }},
    {Action::SaveAs, [](Model& m) { toggle(m.saveAsVisible); }},
    {Action::SaveScene, [](Model& m) { toggle(m.saveSceneVisible); }},
    {Action::Open, [](Model& m) { toggle(m.openVisible); }},
    {Action::Reset, [](Model& m) { m.control.reset(); }},
    {Action::Projection, [](Model& m) { m.say("camera: " + m.control.nextProjection()); }},
    {Action::NarrowView, [](Model& m) { m.control.zoom(1 / kFovStep); }},
    {Action::WidenView, [](Model& m) { m.control.zoom(kFovStep); }},
    {Action::TurnLeft, [](Model& m) { turn(m, -kKeyTurn, 0); }},
    {Action::TurnRight, [](Model& m) { turn(m, kKeyTurn, 0); }},
    {Action::TurnUp, [](Model& m) { turn(m, 0, -kKeyTurn); }},
    {Action::TurnDown, [](Model& m) { turn(m, 0, kKeyTurn); }},
    {Action::Nearer, [](Model& m) { m.control.dolly(kDollyStep); }},
    {Action::Farther, [](Model& m) { m.control.dolly(1 / kDollyStep); }},
};

}  // namespace

void Commands::perform(Action action) {
    m_.dirty = 3;
    for (const ModelCommand& command : kModelCommands)
        if (command.action == action) {
            command.run(m_);
            return takeSettings();
        }
    if (action >= Action::ViewFront && action <= Action::ViewBottom) {
        const int side = static_cast<int>(action) - static_cast<int>(Action::ViewFront);
        m_.control.view(static_cast<Side>(side), boundsOf(*m_.scene));
    } else if (action >= Action::PlayPause && action <= Action::LastFrame) {
        performTime(action);
    } else if (action >= Action::SavePng && action <= Action::RenderExr) {
        saveNumbered(action);
    } else {
        performOther(action);
    }
}

// The rest needs the device, files or the host.
void Commands::performOther(Action action) {
    struct Command {
        Action action;
        void (*run)(Commands& c);
    };
    static constexpr Command kCommands[] = {
        {Action::Quit, [](Commands& c) { c.askToClose(); }},
        {Action::Fullscreen, [](Commands& c) { c.host_.toggleFullscreen(); }},
        {Action::FramePicked, [](Commands& c) { c.framePicked(); }},
        {Action::FocusPicked,
         [](Commands& c) {
             if (c.m_.pick) c.focusAt(c.m_.pick->x, c.m_.pick->y);
         }},
        {Action::Undo, [](Commands& c) { c.travel(c.m_.history.undo(), "nothing to undo"); }},
        {Action::Redo, [](Commands& c) { c.travel(c.m_.history.redo(), "nothing to redo"); }},
        {Action::Bookmark, [](Commands& c) { c.keepCamera(); }},
        {Action::NextBookmark, [](Commands& c) { c.goToCamera(c.m_.camera + 1); }},
        {Action::GoToCamera, [](Commands& c) { c.goToCamera(c.m_.camera); }},
        {Action::PrintCamera, [](Commands& c) { c.copyJson(); }},
        {Action::WriteCameras, [](Commands& c) { c.writeCameras(); }},
        {Action::WriteScene, [](Commands& c) { c.writeScene(); }},
        {Action::SaveNamed, [](Commands& c) { c.saveNamed(); }},
        {Action::OpenNamed, [](Commands& c) { c.drop({c.m_.openName.data()}); }},
        {Action::Reload, [](Commands& c) { c.startLoading(); }},
        {Action::Verify, [](Commands& c) { c.startVerifying(); }},
        {Action::Keep, [](Commands& c) { c.keepPicture(); }},
        {Action::TraceReference, [](Commands& c) { c.startReference(); }},
        {Action::CompareMode, [](Commands& c) { c.nextComparison(); }},
    };
    for (const Command& command : kCommands)
        if (command.action == action) return command.run(*this);
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
        json += ",\n\"lights\": " + lightsJson(m_.settings.lights);
        what += ", lights";
    }
    const std::string materials = materialsJson(m_.settings.edits.materials, m_.fileSettings.edits.materials);
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
        writeTextFile(target, editedSceneText(text, m_.settings, m_.fileSettings));
        m_.saveSceneVisible = m_.replacesFile = false;
        const std::string line = "wrote lights and materials to " + target.string();
        m_.say(line);
        host_.out << line << std::endl;
    } catch (const std::exception& e) {
        fail(e.what());
    }
}

// ---- animation ----

void Commands::performTime(Action action) {
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
}

// ---- the rest ----

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
    if (!saving_.running() || m_.isClosing) {
        closing_ = true;
        return;
    }
    m_.isClosing = true;
    m_.say("closing once the image is saved; again: at once");
}

}  // namespace glint::view
