// Commands that take time: loading, packing, saving, verifying, the reference image; and comparison.
#include <algorithm>
#include <cmath>
#include <ostream>
#include <utility>

#include "core/error.h"
#include "core/file_io.h"
#include "core/format.h"
#include "core/image_io.h"
#include "core/text_file.h"
#include "pack/pack_samples.h"
#include "reference/render.h"
#include "scene/sampling.h"
#include "verify/verify.h"
#include "view/commands.h"

namespace glint::view {

namespace {

constexpr double kFileSeconds = 0.25;    // between looks at the scene's files
constexpr double kFlickerSeconds = 0.5;  // for which each of two images is shown

// The view at the time of a command, for a job.
struct View {
    explicit View(const Session& session)
        : device(&session.device()), scene(session.scene()), request(session.request()) {}

    const gpu::Device* device;
    std::shared_ptr<const ViewScene> scene;
    Request request;

    render::Renderer renderer() const { return {*device, scene->packed, windowOptions(*scene)}; }
    Request requestOf(JobControl& control) const {
        Request wanted = request;
        wanted.progress = [&](double fraction) { control.progress = fraction; };
        wanted.cancelled = [&] { return control.cancelled.load(); };
        return wanted;
    }
};

Picture finished(Picture picture) {
    if (!picture.complete) throw Error(ErrorKind::Failed, "stopped before the image was finished");
    return picture;
}

bool isExr(const std::filesystem::path& file) {
    return lowerExtension(file) == ".exr";
}

// Every layer that an image of the window can have: all its pixels have the same number of samples, and it
// has no estimates of their error.
std::vector<Aov> allLayers() {
    std::vector<Aov> layers;
    for (const EnumEntry<Aov>& entry : kEnumEntries<Aov>)
        if (entry.value != Aov::Error && entry.value != Aov::Samples) layers.push_back(entry.value);
    return layers;
}

// The functions that save return words on the samples.

// Saves the image of `glint render` for the view. EXR: every layer; else colour, by `display`.
std::string saveRendered(const View& view, const std::filesystem::path& file, const Display& display,
                         JobControl& control) {
    Request wanted = view.requestOf(control);
    const std::string conflict = samplingConflict(wanted);
    if (!conflict.empty()) throw Error(ErrorKind::Failed, "not saved: " + conflict);
    wanted.samples = packSamples(wanted, wanted.camera);
    wanted.data = wanted.cost = isExr(file);
    Picture picture = finished(view.renderer().render(wanted));
    if (!isExr(file)) applyDisplay(picture.color, display);
    writeLayers(file, makeLayers(picture, isExr(file) ? allLayers() : std::vector{Aov::Radiance}));
    return "samples per pixel: " + std::to_string(wanted.samplesPerPixel);
}

// Saves every layer as EXR. The colour has `samples` samples as displayed, all other layers one in the middle
// of each pixel; before the first sample the colour, too.
std::string saveLayers(const View& view, const std::filesystem::path& file, Image color, int samples,
                       JobControl& control) {
    Request wanted = view.requestOf(control);
    wanted.data = wanted.cost = true;
    Picture picture = finished(view.renderer().render(wanted));
    if (samples > 0) picture.color = std::move(color);
    writeLayers(file, makeLayers(picture, allLayers()));
    return "as seen: " + counted(static_cast<uint64_t>(std::max(samples, 1)), "sample");
}

}  // namespace

// ---- scenes ----

namespace {

void showScene(Model& m, std::shared_ptr<const ViewScene> scene) {
    const int width = m.session ? m.session->width() : 0, height = m.session ? m.session->height() : 0;
    m.scene = std::move(scene);
    m.session.reset();
    m.session = std::make_unique<Session>(*m.device, m.scene);
    m.session->apply(m.settings);
    m.session->setView(m.control.camera(), width, height);
    m.shown = {};
    m.measured = {};
    m.forgetView(true);
    m.touch();
    m.redraw();
}

// Values that the user has not changed follow the file.
void takeMoment(Model& m, Moment moment) {
    const PictureSettings file = PictureSettings::of(*moment.file, m.wishes);
    m.settings.follow(m.fileSettings, file);
    m.fileSettings = file;
    m.editsAtWork = std::move(moment.edits);
    m.file = std::move(moment.file);
    m.time = moment.time;
    m.control.follow(m.file->camera, boundsOf(moment.scene ? *moment.scene : *m.scene).radius);
    m.history.reset(m.undoable());
    if (moment.scene) return showScene(m, std::move(moment.scene));
    takeSettings(m);
    m.forgetView();
    m.touch();
}

// A fixed file may name other files than before; the next look finds those that changed meanwhile.
void noteLoaded(Model& m) {
    ++m.reloads;
    m.files.watch(sceneFiles(m.path, *m.file));
}

// A scene was loaded, of the same file as before or of another one.
void useScene(Model& m, std::shared_ptr<Moments> moments, Moment shown) {
    const bool another = std::exchange(m.opensAnother, false);
    if (another) {
        const PictureSettings mine = std::exchange(m.settings, PictureSettings::of(*shown.file, m.wishes));
        m.settings.layer = mine.layer;
        m.settings.sampleLimit = mine.sampleLimit;
        m.settings.until = mine.until;
        m.fileSettings = m.settings;
        m.control = CameraControl(shown.file->camera);
        m.history = {};
        m.bookmarks.clear();
        m.camera = Model::kNoCamera;
        m.timeline = {};
        m.timeline.setTime(shown.time);
    }
    m.packing.stop();
    m.moments = std::move(moments);
    m.timeAtWork = shown.time;
    takeMoment(m, std::move(shown));
    m.timeline.follow(m.file->animation);
    m.sceneError.clear();
    noteLoaded(m);
    m.window->setTitle("glint: " + m.path.filename().string());
    m.say(another ? "opened " + m.path.string() : "loaded " + m.path.string() + " again");
    if (!another) return;
    m.recent.add(m.path);
    m.sayWarnings();
}

// Packs one moment at a time: the latest edits and time once the one before is done.
void pack(Model& m) {
    if (m.packing.running() || m.loading.running()) return;
    if (m.settings.edits == m.editsAtWork && m.timeline.time() == m.timeAtWork) return;
    m.editsAtWork = m.settings.edits;
    m.timeAtWork = m.timeline.time();
    m.packing.start([&m, moments = m.moments, time = m.timeAtWork, edits = m.editsAtWork,
                     before = m.fileSettings.edits](JobControl&) -> Job::Rest {
        return [&m, moment = moments->show(time, edits, before)] { takeMoment(m, moment); };
    });
}

}  // namespace

void setDevice(Model& m, const gpu::Device& device) {
    for (Job* job : m.jobs) job->failed = [&m](const std::string& what) { m.fail(what); };
    m.saving.failed = [&m](const std::string& what) { m.fail(m.lostPicture = what); };
    m.loading.failed = [&m](const std::string& what) {
        if (!m.session) throw;  // the device has no room for the scene
        if (m.loadsAgain) return;
        m.sceneError = what;
        m.err << "glint: " << what << '\n';
        if (std::exchange(m.opensAnother, false)) m.path = m.scene->path;
        noteLoaded(m);
    };
    m.packing.failed = [&m](const std::string& what) {
        if (!m.session) throw;
        m.fail(what);
        m.timeline.setTime(m.time);
        m.timeAtWork = m.time;
    };
    m.device = &device;
    showScene(m, m.scene);
}

void releaseDevice(Model& m) {
    if (m.saving.running()) m.err << "glint: warning: the image that was being saved is lost\n";
    m.saving.stop();
    m.verifying.stop();
    m.session.reset();
}

void reload(Model& m) {
    m.loadsAgain = m.loading.running();
    if (m.loadsAgain) return;
    m.loading.start([&m, path = m.path, options = m.options, another = m.opensAnother,
                     time = m.timeline.time(), edits = m.settings.edits,
                     before = m.fileSettings.edits](JobControl&) -> Job::Rest {
        auto moments = std::make_shared<Moments>(path, options, another ? std::optional<double>() : time);
        Moment shown = another ? moments->show() : moments->show({}, edits, before);
        return [&m, moments, shown] {
            if (!m.loadsAgain) useScene(m, moments, shown);
        };
    });
    m.redraw();
}

void poll(Model& m) {
    if (m.timeline.advance(m.clock.seconds())) m.redraw(1);
    for (Job* job : m.jobs) {
        if (job->running()) m.redraw(1);
        if (job->finish()) m.redraw();
    }
    pack(m);
    if (!m.loading.running() && m.fileWatch.seconds() >= kFileSeconds) {
        m.fileWatch.restart();
        if (m.loadsAgain || m.files.changed()) reload(m);
    }
    if (m.isClosing && !m.saving.running()) m.closes = true;
}

bool settled(const Model& m) {
    return !m.moving() && m.session->finished() && !m.busy() && !m.timeline.playing() &&
           m.timeline.time() == m.timeAtWork && m.settings.edits == m.editsAtWork;
}

std::string close(Model& m) {
    const bool cut = m.saving.running();
    for (Job* job : m.jobs) job->stop();
    m.session.reset();
    if (cut) return "the window was closed before the image was saved";
    return m.isClosing ? m.lostPicture : "";
}

// ---- saving ----

namespace {

// Command line of `glint render` for the moment that is shown.
std::string momentText(const Model& m) {
    if (!m.time || !m.timeline.any()) return "";
    return "; its moment: glint render " + m.scene->path.string() + " --time " + describe(*m.time);
}

}  // namespace

bool saves(Model& m) {
    if (m.saving.running()) m.say("still saving; one image at a time", ToastKind::Error);
    return m.saving.running();
}

void save(Model& m, const std::filesystem::path& file, bool seen) {
    m.follow(Hint::Save);
    const Session& session = *m.session;
    const View view(session);
    std::function<std::string(JobControl&)> work;
    if (!seen) {
        work = [=, display = m.display](JobControl& control) {
            return saveRendered(view, file, display, control);
        };
    } else if (isExr(file)) {
        work = [=, color = session.picture().color, samples = session.samples()](JobControl& control) {
            return saveLayers(view, file, color, samples, control);
        };
    } else {
        const ViewLayer layer = m.settings.layer;
        const std::string how = needsData(layer)
                                    ? std::string(nameOf(layer))
                                    : counted(static_cast<uint64_t>(session.samples()), "sample");
        work = [=, canvas = refreshPicture(m)](JobControl&) {
            writeImage(file, toImage(canvas));
            return "as seen: " + how;
        };
    }
    const std::string size = std::to_string(session.width()) + "x" + std::to_string(session.height());
    m.saving.start([=, &m, moment = momentText(m)](JobControl& control) -> Job::Rest {
        try {
            const std::string how = work(control);
            return [=, &m] { m.report("saved " + file.string() + " (" + size + ", " + how + ")" + moment); };
        } catch (...) {  // a claimed name is free again
            std::error_code error;
            if (std::filesystem::file_size(file, error) == 0) std::filesystem::remove(file, error);
            throw;
        }
    });
}

void saveNamed(Model& m) {
    if (!isWritableImagePath(m.saveName)) {
        m.say("give a name that ends in .png, .exr, .pfm or .hdr", ToastKind::Error);
    } else if (!m.keeps(m.saveName) && !saves(m)) {
        m.saveAsVisible = false;
        save(m, m.saveName, m.savesSeen);
    }
}

// ---- comparison ----

namespace {

void compareWith(Model& m, const std::string& name, std::optional<Image> linear, Canvas canvas = {}) {
    Comparison& c = m.comparison;
    c.name = name;
    c.linear = std::move(linear);
    c.canvas = std::move(canvas);
    ++c.number;
}

bool flash(const Model& m) {
    return std::fmod(m.clock.seconds(), 2 * kFlickerSeconds) >= kFlickerSeconds;
}

}  // namespace

void open(Model& m, const std::filesystem::path& file) {
    if (isPictureFile(file)) {
        try {
            compareWith(m, file.filename().string(), readImage(file));
            if (m.comparison.mode == CompareMode::Off) m.comparison.mode = CompareMode::Wipe;
            m.follow(Hint::Compare);
        } catch (const Error& e) {
            m.say(e.what(), ToastKind::Error);
        }
        return;
    }
    if (!m.mayLeave()) return;
    m.path = file;
    m.options.camera.clear();  // of the other scene
    m.opensAnother = true;
    reload(m);
}

void keepImage(Model& m) {
    if (!m.session->ready()) {
        m.say("nothing to keep yet", ToastKind::Error);
        return;
    }
    const ViewLayer layer = m.settings.layer;
    const std::string name = "kept " + std::string(nameOf(layer));
    if (layer == ViewLayer::Color)
        compareWith(m, name, *m.comparable());
    else
        compareWith(m, name, std::nullopt, m.session->canvas(m.display));
    m.say("kept this image; B compares with it");
}

void nextComparison(Model& m) {
    Comparison& c = m.comparison;
    if (!c.any()) {
        m.say("K keeps an image to compare with; or drop a file here", ToastKind::Error);
        return;
    }
    c.mode = nextOf(c.mode);
    m.follow(Hint::Compare);
    std::string text = "compare: " + std::string(nameOf(c.mode));
    if (c.mode == CompareMode::Wipe) text += ", left of the line";
    if (c.mode != CompareMode::Off) text += ": " + c.name + "; B: next";
    m.say(text);
}

void verify(Model& m) {
    if (m.verifying.running()) return;
    m.verdict.clear();
    m.difference.reset();
    m.verifying.start([&m, view = View(*m.session)](JobControl& control) -> Job::Rest {
        render::Renderer renderer = view.renderer();
        verify::Options options;
        static_cast<Request&>(options) = view.requestOf(control);
        const verify::Report r = verify::verify(renderer, view.scene->packed, options);
        return [&m, r] {
            m.verdictPassed = r.passed();
            m.verdict = format("%s: %llu pixels, %llu explained (%llu edges), %llu unexplained, RMSE %.3g",
                               r.interrupted     ? "stopped"
                               : m.verdictPassed ? "passed"
                                                 : "FAILED",
                               static_cast<unsigned long long>(r.pixels),
                               static_cast<unsigned long long>(r.explained()),
                               static_cast<unsigned long long>(r.edges),
                               static_cast<unsigned long long>(r.unexplained), r.rmse);
            m.out << "verify " << m.verdict << std::endl;
            if (!m.verdictPassed) m.difference = canvasOf(r.difference, {});  // else the image stays
        };
    });
}

void traceReference(Model& m) {
    if (m.referring.running()) return;
    m.referring.start(
        [&m, view = View(*m.session), samples = m.session->taken()](JobControl& control) -> Job::Rest {
            Request wanted = view.requestOf(control);
            wanted.samples = samples;
            return [&m, image = finished(reference::render(view.scene->packed, wanted)).color] {
                compareWith(m, "reference", image);
                if (m.comparison.mode == CompareMode::Off) m.comparison.mode = CompareMode::Wipe;
                m.say("the reference image is ready to compare with");
            };
        });
}

bool flashChanged(const Model& m) {
    return m.compares() && m.comparison.mode == CompareMode::Flicker && flash(m) != m.shown.flash;
}

const Canvas& refreshPicture(Model& m) {
    Comparison& c = m.comparison;
    const uint64_t version = m.session->version();
    const std::pair wanted{version, c.number};
    if (!m.session->finished())
        c.figures.reset();  // an earlier image, which may have had another size
    else if (m.compares() && std::exchange(m.measured, wanted) != wanted)
        measure(c, m.comparable());
    const bool flashes = m.compares() && c.mode == CompareMode::Flicker && flash(m);
    const Model::Shown now = {version, m.display, m.difference.has_value(), flashes, c.mode, c.wipe,
                              c.gain,  c.number,  c.figures.has_value()};
    if (now == m.shown) return m.picture;
    m.shown = now;
    if (m.difference) {
        m.picture = stretched(*m.difference, m.session->width(), m.session->height(), false);
        return m.picture;
    }
    m.picture = m.session->canvas(m.display);
    if (m.compares()) compose(c, m.comparable(), m.display, now.flash, m.picture);
    return m.picture;
}

}  // namespace glint::view
