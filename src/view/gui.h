// Dear ImGui on a Canvas: takes the viewer's events, and draws with the host's own hand. So the panel needs
// no graphics queue and no shader, and looks the same on every device.
#pragma once

#include <memory>
#include <vector>

#include "view/canvas.h"
#include "view/events.h"

namespace glint::view {

class Gui {
  public:
    explicit Gui(float scale);
    ~Gui();
    Gui(const Gui&) = delete;
    Gui& operator=(const Gui&) = delete;

    void feed(const Event& event);
    // True if a press at this place is the panel's (as of the last frame), or a drag that began there goes
    // on.
    bool covers(double x, double y) const;
    bool wantsKeys() const;  // a number is being typed

    // Between the two, ImGui's functions describe the panel; end() draws it over the picture.
    void begin(int width, int height, double seconds);
    void end(Canvas& target);

    // To be called inside each window.
    void noteWindow();

  private:
    struct Rectangle {
        float x0, y0, x1, y1;
    };
    std::vector<Rectangle> windows_, nextWindows_;
    std::vector<unsigned char> font_;  // coverage, a byte for each texel
    int fontWidth_ = 0, fontHeight_ = 0;
};

}  // namespace glint::view
