#include "view/viewer.h"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <utility>

#include "core/error.h"
#include "core/interrupt.h"
#include "view/panel.h"

namespace glint::view {

namespace {

constexpr double kClickPixels = 4;          // a click moves the mouse by less
constexpr double kTurnPerHeight = 3.14159;  // radians for a drag across the image's height
constexpr double kWheelStep = 0.9;
constexpr double kFlySeconds = 3;  // to cross the scene's radius
constexpr double kWipePixels = 6;  // from the wipe's line, within which a press takes hold of it

constexpr double kGpuTarget = 0.033;
constexpr double kSoftwareTarget = 0.066;   // 15 frames/s on the processor
constexpr double kWorkSeconds = 0.03;       // of a piece of refining, between two looks at the events
constexpr double kRestFrameSeconds = 0.04;  // between frames at rest, which differ little
constexpr double kBreathSeconds = 0.005;    // while a frame is not due yet
constexpr double kPollSeconds = 0.25;       // between looks at files and messages at rest
constexpr double kJobSeconds = 0.1;         // and at jobs
constexpr PixelSize kLeastSize{1280, 800};
constexpr double kPanelWidth = 245;  // docked, at scale 1

// Without a size from the user: at least kLeastSize, and wide enough for the panel and a full image of the
// scene's proportions, if the screen allows.
PixelSize sizeOf(const Options& options, const Scene& scene) {
    if (options.width > 0) return {options.width, options.height};
    const int height = std::max(scene.image.height, kLeastSize.height);
    const double aspect = static_cast<double>(scene.image.width) / scene.image.height;
    const double panel = kPanelWidth * std::max(options.scale, 1.0);
    return {std::max(static_cast<int>(height * aspect + panel), kLeastSize.width), height};
}

}  // namespace

// ---- mouse and keyboard ----

bool Input::waits() const {
    return std::any_of(queue_.begin(), queue_.end(), [&](const Event& e) {
        return e.type != Event::Type::Redraw && (e.type != Event::Type::Cursor || dragging_.has_value());
    });
}

void Input::handle() {
    while (!queue_.empty()) {
        const Event event = queue_.front();
        queue_.pop_front();
        m_.redraw(2);
        if (!handle(event)) return;
    }
}

// False if the rest of the queue must wait for the next frame.
bool Input::handle(const Event& event) {
    if (event.type != Event::Type::Wheel || covered()) gui_.feed(event);
    switch (event.type) {
        case Event::Type::Close:
            askToClose(m_);
            break;
        case Event::Type::Drop:
            for (const std::string& file : event.files) open(m_, file);
            break;
        case Event::Type::Resize:
            m_.touch();
            break;
        case Event::Type::Cursor: {
            const glm::dvec2 before = std::exchange(cursor_, {event.x - m_.left, event.y});
            if (draggingWipe_)
                m_.comparison.wipe = std::clamp(cursor_.x / std::max(m_.session->width(), 1), 0.0, 1.0);
            else if (dragging_)
                drag(cursor_ - before);
            break;
        }
        case Event::Type::Button:
            press(event);
            return false;  // ImGui needs a press and its release in different frames
        case Event::Type::Wheel:
            if (covered()) return false;
            if (!m_.moving()) m_.history.endStep();
            m_.control.dolly(std::pow(kWheelStep, event.y));
            break;
        case Event::Type::Key:
            key(event);
            return !gui_.wantsKeys();
        case Event::Type::Text:
            if (!gui_.wantsKeys() && event.code == '?') m_.helpVisible = !m_.helpVisible;
            break;
        case Event::Type::Redraw:
            break;
    }
    return true;
}

void Input::press(const Event& event) {
    const int button = event.code;
    if (event.down) {
        m_.history.endStep();
        if (covered() || dragging_) return;
        dragging_ = button;
        dragMods_ = event.mods;
        dragged_ = false;
        pressed_ = cursor_;
        const double line = m_.comparison.wipe * m_.session->width();
        draggingWipe_ = button == GLFW_MOUSE_BUTTON_LEFT && m_.compares() &&
                        m_.comparison.mode == CompareMode::Wipe && std::abs(cursor_.x - line) <= kWipePixels;
        return;
    }
    if (dragging_ != button) return;
    dragging_.reset();
    if (std::exchange(draggingWipe_, false) || button != GLFW_MOUSE_BUTTON_LEFT || dragged_) return;
    const auto x = static_cast<int>(pressed_.x), y = static_cast<int>(pressed_.y);
    (dragMods_ & kControl) != 0 ? focusAt(m_, x, y) : pick(m_, x, y);
}

void Input::drag(const glm::dvec2& by) {
    glm::dvec2 step = by;
    if (!dragged_) {
        step = cursor_ - pressed_;
        if (std::hypot(step.x, step.y) < kClickPixels) return;
        dragged_ = true;
    }
    step /= std::max(m_.session->height(), 1);
    const bool shifted = (dragMods_ & kShift) != 0;
    if (dragging_ == GLFW_MOUSE_BUTTON_MIDDLE || (dragging_ == GLFW_MOUSE_BUTTON_LEFT && shifted))
        m_.control.pan(step.x, step.y);
    else if (dragging_ == GLFW_MOUSE_BUTTON_RIGHT)
        m_.control.dolly(std::exp2(2 * step.y));
    else if (m_.flying)
        m_.control.look(kTurnPerHeight / 2 * step.x, kTurnPerHeight / 2 * step.y);
    else
        m_.control.orbit(kTurnPerHeight * step.x, kTurnPerHeight * step.y);
}

void Input::key(const Event& event) {
    if (!event.down) {
        held_.erase(event.code);
        return;
    }
    if (gui_.wantsKeys()) {
        if (event.code == GLFW_KEY_ESCAPE) m_.saveAsVisible = m_.saveSceneVisible = m_.openVisible = false;
        return;
    }
    if (event.code == GLFW_KEY_ESCAPE && gui_.closePopups()) return;
    fastFlight_ = (event.mods & kShift) != 0;
    if (m_.flying && isFlyKey(event.code, event.mods)) {
        if (held_.empty()) m_.history.endStep();
        held_.insert(event.code);
        return;
    }
    const KeyBinding* binding = bindingOf(event.code, event.mods);
    if (binding == nullptr) return;
    if (!event.repeat) m_.history.endStep();
    perform(m_, binding->run);
    if (!m_.flying) held_.clear();
}

void Input::flyOn(double seconds) {
    if (held_.empty()) return;
    const auto axis = [&](int plus, int minus) {
        return static_cast<double>(held_.count(plus)) - static_cast<double>(held_.count(minus));
    };
    const double speed = m_.flySpeed * boundsOf(*m_.scene).radius / kFlySeconds * (fastFlight_ ? 4 : 1);
    const double step = speed * std::min(seconds, 0.25);
    m_.control.move(step * glm::dvec3(axis('D', 'A'), axis('E', 'Q'), axis('W', 'S')));
    m_.touch();
}

// If the inspector forgot its pixel over its own slider, it would shrink, and a press would miss the slider.
void Input::inspect() {
    const glm::ivec2 under(std::floor(cursor_.x), std::floor(cursor_.y));
    if (m_.session->contains(under.x, under.y) && !covered()) m_.pixel = under;
    if (!m_.inspects || (m_.pixel && !m_.session->contains(m_.pixel->x, m_.pixel->y))) m_.pixel.reset();
}

// ---- the loop ----

Viewer::Viewer(const Options& options, std::ostream& out, std::ostream& err)
    : options_(options),
      err_(err),
      model_(options, out, err),
      window_(sizeOf(options, *model_.file), "glint: " + options.scene.filename().string()),
      gui_(options.scale > 0 ? static_cast<float>(options.scale) : window_.scale(), window_),
      input_(model_, gui_, window_.events),
      pace_(kGpuTarget),
      restless_(options.frames > 0) {
    model_.window = &window_;
    model_.sayWarnings();
}

// The session must go before its device, and jobs before the window, which they wake.
Viewer::~Viewer() {
    releaseDevice(model_);
    for (Job* job : model_.jobs) job->stop();
}

void Viewer::openDevice() {
    releaseDevice(model_);
    if (device_)
        for (const std::string& message : device_->validationMessages()) validation_.push_back(message);
    swapchain_.reset();
    device_.reset();
    gpu::DeviceOptions options;
    options.selector = options_.device;
    options.validation = options_.validation;
    options.window = window_.system();
    checkRoom(window_.size());
    device_ = std::make_unique<gpu::Device>(options);
    const PixelSize size = window_.size();
    swapchain_ = std::make_unique<gpu::Swapchain>(*device_, size.width, size.height);
    model_.targetSeconds = device_->info().software ? kSoftwareTarget : kGpuTarget;
    setDevice(model_, *device_);
    showView();
}

// Throws Error(Failed) if there is no memory for a window of this size while the present one is held.
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

bool Viewer::hasWork() const {
    return restless_ || !window_.events.empty() || model_.dirty > 0 || model_.moving() || input_.flies() ||
           model_.timeline.playing() || !model_.session->finished();
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
        Window::poll();
        return input_.waits();
    };
    const uint64_t version = model_.session->version();
    const bool refined = model_.session->refine(kWorkSeconds, cancelled);
    // The screen stays while layers that are not shown are traced.
    if (refined && (model_.session->version() != version || model_.inspects)) model_.redraw(1);
    return refined;
}

