#include "view/viewer.h"

#include <algorithm>
#include <ostream>
#include <utility>

#include "core/error.h"
#include "core/interrupt.h"

namespace glint::view {

namespace {

constexpr double kGpuTarget = 0.033;
constexpr double kSoftwareTarget =
    0.066;                             // 15 frames/s, so that 10 are left where others use the processor too
constexpr double kWorkSeconds = 0.03;  // of a piece of refining, between two looks at the events
constexpr double kRestFrameSeconds = 0.04;  // between frames at rest, which all but repeat each other
constexpr double kFileSeconds = 0.25;       // between looks at the scene's files
constexpr double kBreathSeconds = 0.005;    // while a frame is not due yet, or the camera may still be moving
constexpr size_t kFrameTimes = 120;

PixelSize sizeOf(const Options& options, const Scene& scene) {
    if (options.width > 0) return {options.width, options.height};
    return {scene.image.width, scene.image.height};
}

}  // namespace

Viewer::Viewer(const Options& options, std::ostream& out, std::ostream& err)
    : options_(options),
      out_(out),
      err_(err),
      scene_(loadViewScene(options.scene, options.maxDepth, options.samplesPerPixel, options.allowOutside)),
      window_(sizeOf(options, scene_->scene), "glint: " + options.scene.filename().string()),
      gui_(window_.scale()),
      control_(scene_->scene.camera),
      pace_(kGpuTarget) {
    if (!options_.script.empty()) script_ = readScript(options_.script);
    for (const std::string& w : scene_->scene.warnings) err_ << "glint: warning: " << w << '\n';
    for (const std::string& w : scene_->packed.warnings)
        err_ << "glint: warning: " << options_.scene.string() << ": " << w << '\n';
    model_.settings = PictureSettings::of(scene_->scene);
    model_.mode = options_.presentMode;
    files_.watch(sceneFiles(options_.scene));
}

Viewer::~Viewer() = default;

void Viewer::openDevice() {
    saving_.stop();
    verifying_.stop();
    if (device_) {
        for (const std::string& message : device_->validationMessages()) validation_.push_back(message);
    }
    session_.reset();
    swapchain_.reset();
    device_.reset();
    gpu::DeviceOptions options;
    options.selector = options_.device;
    options.validation = options_.validation;
    options.window = window_.system();
    device_ = std::make_unique<gpu::Device>(options);
    const PixelSize size = window_.size();
    swapchain_ = std::make_unique<gpu::Swapchain>(*device_, size.width, size.height, model_.mode);
    model_.mode = swapchain_->presentMode();
    model_.modes = gpu::presentModes(*device_);
    model_.device = &device_->info();
    pace_.setTarget(options_.targetSeconds > 0 ? options_.targetSeconds
                    : device_->info().software ? kSoftwareTarget
                                               : kGpuTarget);
    useScene(scene_);
    fillModel();
}

// A driver that crashed once may work again; twice in a session is a fault that more tries would not mend.
void Viewer::recover(const gpu::DeviceLost& lost) {
    if (wasLost_) throw Error(ErrorKind::Device, std::string("the device was lost again: ") + lost.what());
    wasLost_ = true;
    err_ << "glint: warning: " << lost.what() << "; opening it again\n";
    openDevice();
    say("the device was lost and opened again");
}

void Viewer::useScene(std::shared_ptr<const ViewScene> scene) {
    scene_ = std::move(scene);
    session_.reset();
    session_ = std::make_unique<Session>(*device_, scene_);
    if (model_.settings.lights.size() != scene_->scene.lights.size())
        model_.settings.lights.assign(scene_->scene.lights.size(), {});
    session_->apply(model_.settings);
    shownVersion_ = ~uint64_t{0};
    control_.setHome(scene_->scene.camera);
    touchMotion();
    dirty_ = 3;
}

void Viewer::say(const std::string& text) {
    model_.message = text;
    dirty_ = 3;
}

void Viewer::gatherEvents() {
    for (const Event& event : window_.poll()) {
        // Of many steps of the mouse, the last one counts.
        if (event.type == Event::Type::Cursor && !queue_.empty() && queue_.back().type == Event::Type::Cursor)
            queue_.back() = event;
        else
            queue_.push_back(event);
    }
}

bool Viewer::inputWaits() const {
    return std::any_of(queue_.begin(), queue_.end(), [&](const Event& e) {
        return e.type != Event::Type::Redraw && (e.type != Event::Type::Cursor || dragging_.has_value());
    });
}

bool Viewer::hasWork() const {
    const bool driven = !scriptIdles_ && (scripted() || options_.frames > 0);
    return driven || !queue_.empty() || dirty_ > 0 || moving() || !held_.empty() || !session_->finished();
}

bool Viewer::work() {
    const PixelSize size = window_.size();
    if (size.width != session_->width() || size.height != session_->height()) touchMotion();
    session_->setView(control_.camera(), size.width, size.height);
    const double pixels = static_cast<double>(size.width) * size.height;
    const bool before = std::exchange(traced_, false);
    if (moving()) {
        const double scale = pace_.scale(pixels);
        if (session_->renderMoving(scale, pace_.depth(model_.settings.maxDepth, pixels))) {
            traced_ = true;
            follows_ = before;
            const FrameFacts& facts = session_->facts();
            // Waiting for the screen is no work, but on a software device presenting is copying.
            const double other = model_.drawSeconds + (device_->info().software ? model_.presentSeconds : 0);
            pace_.measured(static_cast<double>(facts.width) * facts.height, facts.renderSeconds, other);
            dirty_ = std::max(dirty_, 1);
        }
        return traced_;
    }
    const auto cancelled = [&] {
        gatherEvents();
        return inputWaits();
    };
    const bool refined = session_->refine(kWorkSeconds, cancelled);
    if (refined) dirty_ = std::max(dirty_, 1);
    return refined;
}

void Viewer::startLoading() {
    const Options options = options_;
    loading_.start([options](JobControl&) {
        auto scene =
            loadViewScene(options.scene, options.maxDepth, options.samplesPerPixel, options.allowOutside);
        Window::wake();
        return scene;
    });
    dirty_ = 3;
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
        if (!job.finished()) return;
        dirty_ = 3;
        try {
            use(job.take());
        } catch (const gpu::DeviceLost&) {
            throw;
        } catch (const std::exception& e) {
            say(e.what());
            err_ << "glint: " << e.what() << '\n';
        }
    };
    collect(saving_, [&](const std::string& line) {
        say(line);
        out_ << line << std::endl;
    });
    collect(verifying_, [&](VerifyResult result) {
        model_.verdict = result.text;
        model_.verdictPassed = result.passed;
        out_ << "verify " << result.text << std::endl;
        Picture picture;
        picture.region = {0, 0, result.difference.width, result.difference.height};
        picture.color = Image(result.difference.width, result.difference.height, 4, 1.0f);
        for (size_t i = 0; i < picture.color.pixels.size(); ++i) {
            if (i % 4 < 3) picture.color.pixels[i] = result.difference.pixels[i / 4 * 3 + i % 4];
        }
        difference_ = colorize(picture, ViewLayer::Color, 0);
    });
    if (!loading_.finished()) return;
    dirty_ = 3;
    ++reloads_;
    try {
        useScene(loading_.take());
        model_.sceneError.clear();
        say("loaded " + options_.scene.string() + " again");
    } catch (const Error& e) {
        if (e.kind() != ErrorKind::Scene && e.kind() != ErrorKind::Failed) throw;
        model_.sceneError = e.what();
        err_ << "glint: " << e.what() << '\n';
    }
    // A mended file may name others than before; those that changed meanwhile are caught by the next look.
    files_.watch(sceneFiles(options_.scene));
}

