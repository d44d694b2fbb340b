#include "view/viewer.h"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <utility>

#include "core/error.h"
#include "core/interrupt.h"
#include "view/state_folder.h"

namespace glint::view {

namespace {

constexpr double kGpuTarget = 0.033;
constexpr double kSoftwareTarget =
    0.066;                             // 15 frames/s, so that 10 are left where others use the processor too
constexpr double kWorkSeconds = 0.03;  // of a piece of refining, between two looks at the events
constexpr double kRestFrameSeconds = 0.04;  // between frames at rest, which all but repeat each other
constexpr double kBreathSeconds = 0.005;    // while a frame is not due yet, or the camera may still be moving
constexpr double kFlickerSeconds = 0.5;     // that each of two pictures is seen
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
      moments_(std::make_shared<Moments>(options.scene, options.loading, options.time)),
      scene_(moments_->show().scene),
      timeAtWork_(options.time),
      time_(options.time),
      window_(sizeOf(options, scene_->scene), "glint: " + options.scene.filename().string()),
      gui_(options.scale > 0 ? static_cast<float>(options.scale) : window_.scale(),
           {[this] { return window_.clipboard(); },
            [this](const std::string& text) { window_.setClipboard(text); }}),
      control_(scene_->scene.camera, boundsOf(*scene_).radius),
      pace_(kGpuTarget),
      recent_(stateFile("recent")),
      hints_(stateFile("hints")),
      seenCamera_(scene_->scene.camera) {
    fileScene_ = {scene_, &scene_->scene};
    for (const std::string& w : scene_->scene.warnings) err_ << "glint: warning: " << w << '\n';
    for (const std::string& w : scene_->packed.warnings)
        err_ << "glint: warning: " << options_.scene.string() << ": " << w << '\n';
    model_.settings = model_.fileSettings = PictureSettings::of(scene_->scene);
    model_.settings.until = options_.until;
    model_.edits = model_.fileEdits = editsAtWork_ = SceneEdits::of(scene_->scene);
    timeline_.follow(scene_->scene.animation);
    timeline_.setTime(options_.time);
    model_.timeline = &timeline_;
    model_.mode = options_.presentMode;
    for (size_t i = 0; i < fileCameras().size(); ++i)
        if (fileCameras()[i].name == options_.loading.camera) model_.camera = i;
    model_.comparison = &comparison_;
    model_.toasts = &toasts_.shown();
    restless_ = options_.frames > 0;
    model_.openFolder = std::filesystem::absolute(options_.scene).parent_path();
    recent_.add(options_.scene);
    files_.watch(sceneFiles(options_.scene));
}

Viewer::~Viewer() = default;

void Viewer::openDevice() {
    if (saving_.running()) err_ << "glint: warning: the picture that was being saved is lost\n";
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
    const PixelSize size = window_.size();
    checkRoom(size);
    device_ = std::make_unique<gpu::Device>(options);
    swapchain_ = std::make_unique<gpu::Swapchain>(*device_, size.width, size.height, model_.mode);
    model_.mode = swapchain_->presentMode();
    model_.modes = gpu::presentModes(*device_);
    model_.device = &device_->info();
    pace_.setTarget(options_.targetSeconds > 0 ? options_.targetSeconds
                    : device_->info().software ? kSoftwareTarget
                                               : kGpuTarget);
    showScene(scene_);
    fillModel();
}

// Whether there is memory for a window of this size; what the one that there is has taken may be taken again.
void Viewer::checkRoom(PixelSize size) const {
    const uint64_t free = options_.memory();
    const uint64_t pixels = session_ ? static_cast<uint64_t>(session_->width()) * session_->height() : 0;
    const uint64_t held = std::min(pixels * Session::bytesPerPixel(), ~free);
    checkMemory(size.width, size.height, Session::bytesPerPixel(), free + held, "");
}

// A driver that crashed once may work again; twice in a session is a fault that more tries would not mend.
void Viewer::recover(const gpu::DeviceLost& lost) {
    if (wasLost_) throw Error(ErrorKind::Device, std::string("the device was lost again: ") + lost.what());
    wasLost_ = true;
    err_ << "glint: warning: " << lost.what() << "; opening it again\n";
    openDevice();
    say("the device was lost and opened again", ToastKind::Error);
}

void Viewer::say(const std::string& text, ToastKind kind) {
    lastSaid_ = text;
    toasts_.add(text, kind, clock_.seconds());
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
    return restless_ || !queue_.empty() || dirty_ > 0 || moving() || !held_.empty() || timeline_.playing() ||
           !session_->rested();
}

double Viewer::restSeconds() const {
    const bool busy = saving_.running() || verifying_.running() || referring_.running() || packing_.running();
    double seconds = busy ? 0.1 : kFileSeconds;
    const double toast = toasts_.next(clock_.seconds());
    if (toast >= 0) seconds = std::min(seconds, toast);
    return seconds;
}

// The camera, and as much of the window as the panel leaves.
void Viewer::showView() {
    PixelSize size = window_.size();
    const int left = model_.docked && model_.panelVisible ? dockWidth(gui_, size.width) : 0;
    cursorX_ += std::exchange(left_, left) - left;
    size.width -= left;
    if (size.width != session_->width() || size.height != session_->height()) {
        checkRoom(size);
        touchMotion();
        forgetPick(false);
    }
    session_->setView(control_.camera(), size.width, size.height);
}

bool Viewer::work() {
    showView();
    const double pixels = static_cast<double>(session_->width()) * session_->height();
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
    const uint64_t version = session_->version();
    const bool refined = session_->refine(kWorkSeconds, cancelled);
    // What is traced ahead for other layers changes nothing on the screen.
    if (refined && (session_->version() != version || model_.inspects)) dirty_ = std::max(dirty_, 1);
    return refined;
}

void Viewer::drawFrame() {
    const Stopwatch drawing;
    const Canvas& picture = background();
    if (picture.width == 0) return;
    if (left_ == 0) {
        frame_ = picture;
    } else {
        frame_ = Canvas(left_ + picture.width, picture.height);
        for (int y = 0; y < picture.height; ++y)
            std::copy_n(picture.row(y), picture.width, frame_.row(y) + left_);
    }
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

bool Viewer::flash() const {
    return std::fmod(clock_.seconds(), 2 * kFlickerSeconds) >= kFlickerSeconds;
}

// A picture that is being saved is finished first; who asks twice does not want it.
void Viewer::askToClose() {
    if (!saving_.running() || closingAsked_) {
        closing_ = true;
        return;
    }
    closingAsked_ = true;
    say("closing once the picture is saved; again: at once");
}

void Viewer::round() {
    if (!hasWork()) window_.wait(restSeconds());
    gatherEvents();
    handleEvents();
    flyOn(roundWatch_.seconds());
    noteCamera();
    roundWatch_.restart();
    playOn();
    pollJobs();
    pollFiles();
    if (interrupted() || (closingAsked_ && !saving_.running())) closing_ = true;
    if (closing_) return;
    if (window_.minimised()) {
        window_.wait(0.1);
        return;
    }
    if (toasts_.expire(clock_.seconds())) dirty_ = std::max(dirty_, 2);
    if (comparison_.mode == CompareMode::Flicker && comparison_.any() && flash() != shown_.flash)
        dirty_ = std::max(dirty_, 1);
    const bool worked = work();
    const bool due = moving() || !queue_.empty() || frameWatch_.seconds() > kRestFrameSeconds;
    const bool draws = restless_ || (dirty_ > 0 && due);
    if (draws) drawFrame();
    if (!draws && !worked) window_.wait(kBreathSeconds);
    if (options_.frames > 0 && frames_ >= options_.frames && !closingAsked_) askToClose();
}

void Viewer::reportValidation() {
    if (!options_.validation) return;
    for (const std::string& message : device_->validationMessages()) validation_.push_back(message);
    for (const std::string& message : validation_) err_ << "glint: validation: " << message << '\n';
    if (!validation_.empty())
        throw Error(ErrorKind::Device, "the validation layer found faults (listed above)");
}

// Who closes the window while a picture is being saved is told if it is lost.
void Viewer::close() {
    const bool cut = saving_.running();
    saving_.stop();
    verifying_.stop();
    referring_.stop();
    loading_.stop();
    packing_.stop();
    session_.reset();
    swapchain_.reset();
    reportValidation();
    if (cut && !interrupted())
        throw Error(ErrorKind::Failed, "the window was closed before the picture was saved");
    if (closingAsked_ && !lostPicture_.empty()) throw Error(ErrorKind::Failed, lostPicture_);
}

void Viewer::open() {
    installInterruptHandler();
    openDevice();
}

bool Viewer::step() {
    try {
        round();
    } catch (const gpu::DeviceLost& lost) {
        recover(lost);
    }
    return !closing_;
}

void view(const Options& options, std::ostream& out, std::ostream& err) {
    Viewer viewer(options, out, err);
    viewer.open();
    while (viewer.step()) continue;
    viewer.close();
}

}  // namespace glint::view
