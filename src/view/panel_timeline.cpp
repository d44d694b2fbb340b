// The moments of an animated scene.
#include <algorithm>
#include <cstdio>

#include "view/panel_parts.h"

namespace glint::view {

namespace {

void drawButtons(Gui& gui, Model& m) {
    Timeline& t = m.timeline;
    const float line = ImGui::GetFontSize();
    const char* label = t.playing() ? "pause" : "play";
    if (ImGui::Button(label, ImVec2(4 * line, 0))) m.wish = Action::PlayPause;
    tip(gui, label, "the animation (Space)");
    ImGui::SameLine();
    if (ImGui::ArrowButton("##back", ImGuiDir_Left)) m.wish = Action::FrameBack;
    tip(gui, "frame back", "a frame back (,)");
    ImGui::SameLine();
    if (ImGui::ArrowButton("##on", ImGuiDir_Right)) m.wish = Action::FrameOn;
    tip(gui, "frame on", "a frame on (.)");
    ImGui::SameLine();
    bool loops = t.loops();
    if (checkbox(gui, "loop", loops, "from the end on to the beginning"))
        t.setLoops(loops, m.clock.seconds());
}

}  // namespace

float drawTimeline(Gui& gui, Model& m, float width) {
    Timeline& t = m.timeline;
    if (!t.any()) return 0;
    const float line = ImGui::GetFontSize();
    ImGui::SetNextWindowPos(ImVec2(0, ImGui::GetIO().DisplaySize.y), ImGuiCond_Always, ImVec2(0, 1));
    ImGui::SetNextWindowSize(ImVec2(width, 0), ImGuiCond_Always);
    ImGui::SetNextWindowBgAlpha(m.left > 0 ? 1.0f : 0.85f);
    float height = 0;
    if (ImGui::Begin("##timeline", nullptr,
                     kFixedWindow | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoTitleBar)) {
        ImGui::PushItemWidth(width - 5 * line);
        drawButtons(gui, m);
        int frame = t.frame();
        if (slider(gui, "frame", frame, t.first(), std::max(t.last(), t.first() + 1),
                   "drag through the animation; Home and End go to its ends"))
            t.goTo(frame);
        double rate = t.rate();
        if (slider(gui, "fps", rate, 1, 120, "%.4g", "frames a second: how finely it is played and stepped",
                   true))
            t.setRate(rate, m.clock.seconds());
        char moment[48] = "as the file says it";
        if (m.time) std::snprintf(moment, sizeof(moment), "%.5g s", *m.time);
        wrapped(moment, kDim);
        height = ImGui::GetWindowHeight();
        ImGui::PopItemWidth();
    }
    gui.noteWindow();
    ImGui::End();
    return height;
}

}  // namespace glint::view