void Viewer::fillModel() {
    model_.scene = &scene_->scene;
    model_.facts = session_->facts();
    model_.moving = moving();
    model_.samples = session_->samples();
    model_.progress = session_->progress();
    model_.finished = session_->finished();
    model_.frameTimes = &frameTimes_;
    model_.saveProgress = saving_.running() ? saving_.progress() : -1;
    model_.verifyProgress = verifying_.running() ? verifying_.progress() : -1;
    model_.loading = loading_.running();
    model_.pick = &pick_;
    model_.targetSeconds = pace_.target();
    model_.hasFov = !control_.camera().window && control_.camera().projection == Projection::Perspective;
    model_.fovY = control_.camera().fovY;
}

void Viewer::takeSettings() {
    if (!(model_.settings == session_->settings())) {
        const bool retraces = model_.settings.sampleLimit == session_->settings().sampleLimit;
        session_->apply(model_.settings);
        if (retraces) touchMotion();
        dirty_ = 3;
    }
}

// What the user has changed in the panel.
void Viewer::takeModel() {
    takeSettings();
    if (model_.exposure != shownExposure_) dirty_ = std::max(dirty_, 1);
    if (model_.hasFov && model_.fovY != control_.camera().fovY) {
        control_.zoom(model_.fovY / control_.camera().fovY);
        touchMotion();
    }
    pace_.setTarget(model_.targetSeconds);
    if (model_.mode != swapchain_->presentMode()) {
        const PixelSize size = window_.size();
        swapchain_.reset();
        swapchain_ = std::make_unique<gpu::Swapchain>(*device_, size.width, size.height, model_.mode);
        model_.mode = swapchain_->presentMode();
    }
}

