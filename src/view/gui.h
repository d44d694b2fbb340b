// Dear ImGui in the window: takes events, and the processor draws it over the image.
#pragma once

#include <glm/vec2.hpp>
#include <map>
#include <optional>
#include <string>

#include "view/display.h"
#include "view/window.h"

namespace glint::view {

class Gui {
  public:
    // `scale` of text and controls. Ctrl+C and Ctrl+V use the window's clipboard.
    Gui(float scale, const Window& window);
    ~Gui();
    Gui(const Gui&) = delete;
    Gui& operator=(const Gui&) = delete;

    void feed(const Event& event);
    // True if a press at this place, in pixels, is the panel's (as of the last frame), or if a list is open.
    // `inert`: true also over windows that leave the mouse to the image.
    bool covers(double x, double y, bool inert = false) const;
    bool wantsKeys() const;                            // something is being typed, or a control is held
    bool leftControl() const { return leftControl_; }  // in the last frame; it was held before
    // Closes open lists and pickers in the next frame; false if there are none.
    bool closePopups();
    // A place on a control of the last frame where a click works it, by its label.
    std::optional<glm::dvec2> controlAt(const std::string& label) const;
    const std::string& tip() const { return tip_; }  // shown in the last frame; empty: none
    float line() const { return fontPixels_; }       // the height of letters, pixels

    // ImGui's functions between the two describe the panel; end() draws it over the image.
    void begin(int width, int height, double seconds);
    void end(Canvas& target);

    // To be called after each control. `part` of its width, from the left: always the control itself, since a
    // slider's rectangle holds its label too.
    static void noteControl(const std::string& label, float part = 0.25f);
    static void noteTip(const std::string& text) { current().nextTip_ = text; }

  private:
    static Gui& current();  // of ImGui's context

    GLFWwindow* window_;
    float fontPixels_ = 0;
    std::map<std::string, glm::dvec2> controls_, nextControls_;
    std::string tip_, nextTip_;
    bool anyPopup_ = false, closesPopups_ = false, leftControl_ = false;
    unsigned held_ = 0;  // ImGuiID of the control that is held or typed into
};

}  // namespace glint::view
