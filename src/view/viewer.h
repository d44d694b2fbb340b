// The window's loop: events in, a piece of tracing, a frame out.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "view/input.h"
#include "view/view.h"
#include "view/window.h"

namespace glint::view {

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
    Commands& commands() { return commands_; }
    Input& input() { return input_; }
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
    void gatherEvents();
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
    Commands commands_;
    Input input_;
    Pace pace_;
    Canvas frame_;
    std::vector<std::string> validation_;
    Stopwatch frameWatch_, roundWatch_;
    bool restless_, wasLost_ = false;
    bool moves_ = false;  // the last frame
    uint64_t frames_ = 0;
};

}  // namespace glint::view