const Canvas& Viewer::background() {
    const bool wantsDifference = difference_.has_value();
    const bool same = session_->version() == shownVersion_ && model_.exposure == shownExposure_ &&
                      wantsDifference == showsDifference_;
    if (same) return background_;
    shownVersion_ = session_->version();
    shownExposure_ = model_.exposure;
    showsDifference_ = wantsDifference;
    if (wantsDifference) {
        background_ = Canvas(session_->width(), session_->height());
        stretch(*difference_, background_, false);
    } else {
        background_ = session_->canvas(model_.exposure);
    }
    return background_;
}

void Viewer::drawFrame() {
    const Stopwatch drawing;
    frame_ = background();
    if (frame_.width == 0) return;
    fillModel();
    gui_.begin(frame_.width, frame_.height, frameWatch_.seconds());
    drawPanel(gui_, model_);
    gui_.end(frame_);
    model_.drawSeconds = drawing.seconds();
    const Stopwatch presenting;
    swapchain_->present(frame_.pixels, frame_.width, frame_.height);
    model_.presentSeconds = presenting.seconds();
    model_.frameSeconds = frameWatch_.seconds();
    frameWatch_.restart();
    if (traced_ && follows_) {  // the first after a rest has waited for the user
        frameTimes_.push_back(static_cast<float>(model_.frameSeconds * 1e3));
        if (frameTimes_.size() > kFrameTimes) frameTimes_.erase(frameTimes_.begin());
    }
    ++frames_;
    dirty_ = std::max(0, dirty_ - 1);
    takeModel();
}

void Viewer::round() {
    if (!hasWork()) window_.wait(saving_.running() || verifying_.running() ? 0.1 : kFileSeconds);
    gatherEvents();
    runScript();
    handleEvents();
    flyOn(roundWatch_.seconds());
    roundWatch_.restart();
    pollJobs();
    pollFiles();
    if (interrupted()) closing_ = true;
    if (closing_) return;
    if (window_.minimised()) {
        window_.wait(0.1);
        return;
    }
    const bool worked = work();
    const bool forced = !scriptIdles_ && (options_.frames > 0 || scripted());
    const bool due = moving() || !queue_.empty() || frameWatch_.seconds() > kRestFrameSeconds;
    const bool draws = forced || (dirty_ > 0 && due);
    if (draws) drawFrame();
    if (!draws && !worked) window_.wait(kBreathSeconds);
    if (scripted()) return;
    if (options_.frames > 0 && frames_ >= options_.frames) closing_ = true;
    if (options_.frames == 0 && !script_.empty() && !scriptStays_) closing_ = true;
}

void Viewer::reportValidation() {
    if (!options_.validation) return;
    if (!device_->validationActive()) {
        throw Error(ErrorKind::Device,
                    "the validation layer VK_LAYER_KHRONOS_validation is not installed (Debian package "
                    "vulkan-validationlayers)");
    }
    for (const std::string& message : device_->validationMessages()) validation_.push_back(message);
    for (const std::string& message : validation_) err_ << "glint: validation: " << message << '\n';
    if (!validation_.empty())
        throw Error(ErrorKind::Device, "the validation layer found faults (listed above)");
}

void Viewer::run() {
    installInterruptHandler();
    openDevice();
    while (!closing_) {
        try {
            round();
        } catch (const gpu::DeviceLost& lost) {
            recover(lost);
        }
    }
    saving_.stop();
    verifying_.stop();
    loading_.stop();
    session_.reset();
    swapchain_.reset();
    reportValidation();
}

void view(const Options& options, std::ostream& out, std::ostream& err) {
    if (!options.script.empty()) readScript(options.script);  // its faults are told before a window opens
    Viewer viewer(options, out, err);
    viewer.run();
}

}  // namespace glint::view