bool Viewer::renderMoving() {
    Session& session = *model_.session;
    const double pixels = static_cast<double>(session.width()) * session.height();
    const int depth = pace_.depth(static_cast<int>(model_.settings.depth()), pixels,
                                  model_.scene->packed.features.transmission);
    if (!session.renderMoving(pace_.scale(pixels), depth)) return false;
    const FrameFacts& facts = session.facts();
    // Waiting for the screen is no work, but on a software device presenting is copying.
    const double other = model_.drawSeconds + (device_->info().software ? model_.presentSeconds : 0);
    pace_.measured(static_cast<double>(facts.width) * facts.height, facts.renderSeconds, other);
    model_.redraw(1);
    return true;
}

void Viewer::drawFrame() {
    const Stopwatch drawing;
    const Canvas& picture = refreshPicture(model_);
    if (picture.width == 0) return;
    frame_ = Canvas(model_.left + picture.width, picture.height);
    for (int y = 0; y < picture.height; ++y)
        std::copy_n(picture.row(y), picture.width, frame_.row(y) + model_.left);
    input_.inspect();
    gui_.begin(frame_.width, frame_.height, frameWatch_.seconds());
    drawPanel(model_);
    gui_.end(frame_);
    model_.drawSeconds = drawing.seconds();
    const Stopwatch presenting;
    swapchain_->present(frame_.pixels, frame_.width, frame_.height);
    model_.presentSeconds = presenting.seconds();
    model_.frameSeconds = frameWatch_.seconds();
    frameWatch_.restart();
    ++frames_;
    model_.dirty = std::max(0, model_.dirty - 1);
    takePanel();
}

