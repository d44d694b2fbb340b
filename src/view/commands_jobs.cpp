// Commands that take time: loading, packing, saving, verifying, the reference image.
#include <algorithm>
#include <cmath>
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
    m_.device = &device.info();
    showScene(m_.scene);
}

void Commands::releaseDevice() {
    if (saving_.running()) host_.err << "glint: warning: the image that was being saved is lost\n";
    saving_.stop();
    verifying_.stop();
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
    m_.pixel.reset();
    m_.forgetView(true);
    m_.touch();
    m_.dirty = 3;
}

void Commands::startLoading() {
    loading_.start([path = m_.path, loading = m_.loading, another = opensAnother_, time = m_.timeline.time(),
                    edits = m_.settings.edits, before = m_.fileSettings.edits](JobControl&) {
        Loaded loaded;
        loaded.moments = std::make_shared<Moments>(path, loading, another ? std::optional<double>() : time);
        loaded.shown = another ? loaded.moments->show() : loaded.moments->show({}, edits, before);
        return loaded;
    });
    m_.dirty = 3;
}

void Commands::open(const std::filesystem::path& scene) {
    m_.path = scene;
    m_.loading.camera.clear();  // of the other scene
    opensAnother_ = true;
    startLoading();
}

// Shows a scene that was loaded, of the same file as before or of another one.
void Commands::useScene(Loaded loaded) {
    const bool another = std::exchange(opensAnother_, false);
    if (another) {
        const Scene& scene = *loaded.shown.file;
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
        m_.timeline.setTime(loaded.shown.time);
    }
    packing_.stop();
    m_.moments = std::move(loaded.moments);
    timeAtWork_ = loaded.shown.time;
    takeMoment(std::move(loaded.shown));
    m_.timeline.follow(m_.file->animation);
    if (another) m_.sayWarnings(host_.err);
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

void Commands::pollLoading() {
    if (!loading_.finished()) return;
    m_.dirty = 3;
    ++reloads_;
    const bool another = opensAnother_;
    try {
        useScene(loading_.take());
        m_.sceneError.clear();
        host_.setTitle("glint: " + m_.path.filename().string());
        if (another) m_.recent.add(m_.path);
        m_.say(another ? "opened " + m_.path.string() : "loaded " + m_.path.string() + " again");
    } catch (const Error& e) {
        if (e.kind() != ErrorKind::Scene && e.kind() != ErrorKind::Failed) throw;
        m_.sceneError = e.what();
        host_.err << "glint: " << e.what() << '\n';
        if (another) {  // keep watching the scene that is shown
            m_.path = m_.scene->path;
            opensAnother_ = false;
        }
    }
    // A fixed file may name other files than before; the next look finds those that changed meanwhile.
    files_.watch(sceneFiles(m_.path, *m_.file));
}

// Packs one moment at a time: the latest edits and time once the one before is done.
void Commands::pollPacking() {
    if (packing_.finished()) {
        m_.dirty = 3;
        try {
            takeMoment(packing_.take());
        } catch (const Error& e) {
            fail(e.what());
            m_.timeline.setTime(m_.time);
            timeAtWork_ = m_.time;
        }
    }
    if (packing_.running() || loading_.running()) return;
    if (m_.settings.edits == editsAtWork_ && m_.timeline.time() == timeAtWork_) return;
    editsAtWork_ = m_.settings.edits;
    timeAtWork_ = m_.timeline.time();
    packing_.start(
        [moments = m_.moments, time = timeAtWork_, edits = editsAtWork_,
         before = m_.fileSettings.edits](JobControl&) { return moments->show(time, edits, before); });
}

// The words that ask `glint render` for the moment that is shown.
std::string Commands::momentText() const {
    if (!m_.time || !m_.timeline.any()) return "";
    return "; its moment: glint render " + m_.scene->path.string() + " --time " + describe(*m_.time);
}

// ---- results of jobs ----

void Commands::poll() {
    if (m_.timeline.advance(m_.clock.seconds())) m_.dirty = std::max(m_.dirty, 1);
    const auto collect = [&](auto& job, auto use) {
        if (job.running()) m_.dirty = std::max(m_.dirty, 1);
        if (!job.finished()) return;
        m_.dirty = 3;
        try {
            use(job.take());
        } catch (const gpu::DeviceLost&) {
            throw;
        } catch (const std::exception& e) {
            fail(e.what());
            if (static_cast<void*>(&job) == &saving_) lostPicture_ = e.what();
        }
    };
    collect(saving_, [&](const std::string& line) {
        m_.say(line);
        host_.out << line << std::endl;
    });
    collect(verifying_, [&](VerifyResult result) { takeVerdict(std::move(result)); });
    collect(referring_, [&](Image image) {
        m_.comparison.name = "reference";
        m_.comparison.linear = std::move(image);
        m_.comparison.canvas = {};
        if (m_.comparison.mode == CompareMode::Off) m_.comparison.mode = CompareMode::Wipe;
        ++m_.compared;
        m_.say("the reference image is ready to compare with");
    });
    pollLoading();
    pollPacking();
    if (!loading_.running() && fileWatch_.seconds() >= kFileSeconds) {
        fileWatch_.restart();
        if (files_.changed()) startLoading();
    }
    const auto progress = [](const auto& job) { return job.running() ? job.progress() : -1; };
    m_.saveProgress = progress(saving_);
    m_.verifyProgress = progress(verifying_);
    m_.referenceProgress = progress(referring_);
    m_.isLoading = loading_.running();
    if (m_.isClosing && !saving_.running()) closing_ = true;
}

void Commands::takeVerdict(VerifyResult result) {
    m_.verdict = result.text;
    m_.verdictPassed = result.passed;
    host_.out << "verify " << result.text << std::endl;
    if (result.passed) return;  // the image stays
    Comparison difference;
    difference.linear = std::move(result.difference);
    difference.mode = CompareMode::Wipe;
    difference.wipe = 1;
    m_.difference = Canvas(difference.width(), difference.height());
    compose(difference, nullptr, {}, false, *m_.difference);
}

bool Commands::hasJobs() const {
    return saving_.running() || verifying_.running() || referring_.running() || packing_.running();
}

bool Commands::settled() const {
    return !m_.moving() && m_.session->finished() && !hasJobs() && !loading_.running() &&
           !m_.timeline.playing() && m_.timeline.time() == timeAtWork_ && m_.settings.edits == editsAtWork_;
}

void Commands::close() {
    const bool cut = saving_.running();
    saving_.stop();
    verifying_.stop();
    referring_.stop();
    loading_.stop();
    packing_.stop();
    m_.session.reset();
    if (cut) throw Error(ErrorKind::Failed, "the window was closed before the image was saved");
    if (m_.isClosing && !lostPicture_.empty()) throw Error(ErrorKind::Failed, lostPicture_);
}

// ---- files ----

void Commands::saveNumbered(Action action) {
    const bool exr = action == Action::SaveExr || action == Action::RenderExr;
    const bool seen = action == Action::SavePng || action == Action::SaveExr;
    if (saving_.running()) {
        m_.say("still saving; one image at a time", ToastKind::Error);
        return;
    }
    try {
        save(claimName(".", m_.scene->path.stem().string(), exr ? ".exr" : ".png"), seen);
    } catch (const Error& e) {
        fail(e.what());
    }
}

void Commands::saveNamed() {
    const std::filesystem::path file = m_.saveName.data();
    if (!isWritableImagePath(file)) {
        m_.say("give a name that ends in .png, .exr, .pfm or .hdr", ToastKind::Error);
    } else if (saving_.running()) {
        m_.say("still saving; one image at a time", ToastKind::Error);
    } else {
        m_.saveAsVisible = false;
        save(file, m_.savesSeen);
    }
}

void Commands::save(const std::filesystem::path& file, bool seen) {
    follow(Hint::Save);
    const auto start = [&](auto request) {
        saving_.start([device = device_, moment = momentText(), request](JobControl& control) mutable {
            return view::save(*device, std::move(request), control) + moment;
        });
    };
    if (!seen) return start(RenderRequest{viewRequest(*m_.session), file, m_.settings.sampling, m_.display});
    SeenRequest request = seenRequest(*m_.session, file, m_.display);
    // A comparison or a verification over the image is saved too.
    if (request.canvas && (m_.difference || m_.compares())) request.canvas = refreshPicture();
    start(std::move(request));
}

void Commands::drop(const std::vector<std::string>& files) {
    for (const std::string& file : files) isPictureFile(file) ? compareWith(file) : open(file);
}

// ---- comparison ----

void Commands::nextComparison() {
    Comparison& c = m_.comparison;
    if (!c.any()) {
        m_.say("K keeps an image to compare with; or drop a file here", ToastKind::Error);
        return;
    }
    c.mode = static_cast<CompareMode>((static_cast<size_t>(c.mode) + 1) % kEnumNames<CompareMode>.size());
    follow(Hint::Compare);
    std::string text = "compare: " + std::string(nameOf(c.mode));
    if (c.mode == CompareMode::Wipe) text += ", left of the line";
    if (c.mode != CompareMode::Off) text += ": " + c.name + "; B: next";
    m_.say(text);
}

void Commands::startVerifying() {
    if (verifying_.running()) return;
    m_.verdict.clear();
    m_.difference.reset();
    verifying_.start([device = device_, request = viewRequest(*m_.session)](JobControl& control) {
        return verifyView(*device, request, control);
    });
}

void Commands::startReference() {
    if (referring_.running()) return;
    referring_.start([request = viewRequest(*m_.session), samples = m_.session->taken()](
                         JobControl& control) { return traceReference(request, samples, control); });
}

void Commands::keepPicture() {
    if (!m_.session->ready()) {
        m_.say("nothing to keep yet", ToastKind::Error);
        return;
    }
    m_.comparison.name = "kept " + std::string(nameOf(m_.settings.layer));
    m_.comparison.linear.reset();
    m_.comparison.canvas = {};
    if (m_.settings.layer == ViewLayer::Color)
        m_.comparison.linear = *m_.comparable();
    else
        m_.comparison.canvas = m_.session->canvas(m_.display);
    ++m_.compared;
    m_.say("kept this image; B compares with it");
}

void Commands::compareWith(const std::filesystem::path& image) {
    try {
        m_.comparison.linear = readImage(image);
    } catch (const Error& e) {
        m_.say(e.what(), ToastKind::Error);
        return;
    }
    m_.comparison.canvas = {};
    m_.comparison.name = image.filename().string();
    if (m_.comparison.mode == CompareMode::Off) m_.comparison.mode = CompareMode::Wipe;
    follow(Hint::Compare);
    ++m_.compared;
    m_.dirty = 3;
}

bool Commands::flash() const {
    return std::fmod(m_.clock.seconds(), 2 * kFlickerSeconds) >= kFlickerSeconds;
}

bool Commands::flashChanged() const {
    return m_.compares() && m_.comparison.mode == CompareMode::Flicker && flash() != shown_.flash;
}

const Canvas& Commands::refreshPicture() {
    constexpr uint64_t kFar = 1000003;
    const bool compares = m_.compares();
    if (compares && m_.session->finished()) {
        const uint64_t wanted = m_.session->version() * kFar + m_.compared;
        if (std::exchange(measured_, wanted) != wanted) measure(m_.comparison, m_.comparable());
    }
    Shown now;
    now.version = m_.session->version();
    now.display = m_.display;
    now.difference = m_.difference.has_value();
    if (compares) {
        now.mode = m_.comparison.mode;
        now.flash = now.mode == CompareMode::Flicker && flash();
        now.wipe = m_.comparison.wipe;
        now.gain = m_.comparison.gain;
        now.compared = m_.compared + (m_.comparison.figures ? kFar : 0);
    }
    if (now == shown_) return m_.picture;
    shown_ = now;
    if (m_.difference) {
        m_.picture = Canvas(m_.session->width(), m_.session->height());
        stretch(*m_.difference, m_.picture, false);
        return m_.picture;
    }
    m_.picture = m_.session->canvas(m_.display);
    if (compares) compose(m_.comparison, m_.comparable(), m_.display, now.flash, m_.picture);
    return m_.picture;
}

}  // namespace glint::view
