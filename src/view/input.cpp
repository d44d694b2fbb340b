#include "view/input.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace glint::view {

namespace {

constexpr double kClickPixels = 4;          // a click moves the mouse by less
constexpr double kTurnPerHeight = 3.14159;  // radians for a drag across the image's height
constexpr double kWheelStep = 0.9;
constexpr double kFlySeconds = 3;  // to cross the scene's radius
constexpr double kWipePixels = 6;  // from the wipe's line, within which a press takes hold of it

}  // namespace

// Keeps only the last of several movements of the mouse.
void Input::push(const Event& event) {
    if (event.type == Event::Type::Cursor && !queue_.empty() && queue_.back().type == Event::Type::Cursor)
        queue_.back() = event;
    else
        queue_.push_back(event);
}

bool Input::waits() const {
    return std::any_of(queue_.begin(), queue_.end(), [&](const Event& e) {
        return e.type != Event::Type::Redraw && (e.type != Event::Type::Cursor || dragging_.has_value());
    });
}

void Input::handle() {
    while (!queue_.empty()) {
        const Event event = queue_.front();
        queue_.pop_front();
        m_.dirty = std::max(m_.dirty, 2);
        if (!handle(event)) return;
    }
}

// False if the rest of the queue must wait for the next frame.
bool Input::handle(const Event& event) {
    switch (event.type) {
        case Event::Type::Close:
            commands_.askToClose();
            return true;
        case Event::Type::Drop:
            for (const std::string& file : event.files) commands_.open(file);
            return true;
        case Event::Type::Resize:
            m_.touch();
            return true;
        case Event::Type::Cursor: {
            const glm::dvec2 before = std::exchange(cursor_, {event.x - m_.left, event.y});
            gui_.feed(event);
            if (draggingWipe_)
                m_.comparison.wipe = std::clamp(cursor_.x / std::max(m_.session->width(), 1), 0.0, 1.0);
            else if (dragging_)
                drag(cursor_ - before);
            return true;
        }
        case Event::Type::Button:
            gui_.feed(event);
            press(event);
            return false;  // ImGui sees a press and its release in two frames
        case Event::Type::Wheel:
            if (covered()) {
                gui_.feed(event);
                return false;
            }
            m_.control.dolly(std::pow(kWheelStep, event.y));
            return true;
        case Event::Type::Key:
            gui_.feed(event);
            key(event);
            return !gui_.wantsKeys();
        case Event::Type::Text:
            gui_.feed(event);
            if (!gui_.wantsKeys() && event.code == '?') m_.helpVisible = !m_.helpVisible;
            return true;
        case Event::Type::Redraw:
            return true;
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
    (dragMods_ & kControl) != 0 ? commands_.focusAt(x, y) : commands_.pick(x, y);
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
    if (gui_.wantsKeys()) return;
    if (event.code == GLFW_KEY_ESCAPE && gui_.closePopups()) return;
    fastFlight_ = (event.mods & kShift) != 0;
    if (m_.flying && isFlyKey(event.code) && (event.mods & (kControl | kAlt)) == 0) {
        held_.insert(event.code);
        return;
    }
    const KeyBinding* binding = bindingOf(event.code, event.mods, m_.flying);
    if (binding == nullptr) return;
    if (!event.repeat) m_.history.endStep();
    commands_.perform(binding->run);
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
    const auto inside = [&](const glm::ivec2& p) {
        return p.x >= 0 && p.y >= 0 && p.x < m_.session->width() && p.y < m_.session->height();
    };
    const glm::ivec2 under(std::floor(cursor_.x), std::floor(cursor_.y));
    if (inside(under) && !covered()) m_.pixel = under;
    if (!m_.inspects || (m_.pixel && !inside(*m_.pixel))) m_.pixel.reset();
}

}  // namespace glint::view
