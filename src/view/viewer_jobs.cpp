// What runs beside the window: loading, saving, verifying, the reference; and files that come in.
#include <algorithm>
#include <ostream>
#include <utility>

#include "core/error.h"
#include "core/image_io.h"
#include "view/file_list.h"
#include "view/viewer.h"

namespace glint::view {

// Of the same file as before, or of another.
void Viewer::useScene(Loaded loaded) {
    if (std::exchange(opensAnother_, false)) {
        const Scene& scene = *loaded.shown.file;
        const PictureSettings mine = std::exchange(model_.settings, PictureSettings::of(scene));
        model_.settings.layer = mine.layer;
        model_.settings.sampleLimit = mine.sampleLimit;
        model_.settings.until = mine.until;
        model_.fileSettings = model_.settings;
        model_.edits = model_.fileEdits = SceneEdits::of(scene);
        control_ = CameraControl(scene.camera);
        history_ = {};
        bookmarks_.clear();
        model_.camera = PanelModel::kNoCamera;
        timeline_ = {};
        timeline_.setTime(loaded.shown.time);
    }
    packing_.stop();
    moments_ = std::move(loaded.moments);
    timeAtWork_ = loaded.shown.time;
    takeMoment(std::move(loaded.shown));
    timeline_.follow(fileScene_->animation);
}

void Viewer::showScene(std::shared_ptr<const ViewScene> scene) {
    scene_ = std::move(scene);
    model_.reach = boundsOf(*scene_).radius;
    session_.reset();
    session_ = std::make_unique<Session>(*device_, scene_, model_.traversal);
    session_->apply(model_.settings);
    session_->wantData(model_.inspects);
    showView();  // a key may come before the first piece of work
    shown_ = {};
    model_.pixel.reset();
    difference_.reset();
    forgetPick(true);
    touchMotion();
    dirty_ = 3;
}

void Viewer::startLoading() {
    if (opensAnother_) options_.time.reset();
    loading_.start([options = options_, another = opensAnother_, time = timeline_.time(),
                    edits = model_.edits, before = model_.fileEdits](JobControl&) {
        Loaded loaded;
        loaded.moments = std::make_shared<Moments>(options.scene, options.loading,
                                                   another ? std::optional<double>() : time);
        loaded.shown = another ? loaded.moments->show() : loaded.moments->show({}, edits, before);
        Window::wake();
        return loaded;
    });
    dirty_ = 3;
}

void Viewer::open(const std::filesystem::path& scene) {
    options_.scene = scene;
    options_.loading.camera.clear();  // of the other scene
    opensAnother_ = true;
    startLoading();
}

void Viewer::pollFiles() {
    if (loading_.running() || fileWatch_.seconds() < kFileSeconds) return;
    fileWatch_.restart();
    if (files_.changed()) startLoading();
}

// A failed job is a message in the window; a lost device is everybody's.
void Viewer::pollJobs() {
    const auto collect = [&](auto& job, auto use) {
        if (job.running()) dirty_ = std::max(dirty_, 1);
        if (!job.finished()) return true;
        dirty_ = 3;
        try {
            use(job.take());
        } catch (const gpu::DeviceLost&) {
            throw;
        } catch (const std::exception& e) {
            say(e.what(), ToastKind::Error);
            err_ << "glint: " << e.what() << '\n';
            return false;
        }
        return true;
    };
    const bool saved = collect(saving_, [&](const std::string& line) {
        say(line);
        out_ << line << std::endl;
    });
    if (!saved) lostPicture_ = lastSaid_;
    collect(verifying_, [&](VerifyResult result) {
        model_.verdict = result.text;
        model_.verdictPassed = result.passed;
        out_ << "verify " << result.text << std::endl;
        Comparison difference;
        difference.linear = std::move(result.difference);
        difference.mode = CompareMode::Wipe;
        difference.wipe = 1;
        difference_ = Canvas(difference.width(), difference.height());
        compose(difference, nullptr, {}, false, *difference_);
    });
    collect(referring_, [&](Image image) {
        comparison_.name = "reference";
        comparison_.linear = std::move(image);
        comparison_.canvas = {};
        if (comparison_.mode == CompareMode::Off) comparison_.mode = CompareMode::Wipe;
        ++compared_;
        say("the reference is there to compare with");
    });
    pollLoading();
    pollPacking();
}

void Viewer::pollLoading() {
    if (!loading_.finished()) return;
    dirty_ = 3;
    ++reloads_;
    const std::string title = "glint: " + options_.scene.filename().string();
    const bool another = opensAnother_;
    try {
        useScene(loading_.take());
        model_.sceneError.clear();
        window_.setTitle(title);
        if (another) recent_.add(options_.scene);
        say(another ? "opened " + options_.scene.string() : "loaded " + options_.scene.string() + " again");
    } catch (const Error& e) {
        if (e.kind() != ErrorKind::Scene && e.kind() != ErrorKind::Failed) throw;
        model_.sceneError = e.what();
        err_ << "glint: " << e.what() << '\n';
        if (another) {  // the scene that is shown stays the one that is watched
            options_.scene = scene_->path;
            opensAnother_ = false;
        }
    }
    // A mended file may name others than before; those that changed meanwhile are caught by the next look.
    files_.watch(sceneFiles(options_.scene));
}

void Viewer::startSaving(const std::filesystem::path& file, bool seen) {
    follow(Hint::Save);
    if (!seen) {
        const RenderRequest request = {viewRequest(*session_), file, model_.settings.sampling,
                                       model_.display};
        saving_.start([this, request, moment = momentText()](JobControl& control) {
            std::string line = save(*device_, request, control) + moment;
            Window::wake();
            return line;
        });
        return;
    }
    SeenRequest request = seenRequest(*session_, file, model_.display);
    // What lies over the picture's own colours is seen too.
    if (request.canvas && (difference_ || comparison_.mode != CompareMode::Off))
        request.canvas = background();
    saving_.start([this, request = std::move(request), moment = momentText()](JobControl& control) mutable {
        std::string line = save(*device_, std::move(request), control) + moment;
        Window::wake();
        return line;
    });
}

void Viewer::saveAs() {
    const std::filesystem::path file = model_.saveName.data();
    if (!isWritableImagePath(file)) {
        say("give a name that ends in .png, .exr, .pfm or .hdr", ToastKind::Error);
        return;
    }
    if (saving_.running()) {
        say("still saving; one picture at a time", ToastKind::Error);
        return;
    }
    model_.saveAsVisible = false;
    startSaving(file, model_.savesSeen);
}

void Viewer::startVerifying() {
    if (verifying_.running()) return;
    model_.verdict.clear();
    difference_.reset();
    verifying_.start([this, request = viewRequest(*session_)](JobControl& control) {
        VerifyResult result = verifyView(*device_, request, control);
        Window::wake();
        return result;
    });
}

void Viewer::startReference() {
    if (referring_.running()) return;
    referring_.start([request = viewRequest(*session_), samples = session_->taken()](JobControl& control) {
        Image image = traceReference(request, samples, control);
        Window::wake();
        return image;
    });
}

const Image* Viewer::comparable() const {
    const bool there = session_->samples() > 0 && session_->width() > 0;
    return there ? &session_->picture().color : nullptr;
}

void Viewer::keepPicture() {
    if (!session_->ready()) {
        say("nothing to keep yet", ToastKind::Error);
        return;
    }
    const bool color = model_.settings.layer == ViewLayer::Color;
    comparison_.name = "kept " + std::string(nameOf(model_.settings.layer));
    comparison_.linear.reset();
    comparison_.canvas = {};
    if (color)
        comparison_.linear = *comparable();
    else
        comparison_.canvas = session_->canvas(model_.display);
    ++compared_;
    say("kept this picture; B compares with it");
}

void Viewer::compareWith(const std::filesystem::path& picture) {
    try {
        comparison_.linear = readImage(picture);
        comparison_.canvas = {};
        follow(Hint::Compare);
        comparison_.name = picture.filename().string();
        if (comparison_.mode == CompareMode::Off) comparison_.mode = CompareMode::Wipe;
        ++compared_;
        dirty_ = 3;
    } catch (const Error& e) {
        say(e.what(), ToastKind::Error);
    }
}

void Viewer::drop(const std::vector<std::string>& files) {
    for (const std::string& file : files) {
        if (isPictureFile(file))
            compareWith(file);
        else
            open(file);
    }
}

}  // namespace glint::view
