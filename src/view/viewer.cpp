#include "view/viewer.h"

#include <algorithm>
#include <ostream>
#include <utility>

#include "core/error.h"
#include "core/interrupt.h"
#include "view/panel.h"

namespace glint::view {

namespace {

constexpr double kGpuTarget = 0.033;
constexpr double kSoftwareTarget = 0.066;   // 15 frames/s on the processor
constexpr double kWorkSeconds = 0.03;       // of a piece of refining, between two looks at the events
constexpr double kRestFrameSeconds = 0.04;  // between frames at rest, which differ little
constexpr double kBreathSeconds = 0.005;    // while a frame is not due yet
constexpr double kPollSeconds = 0.25;       // between looks at files and messages at rest
constexpr double kJobSeconds = 0.1;         // and at jobs
constexpr size_t kFrameTimes = 120;
constexpr PixelSize kLeastSize{1280, 800};
constexpr double kPanelWidth = 245;  // docked, at scale 1

// Without a size from the user: at least kLeastSize, and wide enough that the image beside the panel shows
// all that an image of the scene's proportions shows, if the screen allows.
PixelSize sizeOf(const Options& options, const Scene& scene) {
    if (options.width > 0) return {options.width, options.height};
    const int height = std::max(scene.image.height, kLeastSize.height);
    const double aspect = static_cast<double>(scene.image.width) / scene.image.height;
    const double panel = kPanelWidth * std::max(options.scale, 1.0);
    return {std::max(static_cast<int>(height * aspect + panel), kLeastSize.width), height};
}

}  // namespace

Viewer::Viewer(const Options& options, std::ostream& out, std::ostream& err)
    : options_(options),
      err_(err),
      model_(options),
      window_(sizeOf(options, *model_.file), "glint: " + options.scene.filename().string()),
      gui_(options.scale > 0 ? static_cast<float>(options.scale) : window_.scale(), window_),
      commands_(model_, window_, out, err),
      input_(model_, commands_, gui_),
      pace_(kGpuTarget),
      restless_(options.frames > 0) {
    model_.sayWarnings(err);
}

// The session must go before its device.
Viewer::~Viewer() {
    commands_.releaseDevice();
}

void Viewer::openDevice() {
    commands_.releaseDevice();
    if (device_) {
        for (const std::string& message : device_->validationMessages()) validation_.push_back(message);
    }
    swapchain_.reset();
    device_.reset();
    gpu::DeviceOptions options;
    options.selector = options_.device;
    options.validation = options_.validation;
    options.window = window_.system();
    checkRoom(window_.size());
    device_ = std::make_unique<gpu::Device>(options);
    const PixelSize size = window_.size();
    swapchain_ = std::make_unique<gpu::Swapchain>(*device_, size.width, size.height, options_.presentMode);
    model_.targetSeconds = options_.targetSeconds > 0 ? options_.targetSeconds
                           : device_->info().software ? kSoftwareTarget
                                                      : kGpuTarget;
    commands_.setDevice(*device_);
    showView();
}

// Throws Error(Failed) if there is no memory for a window of this size, beside what the present size holds.
void Viewer::checkRoom(PixelSize size) const {
    const uint64_t free = options_.memory();
    const Session* session = model_.session.get();
    const uint64_t pixels = session ? static_cast<uint64_t>(session->width()) * session->height() : 0;
    const uint64_t held = std::min(pixels * Session::bytesPerPixel(), ~free);
    checkMemory(size.width, size.height, Session::bytesPerPixel(), free + held, "");
}

// A driver that crashed once may work again; a second crash is a fault that further tries do not fix.
void Viewer::recover(const gpu::DeviceLost& lost) {
    if (wasLost_) throw Error(ErrorKind::Device, std::string("the device was lost again: ") + lost.what());
    wasLost_ = true;
    err_ << "glint: warning: " << lost.what() << "; opening it again\n";
    openDevice();
    model_.say("the device was lost and opened again", ToastKind::Error);
}

void Viewer::gatherEvents() {
    for (const Event& event : window_.poll()) input_.push(event);
}

bool Viewer::hasWork() const {
    return restless_ || !input_.queue().empty() || model_.dirty > 0 || model_.moving() || input_.flies() ||
           model_.timeline.playing() || !model_.session->rested();
}

// The camera, and the part of the window that the panel leaves.
void Viewer::showView() {
    PixelSize size = window_.size();
    const int left = model_.docked && model_.panelVisible ? dockWidth(gui_, size.width) : 0;
    input_.shift(left - std::exchange(model_.left, left));
    size.width -= left;
    if (size.width != model_.session->width() || size.height != model_.session->height()) {
        checkRoom(size);
        model_.touch();
        model_.forgetView();
    }
    model_.session->setView(model_.control.camera(), size.width, size.height);
}

// False if there was nothing to trace.
bool Viewer::work() {
    showView();
    if (model_.moving()) return renderMoving();
    const auto cancelled = [&] {
        gatherEvents();
        return input_.waits();
    };
    const uint64_t version = model_.session->version();
    const bool refined = model_.session->refine(kWorkSeconds, cancelled);
    // Layers that are not shown are traced ahead; the screen stays.
    if (refined && (model_.session->version() != version || model_.inspects))
        model_.dirty = std::max(model_.dirty, 1);
    return refined;
}

bool Viewer::renderMoving() {
    Session& session = *model_.session;
    const double pixels = static_cast<double>(session.width()) * session.height();
    if (!session.renderMoving(pace_.scale(pixels), pace_.depth(static_cast<int>(model_.settings.depth()),
                                                               pixels, model_.scene->hasGlass)))
        return false;
    const FrameFacts& facts = session.facts();
    // Waiting for the screen is no work, but on a software device presenting is copying.
    const double other = model_.drawSeconds + (device_->info().software ? model_.presentSeconds : 0);
    pace_.measured(static_cast<double>(facts.width) * facts.height, facts.renderSeconds, other);
    model_.dirty = std::max(model_.dirty, 1);
    return true;
}

void Viewer::drawFrame() {
    const Stopwatch drawing;
    const Canvas& picture = commands_.refreshPicture();
    if (picture.width == 0) return;
    frame_ = Canvas(model_.left + picture.width, picture.height);
    for (int y = 0; y < picture.height; ++y)
        std::copy_n(picture.row(y), picture.width, frame_.row(y) + model_.left);
    input_.inspect();
    gui_.begin(frame_.width, frame_.height, frameWatch_.seconds());
    drawPanel(gui_, model_);
    gui_.end(frame_);
    model_.drawSeconds = drawing.seconds();
    const Stopwatch presenting;
    swapchain_->present(frame_.pixels, frame_.width, frame_.height);
    model_.presentSeconds = presenting.seconds();
    model_.frameSeconds = frameWatch_.seconds();
    frameWatch_.restart();
    if (std::exchange(moves_, model_.moving()) &&
        moves_) {  // the first frame after a rest waited for the user
        model_.frameTimes.push_back(static_cast<float>(model_.frameSeconds * 1e3));
        if (model_.frameTimes.size() > kFrameTimes) model_.frameTimes.erase(model_.frameTimes.begin());
    }
    ++frames_;
    model_.dirty = std::max(0, model_.dirty - 1);
    takePanel();
}

// Applies changes made in the panel.
void Viewer::takePanel() {
    commands_.takeSettings();
    model_.session->wantData(model_.inspects);
    pace_.setTarget(model_.targetSeconds);
    if (const Command wish = std::exchange(model_.wish, nullptr)) {
        model_.history.endStep();
        commands_.perform(wish);
    }
}

void Viewer::round() {
    if (!hasWork()) window_.wait(commands_.hasJobs() ? kJobSeconds : kPollSeconds);
    gatherEvents();
    input_.handle();
    input_.flyOn(roundWatch_.seconds());
    roundWatch_.restart();
    commands_.noteChanges();
    commands_.poll();
    if (interrupted() || commands_.closing()) return;
    if (window_.minimised()) {
        window_.wait(0.1);
        return;
    }
    if (model_.toasts.expire(model_.clock.seconds())) model_.dirty = std::max(model_.dirty, 2);
    if (commands_.flashChanged()) model_.dirty = std::max(model_.dirty, 1);
    const bool worked = work();
    const bool due = model_.moving() || !input_.queue().empty() || frameWatch_.seconds() > kRestFrameSeconds;
    const bool draws = restless_ || (model_.dirty > 0 && due);
    if (draws) drawFrame();
    if (!draws && !worked) window_.wait(kBreathSeconds);
    if (options_.frames > 0 && frames_ >= options_.frames && !model_.isClosing) commands_.askToClose();
}

void Viewer::reportValidation() {
    if (!options_.validation) return;
    for (const std::string& message : device_->validationMessages()) validation_.push_back(message);
    for (const std::string& message : validation_) err_ << "glint: validation: " << message << '\n';
    if (!validation_.empty())
        throw Error(ErrorKind::Device, "the validation layer found faults (listed above)");
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
    return !interrupted() && !commands_.closing();
}

void Viewer::close() {
    std::string lost;
    try {
        commands_.close();
    } catch (const Error& e) {
        lost = e.what();
    }
    swapchain_.reset();
    reportValidation();
    if (!lost.empty() && !interrupted()) throw Error(ErrorKind::Failed, lost);
}

void view(const Options& options, std::ostream& out, std::ostream& err) {
    Viewer viewer(options, out, err);
    viewer.open();
    while (viewer.step()) continue;
    viewer.close();
}

}  // namespace glint::view
