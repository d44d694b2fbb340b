// Commands that take time: loading, packing, saving, verifying, the reference image; and comparison.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ostream>
#include <utility>

#include "core/error.h"
#include "core/file_io.h"
#include "core/image_io.h"
#include "core/text_file.h"
#include "view/commands.h"

namespace glint::view {

namespace {

constexpr double kFileSeconds = 0.25;    // between looks at the scene's files
constexpr double kFlickerSeconds = 0.5;  // for which each of two images is shown

}  // namespace

// ---- scenes ----

void Commands::setDevice(const gpu::Device& device) {
    device_ = &device;
    showScene(m_.scene);
}

void Commands::releaseDevice() {
    if (m_.saving.running()) err_ << "glint: warning: the image that was being saved is lost\n";
    m_.saving.stop();
    m_.verifying.stop();
    m_.session.reset();
}

void Commands::showScene(std::shared_ptr<const ViewScene> scene) {
    const int width = m_.session ? m_.session->width() : 0, height = m_.session ? m_.session->height() : 0;
    m_.scene = std::move(scene);
    m_.session.reset();
    m_.session = std::make_unique<Session>(*device_, m_.scene);
    m_.session->apply(m_.settings);
    m_.session->wantData(m_.inspects);
    m_.session->setView(m_.control.camera(), width, height);
    shown_ = {};
    measured_ = {};
    m_.forgetView(true);
    m_.touch();
    m_.dirty = 3;
}

void Commands::reload() {
    m_.loading.start([this, path = m_.path, options = m_.options, another = opensAnother_,
                      time = m_.timeline.time(), edits = m_.settings.edits,
                      before = m_.fileSettings.edits](JobControl&) -> Job::Rest {
        auto moments = std::make_shared<Moments>(path, options, another ? std::optional<double>() : time);
        Moment shown = another ? moments->show() : moments->show({}, edits, before);
        return [this, moments, shown] { useScene(moments, shown); };
    });
    m_.dirty = 3;
}

void Commands::open(const std::filesystem::path& file) {
    if (isPictureFile(file)) {
        try {
            compareWith(file.filename().string(), readImage(file));
            if (m_.comparison.mode == CompareMode::Off) m_.comparison.mode = CompareMode::Wipe;
            follow(Hint::Compare);
        } catch (const Error& e) {
            m_.say(e.what(), ToastKind::Error);
        }
        return;
    }
    m_.path = file;
    m_.options.camera.clear();  // of the other scene
    opensAnother_ = true;
    reload();
}

// A scene was loaded, of the same file as before or of another one.
void Commands::useScene(std::shared_ptr<Moments> moments, Moment shown) {
    const bool another = std::exchange(opensAnother_, false);
    if (another) {
        const Scene& scene = *shown.file;
        const PictureSettings mine = std::exchange(m_.settings, PictureSettings::of(scene));
        m_.settings.layer = mine.layer;
        m_.settings.sampleLimit = mine.sampleLimit;
        m_.settings.until = mine.until;
        m_.fileSettings = m_.settings;
        m_.control = CameraControl(scene.camera);
        m_.history = {};
        m_.bookmarks.clear();
        m_.camera = Model::kNoCamera;
        m_.timeline = {};
        m_.timeline.setTime(shown.time);
    }
    m_.packing.stop();
    m_.moments = std::move(moments);
    timeAtWork_ = shown.time;
    takeMoment(std::move(shown));
    m_.timeline.follow(m_.file->animation);
    m_.sceneError.clear();
    window_.setTitle("glint: " + m_.path.filename().string());
    m_.say(another ? "opened " + m_.path.string() : "loaded " + m_.path.string() + " again");
    if (!another) return;
    m_.recent.add(m_.path);
    m_.sayWarnings(err_);
}

// Values that the user has not changed follow the file.
void Commands::takeMoment(Moment moment) {
    const PictureSettings file = PictureSettings::of(*moment.file);
    m_.settings.follow(m_.fileSettings, file);
    m_.fileSettings = file;
    editsAtWork_ = std::move(moment.edits);
    m_.file = std::move(moment.file);
    m_.time = moment.time;
    m_.control.follow(m_.file->camera, boundsOf(moment.scene ? *moment.scene : *m_.scene).radius);
    m_.history.reset(m_.undoable());
    if (moment.scene) return showScene(std::move(moment.scene));
    takeSettings();
    m_.forgetView();
    m_.touch();
}

// A fixed file may name other files than before; the next look finds those that changed meanwhile.
void Commands::watchFiles() {
    files_.watch(sceneFiles(m_.path, *m_.file));
}

// Packs one moment at a time: the latest edits and time once the one before is done.
void Commands::pack() {
    if (m_.packing.running() || m_.loading.running()) return;
    if (m_.settings.edits == editsAtWork_ && m_.timeline.time() == timeAtWork_) return;
    editsAtWork_ = m_.settings.edits;
    timeAtWork_ = m_.timeline.time();
    m_.packing.start([this, moments = m_.moments, time = timeAtWork_, edits = editsAtWork_,
                      before = m_.fileSettings.edits](JobControl&) -> Job::Rest {
        return [this, moment = moments->show(time, edits, before)] { takeMoment(moment); };
    });
}

// The words that ask `glint render` for the moment that is shown.
std::string Commands::momentText() const {
    if (!m_.time || !m_.timeline.any()) return "";
    return "; its moment: glint render " + m_.scene->path.string() + " --time " + describe(*m_.time);
}

// ---- results of jobs ----

void Commands::poll() {
    if (m_.timeline.advance(m_.clock.seconds())) m_.dirty = std::max(m_.dirty, 1);
    const auto collect = [&](Job& job, const std::function<void(const std::string& what)>& failed) {
        if (job.running()) m_.dirty = std::max(m_.dirty, 1);
        if (!job.finished()) return false;
        m_.dirty = 3;
        try {
            job.finish();
        } catch (const gpu::DeviceLost&) {
            throw;
        } catch (const std::exception& e) {
            failed(e.what());
        }
        return true;
    };
    const auto said = [&](const std::string& what) { fail(what); };
    collect(m_.saving, [&](const std::string& what) {
        fail(what);
        lostPicture_ = what;
    });
    collect(m_.verifying, said);
    collect(m_.referring, said);
    const bool loaded = collect(m_.loading, [&](const std::string& what) {
        if (!m_.session) throw;  // the device has no room for the scene
        m_.sceneError = what;
        err_ << "glint: " << what << '\n';
        if (std::exchange(opensAnother_, false)) m_.path = m_.scene->path;
    });
    if (loaded) {
        ++reloads_;
        watchFiles();
    }
    collect(m_.packing, [&](const std::string& what) {
        if (!m_.session) throw;
        fail(what);
        m_.timeline.setTime(m_.time);
        timeAtWork_ = m_.time;
    });
    pack();
    if (!m_.loading.running() && fileWatch_.seconds() >= kFileSeconds) {
        fileWatch_.restart();
        if (files_.changed()) reload();
    }
    if (m_.isClosing && !m_.saving.running()) closing_ = true;
}

bool Commands::hasJobs() const {
    return m_.saving.running() || m_.verifying.running() || m_.referring.running() || m_.packing.running();
}

bool Commands::settled() const {
    return !m_.moving() && m_.session->finished() && !hasJobs() && !m_.loading.running() &&
           !m_.timeline.playing() && m_.timeline.time() == timeAtWork_ && m_.settings.edits == editsAtWork_;
}

void Commands::close() {
    const bool cut = m_.saving.running();
    for (Job* job : {&m_.saving, &m_.verifying, &m_.referring, &m_.loading, &m_.packing}) job->stop();
    m_.session.reset();
    if (cut) throw Error(ErrorKind::Failed, "the window was closed before the image was saved");
    if (m_.isClosing && !lostPicture_.empty()) throw Error(ErrorKind::Failed, lostPicture_);
}

// ---- saving ----

bool Commands::saves() {
    if (m_.saving.running()) m_.say("still saving; one image at a time", ToastKind::Error);
    return m_.saving.running();
}

void Commands::saveNumbered(const char* extension, bool seen) {
    if (saves()) return;
    try {
        save(claimName(".", m_.scene->path.stem().string(), extension), seen);
    } catch (const Error& e) {
        fail(e.what());
    }
}

void Commands::saveNamed() {
    if (!isWritableImagePath(m_.saveName)) {
        m_.say("give a name that ends in .png, .exr, .pfm or .hdr", ToastKind::Error);
    } else if (!saves()) {
        m_.saveAsVisible = false;
        save(m_.saveName, m_.savesSeen);
    }
}

void Commands::save(const std::filesystem::path& file, bool seen) {
    follow(Hint::Save);
    const Session& session = *m_.session;
    const ViewRequest view(session);
    std::function<std::string(JobControl&)> work;
    if (!seen) {
        work = [=, sampling = m_.settings.sampling, display = m_.display](JobControl& c) {
            return saveRendered(view, file, sampling, display, c);
        };
    } else if (isExr(file)) {
        work = [=, picture = session.picture(), samples = session.samples(), hasData = session.hasData()](
                   JobControl& c) { return saveLayers(view, file, picture, samples, hasData, c); };
    } else {
        const ViewLayer layer = m_.settings.layer;
        const std::string how = needsData(layer)
                                    ? std::string(nameOf(layer))
                                    : counted(static_cast<uint64_t>(session.samples()), "sample");
        work = [=, canvas = refreshPicture()](JobControl&) { return saveCanvas(file, canvas, how); };
    }
    m_.saving.start([this, work, file, moment = momentText()](JobControl& control) -> Job::Rest {
        try {
            return [this, line = work(control) + moment] { report(line); };
        } catch (...) {  // a claimed name is free again
            std::error_code error;
            if (std::filesystem::file_size(file, error) == 0) std::filesystem::remove(file, error);
            throw;
        }
    });
}

// ---- comparison ----

void Commands::compareWith(const std::string& name, std::optional<Image> linear, Canvas canvas) {
    Comparison& c = m_.comparison;
    c.name = name;
    c.linear = std::move(linear);
    c.canvas = std::move(canvas);
    ++c.number;
}

void Commands::keepPicture() {
    if (!m_.session->ready()) {
        m_.say("nothing to keep yet", ToastKind::Error);
        return;
    }
    const ViewLayer layer = m_.settings.layer;
    const std::string name = "kept " + std::string(nameOf(layer));
    if (layer == ViewLayer::Color)
        compareWith(name, *m_.comparable());
    else
        compareWith(name, std::nullopt, m_.session->canvas(m_.display));
    m_.say("kept this image; B compares with it");
}

void Commands::nextComparison() {
    Comparison& c = m_.comparison;
    if (!c.any()) {
        m_.say("K keeps an image to compare with; or drop a file here", ToastKind::Error);
        return;
    }
    c.mode = nextOf(c.mode);
    follow(Hint::Compare);
    std::string text = "compare: " + std::string(nameOf(c.mode));
    if (c.mode == CompareMode::Wipe) text += ", left of the line";
    if (c.mode != CompareMode::Off) text += ": " + c.name + "; B: next";
    m_.say(text);
}

void Commands::verify() {
    if (m_.verifying.running()) return;
    m_.verdict.clear();
    m_.difference.reset();
    m_.verifying.start([this, view = ViewRequest(*m_.session)](JobControl& control) -> Job::Rest {
        return [this, report = verifyView(view, control)] { takeVerdict(report); };
    });
}

void Commands::takeVerdict(const verify::Report& report) {
    m_.verdictPassed = report.passed();
    char text[256];
    std::snprintf(
        text, sizeof(text), "%s: %llu pixels, %llu explained (%llu edges), %llu unexplained, RMSE %.3g",
        report.interrupted ? "stopped"
        : m_.verdictPassed ? "passed"
                           : "FAILED",
        static_cast<unsigned long long>(report.pixels), static_cast<unsigned long long>(report.explained()),
        static_cast<unsigned long long>(report.edges), static_cast<unsigned long long>(report.unexplained),
        report.rmse);
    m_.verdict = text;
    out_ << "verify " << text << std::endl;
    if (!m_.verdictPassed) m_.difference = canvasOf(report.difference, {});  // else the image stays
}

void Commands::traceReference() {
    if (m_.referring.running()) return;
    m_.referring.start([this, view = ViewRequest(*m_.session),
                        samples = m_.session->taken()](JobControl& control) -> Job::Rest {
        return [this, image = view::traceReference(view, samples, control)] {
            compareWith("reference", image);
            if (m_.comparison.mode == CompareMode::Off) m_.comparison.mode = CompareMode::Wipe;
            m_.say("the reference image is ready to compare with");
        };
    });
}

bool Commands::flash() const {
    return std::fmod(m_.clock.seconds(), 2 * kFlickerSeconds) >= kFlickerSeconds;
}

bool Commands::flashChanged() const {
    return m_.compares() && m_.comparison.mode == CompareMode::Flicker && flash() != shown_.flash;
}

const Canvas& Commands::refreshPicture() {
    Comparison& c = m_.comparison;
    const uint64_t version = m_.session->version();
    const std::pair wanted{version, c.number};
    if (m_.compares() && m_.session->finished() && std::exchange(measured_, wanted) != wanted)
        measure(c, m_.comparable());
    const bool flashes = m_.compares() && c.mode == CompareMode::Flicker && flash();
    const Shown now = {version, m_.display, m_.difference.has_value(), flashes, c.mode, c.wipe,
                       c.gain,  c.number,   c.figures.has_value()};
    if (now == shown_) return m_.picture;
    shown_ = now;
    if (m_.difference) {
        m_.picture = Canvas(m_.session->width(), m_.session->height());
        stretch(*m_.difference, m_.picture, false);
        return m_.picture;
    }
    m_.picture = m_.session->canvas(m_.display);
    if (m_.compares()) compose(c, m_.comparable(), m_.display, now.flash, m_.picture);
    return m_.picture;
}

}  // namespace glint::view
