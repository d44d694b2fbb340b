// Dear ImGui in the window: takes events, and the processor draws it over the image.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "view/display.h"
#include "view/window.h"

namespace glint::view {

class Gui {
  public:
    // `scale` of text and controls; the window's clipboard is read by Ctrl+V and written by Ctrl+C.
    Gui(float scale, Window& window);
    ~Gui();
    Gui(const Gui&) = delete;
    Gui& operator=(const Gui&) = delete;

    void feed(const Event& event);
    // True if a press at this place is the panel's (as of the last frame), or a drag that began there goes
    // on.
    bool covers(double x, double y) const;
    bool wantsKeys() const;  // something is being typed, or a control is held
    // Closes open lists and pickers in the next frame; false if there are none.
    bool closePopups();
    // Windows of the last frame, in pixels; with `inert`, also those that leave the mouse to the image.
    struct Rectangle {
        float x0, y0, x1, y1;
    };
    std::vector<Rectangle> windows(bool inert) const;
    // The middle of a control of the last frame, by its label.
    struct Place {
        double x, y;
    };
    std::optional<Place> controlAt(const std::string& label) const;
    const std::string& tip() const { return tip_; }  // that was shown in the last frame; empty: none
    float line() const { return fontPixels_; }       // the height of letters, pixels

    // Between the two, ImGui's functions describe the panel; end() draws it over the picture.
    void begin(int width, int height, double seconds);
    void end(Canvas& target);

    // To be called after each control.
    void noteControl(const char* label);
    void noteTip(const char* text) { nextTip_ = text; }

  private:
    float fontPixels_ = 0;
    Window& window_;
    std::string pasted_;  // what ImGui was given last
    std::map<std::string, Place> controls_, nextControls_;
    std::string tip_, nextTip_;
    bool anyPopup_ = false, closesPopups_ = false;
};

}  // namespace glint::view
