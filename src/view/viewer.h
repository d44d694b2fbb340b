// The window's loop: events in, a piece of tracing, a frame out.
#pragma once

#include <deque>
#include <glm/vec2.hpp>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "gpu/swapchain.h"
#include "view/commands.h"
#include "view/gui.h"
#include "view/view.h"
#include "view/window.h"

namespace glint::view {

// Mouse and keyboard: turns events into commands and movements of the camera.
class Input {
  public:
    Input(Model& model, Gui& gui, std::deque<Event>& queue) : m_(model), gui_(gui), queue_(queue) {}

    // An event is in the queue that ends a piece of tracing early.
    bool waits() const;
    // Handles the queue, up to an event that needs a frame of the panel of its own.
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
    Gui& gui_;
    std::deque<Event>& queue_;            // the window's
    glm::dvec2 cursor_{-1}, pressed_{0};  // pixels of the image
    std::optional<int> dragging_;         // button
    bool dragged_ = false, draggingWipe_ = false;
    int dragMods_ = 0;
    std::set<int> held_;  // keys that fly
    bool fastFlight_ = false;
};

class Viewer {
  public:
    // Loads the scene and makes the window.
    Viewer(const Options& options, std::ostream& out, std::ostream& err);
    ~Viewer();

    // Opens the device; then step() until it returns false; then close(), which throws if work was lost.
    void open();
    bool step();
    void close();

    // For programs that drive the window (tests/view/driver.h).
    Model& model() { return model_; }
    const Input& input() const { return input_; }
    Window& window() { return window_; }
    const Gui& gui() const { return gui_; }
    const Canvas& frame() const { return frame_; }  // the last one, with the panel
    uint64_t frames() const { return frames_; }     // drawn so far
    // Draws a frame in every step, even if nothing has changed.
    void setRestless(bool restless) { restless_ = restless; }
    // Opens the device again after it was lost; throws Error(Device) the second time.
    void recover(const gpu::DeviceLost& lost);

  private:
    void openDevice();
    void checkRoom(PixelSize size) const;
    void round();
    bool hasWork() const;
    void showView();
    bool work();
    bool renderMoving();
    void drawFrame();
    void takePanel();
    void reportValidation();

    Options options_;
    std::ostream& err_;
    Model model_;
    Window window_;
    // Destroyed from the last to the first.
    std::unique_ptr<gpu::Device> device_;
    std::unique_ptr<gpu::Swapchain> swapchain_;
    Gui gui_;
    Input input_;
    Pace pace_;
    Canvas frame_;
    std::vector<std::string> validation_;
    Stopwatch frameWatch_, roundWatch_;
    bool restless_, wasLost_ = false;
    uint64_t frames_ = 0;
};

}  // namespace glint::view
