// What the user does.
#include <algorithm>
#include <cmath>
#include <ostream>

#include "view/viewer.h"

namespace glint::view {

namespace {

constexpr double kClickPixels = 4;          // a hand that clicks moves the mouse less than this
constexpr double kTurnPerHeight = 3.14159;  // radians for a drag across the window's height
constexpr double kKeyTurn = 0.0873;         // 5 degrees
constexpr double kWheelStep = 0.9;
constexpr double kFovStep = 1.1;
constexpr double kFlySeconds = 3;  // to cross the scene's radius

std::optional<Side> sideOf(Action action) {
    const int index = static_cast<int>(action) - static_cast<int>(Action::ViewFront);
    if (index < 0 || index > 5) return std::nullopt;
    return static_cast<Side>(index);
}

}  // namespace

void Viewer::handleEvents() {
    while (!queue_.empty()) {
        const Event event = queue_.front();
        queue_.pop_front();
        dirty_ = std::max(dirty_, 2);
        if (!handle(event)) return;
    }
}

bool Viewer::handle(const Event& event) {
    switch (event.type) {
        case Event::Type::Close:
            closing_ = true;
            return true;
        case Event::Type::Resize:
            touchMotion();
            return true;
        case Event::Type::Cursor: {
            const double dx = event.x - cursorX_, dy = event.y - cursorY_;
            cursorX_ = event.x;
            cursorY_ = event.y;
            gui_.feed(event);
            if (dragging_) drag(dx, dy);
            return true;
        }
        case Event::Type::Button:
            gui_.feed(event);
            handleButton(event);
            return false;  // ImGui sees a press and its release in two frames
        case Event::Type::Wheel:
            if (gui_.covers(cursorX_, cursorY_)) {
                gui_.feed(event);
                return false;
            }
            control_.dolly(std::pow(kWheelStep, event.y));
            touchMotion();
            return true;
        case Event::Type::Key:
            gui_.feed(event);
            handleKey(event);
            return !gui_.wantsKeys();
        case Event::Type::Text:
            gui_.feed(event);
            if (!gui_.wantsKeys() && event.code == '?') perform(Action::Help);
            return true;
        case Event::Type::Redraw:
            return true;
    }
    return true;
}

void Viewer::handleButton(const Event& event) {
    const auto button = static_cast<Button>(event.code);
    if (event.down) {
        if (gui_.covers(cursorX_, cursorY_) || dragging_) return;
        dragging_ = button;
        dragMods_ = event.mods;
        dragged_ = false;
        pressX_ = cursorX_;
        pressY_ = cursorY_;
        return;
    }
    if (dragging_ != button) return;
    dragging_.reset();
    if (button == Button::Left && !dragged_) pick(static_cast<int>(pressX_), static_cast<int>(pressY_));
}

void Viewer::drag(double dx, double dy) {
    if (!dragged_ && std::hypot(cursorX_ - pressX_, cursorY_ - pressY_) < kClickPixels) return;
    if (!dragged_) {  // all the way from where it began
        dragged_ = true;
        dx = cursorX_ - pressX_;
        dy = cursorY_ - pressY_;
    }
    const double height = std::max(session_->height(), 1);
    const bool pans = dragging_ == Button::Middle || (dragging_ == Button::Left && (dragMods_ & kShift) != 0);
    if (pans) {
        control_.pan(dx / height, dy / height);
    } else if (dragging_ == Button::Right) {
        control_.dolly(std::exp2(2 * dy / height));
    } else if (model_.flying) {
        control_.look(kTurnPerHeight / 2 * dx / height, kTurnPerHeight / 2 * dy / height);
    } else {
        control_.orbit(kTurnPerHeight * dx / height, kTurnPerHeight * dy / height);
    }
    touchMotion();
}

void Viewer::handleKey(const Event& event) {
    if (!event.down) {
        held_.erase(event.code);
        return;
    }
    if (gui_.wantsKeys()) return;
    fastFlight_ = (event.mods & kShift) != 0;
    if (model_.flying && isFlyKey(event.code) && (event.mods & (kControl | kAlt)) == 0) {
        held_.insert(event.code);
        return;
    }
    const std::optional<Action> action = actionOf(event.code, event.mods, model_.flying);
    if (action) perform(*action);
}

void Viewer::flyOn(double seconds) {
    if (held_.empty()) return;
    const auto axis = [&](int plus, int minus) {
        return static_cast<double>(held_.count(plus)) - static_cast<double>(held_.count(minus));
    };
    const double speed = boundsOf(*scene_).radius / kFlySeconds * (fastFlight_ ? 4 : 1);
    const double step = speed * std::min(seconds, 0.25);
    control_.move(step * glm::dvec3(axis('D', 'A'), axis('E', 'Q'), axis('W', 'S')));
    touchMotion();
}

void Viewer::perform(Action action) {
    dirty_ = 3;
    if (performCamera(action)) {
        touchMotion();
        return;
    }
    switch (action) {
        case Action::Help:
            model_.helpVisible = !model_.helpVisible;
            break;
        case Action::HidePanel:
            model_.panelVisible = !model_.panelVisible;
            break;
        case Action::Close:
            model_.helpVisible = false;
            model_.message.clear();
            model_.verdict.clear();
            difference_.reset();
            pick_.reset();
            break;
        case Action::Quit:
            closing_ = true;
            break;
        case Action::NextLayer:
            changeLayer(1);
            break;
        case Action::PreviousLayer:
            changeLayer(-1);
            break;
        case Action::ExposureDown:
            model_.exposure = std::max(model_.exposure - 0.5, -8.0);
            break;
        case Action::ExposureUp:
            model_.exposure = std::min(model_.exposure + 0.5, 8.0);
            break;
        case Action::ToggleFly:
            model_.flying = !model_.flying;
            held_.clear();
            break;
        case Action::PrintCamera:
            printCamera();
            break;
        case Action::Verify:
            startVerifying();
            break;
        case Action::SavePng:
            startSaving(freeName(".", scene_->path.stem().string(), ".png"));
            break;
        case Action::SaveExr:
            startSaving(freeName(".", scene_->path.stem().string(), ".exr"));
            break;
        case Action::Reload:
            startLoading();
            break;
        default:
            break;
    }
}

bool Viewer::performCamera(Action action) {
    if (const std::optional<Side> side = sideOf(action)) {
        control_.view(*side, boundsOf(*scene_));
        return true;
    }
    const auto turn = [&](double x, double y) { model_.flying ? control_.look(x, y) : control_.orbit(x, y); };
    switch (action) {
        case Action::Reset:
            control_.reset();
            return true;
        case Action::Projection:
            say("camera: " + control_.nextProjection());
            return true;
        case Action::FramePicked:
            framePicked();
            return true;
        case Action::NarrowView:
            control_.zoom(1 / kFovStep);
            return true;
        case Action::WidenView:
            control_.zoom(kFovStep);
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
            control_.dolly(kWheelStep);
            return true;
        case Action::Farther:
            control_.dolly(1 / kWheelStep);
            return true;
        default:
            return false;
    }
}

void Viewer::changeLayer(int step) {
    const int next = (static_cast<int>(model_.settings.layer) + step + kViewLayers) % kViewLayers;
    model_.settings.layer = static_cast<ViewLayer>(next);
    takeSettings();
}

void Viewer::pick(int x, int y) {
    if (x < 0 || y < 0 || x >= session_->width() || y >= session_->height()) return;
    pick_ = pickPixel(*session_, x, y);
    out_ << pickCsv(*pick_) << std::flush;
}

void Viewer::framePicked() {
    if (pick_ && pick_->hit()) {
        control_.frame(boundsOf(*scene_, pick_->data.object, pick_->data.position, pick_->data.depth));
    } else {
        control_.frame(boundsOf(*scene_));
    }
}

void Viewer::printCamera() {
    const std::string json = cameraJson(control_.camera());
    out_ << json << std::endl;
    window_.setClipboard(json);
    say("copied: " + json);
}

void Viewer::startSaving(const std::filesystem::path& file) {
    if (saving_.running()) {
        say("still saving; one picture at a time");
        return;
    }
    SaveRequest request = saveRequest(*session_, file, scene_->scene.image.samplesPerPixel, model_.exposure);
    saving_.start([this, request = std::move(request)](JobControl& control) mutable {
        std::string line = save(*device_, std::move(request), control);
        Window::wake();
        return line;
    });
}

void Viewer::startVerifying() {
    if (verifying_.running()) return;
    model_.verdict.clear();
    difference_.reset();
    SaveRequest request = saveRequest(*session_, {}, 1, 0);
    verifying_.start([this, request = std::move(request)](JobControl& control) mutable {
        VerifyResult result = verifyView(*device_, std::move(request), control);
        Window::wake();
        return result;
    });
}

}  // namespace glint::view