// Applies changes made in the panel. All changes by a control, until another one takes the keyboard, are one
// step of undo.
void Viewer::takePanel() {
    takeSettings(model_);
    if (gui_.leftControl()) {
        noteChanges(model_);
        model_.history.endStep();
    }
    pace_.setTarget(model_.targetSeconds);
    if (const Command wish = std::exchange(model_.wish, nullptr)) {
        model_.history.endStep();
        perform(model_, wish);
    }
}

void Viewer::round() {
    if (!hasWork()) window_.wait(model_.busy() ? kJobSeconds : kPollSeconds);
    Window::poll();
    input_.handle();
    input_.flyOn(roundWatch_.seconds());
    roundWatch_.restart();
    noteChanges(model_);
    poll(model_);
    if (interrupted() || model_.closes) return;
    if (window_.minimised()) {
        window_.wait(0.1);
        return;
    }
    if (model_.toasts.expire(model_.clock.seconds())) model_.redraw(2);
    if (flashChanged(model_)) model_.redraw(1);
    const bool worked = work();
    const bool due = model_.moving() || !window_.events.empty() || frameWatch_.seconds() > kRestFrameSeconds;
    const bool draws = restless_ || (model_.dirty > 0 && due);
    if (draws) drawFrame();
    if (!draws && !worked) window_.wait(kBreathSeconds);
    if (options_.frames > 0 && frames_ >= options_.frames && !model_.isClosing) askToClose(model_);
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
    return !interrupted() && !model_.closes;
}

void Viewer::close() {
    window_.hide();  // a job may take a while to stop
    const std::string lost = view::close(model_);
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
