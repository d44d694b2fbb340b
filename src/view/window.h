// The window itself and its events.
#pragma once

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <deque>
#include <string>
#include <vector>

#include "gpu/device.h"

namespace glint::view {

struct Event {
    enum class Type { Cursor, Button, Wheel, Key, Text, Drop, Resize, Redraw, Close };
    Type type = Type::Redraw;
    double x = 0, y = 0;                  // Cursor: pixels of the window's picture; Wheel: steps
    int code = 0;                         // Button, Key: GLFW's number; Text: a Unicode code point
    int mods = 0;                         // of Button and Key: bits GLFW_MOD_*
    bool down = false;                    // of Button and Key
    bool repeat = false;                  // of Key: held down
    std::vector<std::string> files = {};  // of Drop
};

struct PixelSize {
    int width = 0, height = 0;
    bool operator==(const PixelSize&) const = default;
};

// One at a time, on the main thread (GLFW's rule).
class Window {
  public:
    // A window whose picture has `size` pixels if the screen can hold it. Throws Error(Device) without a
    // display or without Vulkan for windows, naming `glint render`.
    Window(PixelSize size, const std::string& title);
    ~Window();
    Window(const Window&) = delete;
    Window& operator=(const Window&) = delete;

    gpu::WindowSystem system();

    // Adds new events to the queue. wait(): sleeps until an event comes, wake() is called, or `seconds` are
    // over.
    static void poll() { glfwPollEvents(); }
    void wait(double seconds);
    static void wake() { glfwPostEmptyEvent(); }  // from any thread

    PixelSize size() const;  // of the picture; on a HiDPI screen more than the window system's units
    float scale() const;     // of text and controls: 1, 2 on HiDPI
    bool minimised() const;
    void setTitle(const std::string& title) { glfwSetWindowTitle(window_, title.c_str()); }
    void hide() { glfwHideWindow(window_); }
    // The whole screen, or a window again as large as before.
    void toggleFullscreen();
    GLFWwindow* handle() const { return window_; }

    // Keeps only the last of several movements of the mouse.
    void push(const Event& event);
    std::deque<Event> events;  // that wait to be handled

  private:
    GLFWwindow* window_ = nullptr;
    int windowedX_ = 0, windowedY_ = 0, windowedWidth_ = 0, windowedHeight_ = 0;  // before fullscreen
};

}  // namespace glint::view
