// Mouse and keyboard: turns events into commands and movements of the camera.
#pragma once

#include <deque>
#include <glm/vec2.hpp>
#include <optional>
#include <set>

#include "view/commands.h"
#include "view/gui.h"

namespace glint::view {

class Input {
  public:
    Input(Model& model, Commands& commands, Gui& gui) : m_(model), commands_(commands), gui_(gui) {}

    void push(const Event& event);
    const std::deque<Event>& queue() const { return queue_; }
    // An event is in the queue that ends a piece of tracing early.
    bool waits() const;
    // Handles the queue, up to an event that the panel must see a frame of its own for.
    void handle();

    bool flies() const { return !held_.empty(); }
    void flyOn(double seconds);
    // The image has moved in the window by so many pixels.
    void shift(int pixels) { cursor_.x -= pixels; }
    // The pixel under the mouse, in Model::pixel. Over a control the last one stays.
    void inspect();

  private:
    bool handle(const Event& event);
    void press(const Event& event);
    void drag(const glm::dvec2& by);
    void key(const Event& event);
    bool covered() const { return gui_.covers(cursor_.x + m_.left, cursor_.y); }  // by the panel

    Model& m_;
    Commands& commands_;
    Gui& gui_;
    std::deque<Event> queue_;
    glm::dvec2 cursor_{-1}, pressed_{0};  // pixels of the image
    std::optional<int> dragging_;         // button
    bool dragged_ = false, draggingWipe_ = false;
    int dragMods_ = 0;
    std::set<int> held_;  // keys that fly
    bool fastFlight_ = false;
};

}  // namespace glint::view
