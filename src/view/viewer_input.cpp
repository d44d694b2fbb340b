// What the user does.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ostream>
#include <utility>

#include "core/error.h"
#include "view/viewer.h"

namespace glint::view {

namespace {

constexpr double kClickPixels = 4;          // a hand that clicks moves the mouse less than this
constexpr double kTurnPerHeight = 3.14159;  // radians for a drag across the window's height
constexpr double kKeyTurn = 0.0873;         // 5 degrees
constexpr double kWheelStep = 0.9;
constexpr double kFovStep = 1.1;
constexpr double kFlySeconds = 3;        // to cross the scene's radius
constexpr double kGestureSeconds = 0.5;  // movements nearer than this are undone together
constexpr double kWipePixels = 6;        // from the wipe's line, where the mouse takes hold of it

template <NamedEnum E>
E nextOf(E value) {
    return static_cast<E>((static_cast<size_t>(value) + 1) % kEnumNames<E>.size());
}

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
            askToClose();
            return true;
        case Event::Type::Drop:
            drop(event.files);
            return true;
        case Event::Type::Resize:
            touchMotion();
            return true;
        case Event::Type::Cursor: {
            const double x = event.x - left_;
            const double dx = x - cursorX_, dy = event.y - cursorY_;
            cursorX_ = x;
            cursorY_ = event.y;
            gui_.feed(event);
            if (draggingWipe_)
                comparison_.wipe = std::clamp(cursorX_ / std::max(session_->width(), 1), 0.0, 1.0);
            else if (dragging_)
                drag(dx, dy);
            return true;
        }
        case Event::Type::Button:
            gui_.feed(event);
            handleButton(event);
            return false;  // ImGui sees a press and its release in two frames
        case Event::Type::Wheel:
            if (covered()) {
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
        if (covered() || dragging_) return;
        dragging_ = button;
        dragMods_ = event.mods;
        dragged_ = false;
        gestureEnded_ = true;
        pressX_ = cursorX_;
        pressY_ = cursorY_;
        const double line = comparison_.wipe * session_->width();
        draggingWipe_ = button == Button::Left && comparison_.any() &&
                        comparison_.mode == CompareMode::Wipe && std::abs(cursorX_ - line) <= kWipePixels;
        return;
    }
    if (dragging_ != button) return;
    dragging_.reset();
    if (std::exchange(draggingWipe_, false) || button != Button::Left || dragged_) return;
    const int x = static_cast<int>(pressX_), y = static_cast<int>(pressY_);
    (dragMods_ & kControl) != 0 ? focusAt(x, y) : pick(x, y);
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
    if (!action) return;
    if (!event.repeat) gestureEnded_ = true;
    perform(*action);
}

void Viewer::flyOn(double seconds) {
    if (held_.empty()) return;
    const auto axis = [&](int plus, int minus) {
        return static_cast<double>(held_.count(plus)) - static_cast<double>(held_.count(minus));
    };
    const double speed = model_.flySpeed * model_.reach / kFlySeconds * (fastFlight_ ? 4 : 1);
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
    if (performView(action) || performFile(action) || performTime(action)) return;
    switch (action) {
        case Action::Quit:
            askToClose();
            break;
        case Action::Undo:
            travel(history_.undo(control_.camera()), "nothing to undo");
            break;
        case Action::Redo:
            travel(history_.redo(control_.camera()), "nothing to redo");
            break;
        case Action::Bookmark:
            keepCamera();
            break;
        case Action::NextBookmark:
            goToCamera(model_.camera + 1);
            break;
        case Action::PrintCamera:
            printCamera();
            break;
        case Action::Keep:
            keepPicture();
            break;
        case Action::Verify:
            startVerifying();
            break;
        case Action::Reload:
            startLoading();
            break;
        default:
            break;
    }
}

bool Viewer::performView(Action action) {
    switch (action) {
        case Action::Help:
            model_.helpVisible = !model_.helpVisible;
            return true;
        case Action::HidePanel:
            model_.panelVisible = !model_.panelVisible;
            return true;
        case Action::DockPanel:
            model_.docked = !model_.docked || !model_.panelVisible;
            model_.panelVisible = true;
            return true;
        case Action::Close:
            model_.helpVisible = model_.saveAsVisible = model_.openVisible = false;
            model_.sceneError.clear();
            toasts_.clear();
            model_.verdict.clear();
            difference_.reset();
            comparison_.mode = CompareMode::Off;
            forgetPick(true);
            return true;
        case Action::NextLayer:
            changeLayer(1);
            return true;
        case Action::PreviousLayer:
            changeLayer(-1);
            return true;
        case Action::ExposureDown:
            model_.display.exposure = steppedExposure(model_.display.exposure, -0.5);
            return true;
        case Action::ExposureUp:
            model_.display.exposure = steppedExposure(model_.display.exposure, 0.5);
            return true;
        case Action::ToneMapping:
            model_.display.toneMap = nextOf(model_.display.toneMap);
            say("tone map: " + std::string(nameOf(model_.display.toneMap)));
            return true;
        case Action::CompareMode:
            if (!comparison_.any()) {
                say("K keeps a picture to compare with; or drop one here", ToastKind::Error);
                return true;
            }
            comparison_.mode = nextOf(comparison_.mode);
            follow(Hint::Compare);
            sayComparison();
            return true;
        case Action::Inspect:
            model_.inspects = !model_.inspects;
            return true;
        case Action::Fullscreen:
            window_.setFullscreen(!window_.fullscreen());
            return true;
        case Action::ToggleFly:
            model_.flying = !model_.flying;
            held_.clear();
            return true;
        default:
            return false;
    }
}

void Viewer::sayComparison() {
    std::string text = "compare: " + std::string(nameOf(comparison_.mode));
    if (comparison_.mode == CompareMode::Wipe) text += ", left of the line";
    if (comparison_.mode != CompareMode::Off) text += ": " + comparison_.name + "; B: next";
    say(text);
}

bool Viewer::performFile(Action action) {
    const bool exr = action == Action::SaveExr || action == Action::RenderExr;
    const bool seen = action == Action::SavePng || action == Action::SaveExr;
    switch (action) {
        case Action::SavePng:
        case Action::SaveExr:
        case Action::RenderPng:
        case Action::RenderExr:
            if (saving_.running()) {
                say("still saving; one picture at a time", ToastKind::Error);
                return true;
            }
            try {
                startSaving(claimName(".", scene_->path.stem().string(), exr ? ".exr" : ".png"), seen);
            } catch (const Error& e) {
                say(e.what(), ToastKind::Error);
                err_ << "glint: " << e.what() << '\n';
            }
            return true;
        case Action::SaveAs:
            model_.saveAsVisible = !model_.saveAsVisible;
            return true;
        case Action::Open:
            model_.openVisible = !model_.openVisible;
            return true;
        default:
            return false;
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

// After all events of a round: what the camera's movement means for what was found before it.
void Viewer::noteCamera() {
    const Camera& camera = control_.camera();
    if (sameCamera(camera, seenCamera_)) return;
    follow(Hint::Turn);
    if (gestureEnded_ || sinceMove_.seconds() > kGestureSeconds) history_.remember(seenCamera_);
    gestureEnded_ = false;
    sinceMove_.restart();
    seenCamera_ = camera;
    forgetPick(false);
    difference_.reset();
    model_.verdict.clear();
}

// A pick belongs to the view that it was made in, but a pinned one stays, and its rays can be looked at from
// elsewhere.
void Viewer::forgetPick(bool evenPinned) {
    pickIsOld_ = pick_.has_value();
    if (model_.pinsPick && !evenPinned) return;
    pick_.reset();
}

void Viewer::follow(Hint hint) {
    if (hints_.done(hint)) say("That is all it takes. F1 lists every key.");
}

void Viewer::travel(const std::optional<Camera>& camera, const char* otherwise) {
    if (!camera) {
        say(otherwise);
        return;
    }
    control_.set(*camera);
    seenCamera_ = *camera;  // no movement to undo
    gestureEnded_ = true;
    forgetPick(false);
    difference_.reset();
    model_.verdict.clear();
    touchMotion();
}

void Viewer::pick(int x, int y) {
    if (x < 0 || y < 0 || x >= session_->width() || y >= session_->height()) return;
    pick_ = pickPixel(*session_, x, y);
    pickIsOld_ = false;
    if (pick_->hit()) model_.material = pick_->data.material;
    follow(Hint::Pick);
    out_ << pickCsv(*pick_) << std::flush;
}

void Viewer::focusAt(int x, int y) {
    if (x < 0 || y < 0 || x >= session_->width() || y >= session_->height()) return;
    const PixelData data = session_->pixel(x, y);
    if (data.object == PixelData::kNoIndex || control_.camera().projection != Projection::Perspective ||
        !control_.focusAt(data.position)) {
        say(data.object == PixelData::kNoIndex ? "nothing there to focus on" : "parallel rays have no focus",
            ToastKind::Error);
        return;
    }
    const Camera& camera = control_.camera();
    char text[96];
    std::snprintf(text, sizeof(text), "focus distance %.6g%s", camera.focusDistance,
                  camera.lensRadius > 0 ? "" : "; give the lens a radius to see it");
    say(text);
    gestureEnded_ = true;
    touchMotion();
}

void Viewer::framePicked() {
    if (pick_ && pick_->hit()) {
        control_.frame(boundsOf(*scene_, pick_->data.object, pick_->data.position, pick_->data.depth));
    } else {
        control_.frame(boundsOf(*scene_));
    }
}

void Viewer::printCamera() {
    std::string json = cameraJson(control_.camera());
    std::string what = "camera";
    if (model_.settings.lights != model_.fileSettings.lights) {
        std::vector<Light> lights;
        for (size_t i = 0; i < scene_->scene.lights.size(); ++i) {
            const LightSetting& setting = model_.settings.lights[i];
            if (!setting.on || setting.dim <= 0) continue;
            lights.push_back(setting.applied(scene_->scene.lights[i]));
            std::visit([&](auto& l) { l.intensity *= static_cast<double>(setting.dim); }, lights.back());
        }
        json += ",\n" + lightsJson(lights);
        what += ", lights";
    }
    const std::string materials = materialsJson(model_.edits.materials, model_.fileEdits.materials);
    if (!materials.empty()) {
        json += ",\n" + materials;
        what += ", what has changed of materials";
    }
    out_ << json << std::endl;
    window_.setClipboard(json);
    say("copied as scene JSON: " + what);
}

}  // namespace glint::view
