#include "view/panel.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/format.h"
#include "core/quantize.h"
#include "core/text_file.h"

namespace glint::view {

void text(const std::string& line) {
    ImGui::TextUnformatted(line.c_str());
}

void wrapped(const std::string& line, const ImVec4& color) {
    ImGui::PushStyleColor(ImGuiCol_Text, color);
    ImGui::PushTextWrapPos(0);
    text(line);
    ImGui::PopTextWrapPos();
    ImGui::PopStyleColor();
}

void tip(Gui& gui, const std::string& label, const std::string& help) {
    gui.noteControl(label);
    if (help.empty() || !ImGui::IsItemHovered() || ImGui::IsItemActive()) return;
    gui.noteTip(help);
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(22 * ImGui::GetFontSize());
    text(help);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

bool checkbox(Gui& gui, const char* label, bool& value, const char* help) {
    const bool changed = ImGui::Checkbox(label, &value);
    tip(gui, label, help);
    return changed;
}

bool button(Gui& gui, const char* label, const std::string& help) {
    const bool pressed = ImGui::Button(label);
    tip(gui, label, help);
    return pressed;
}

void commandButton(Gui& gui, Model& m, const char* label, std::string_view key) {
    for (const KeyBinding& binding : keyBindings())
        if (binding.name == key && button(gui, label, format("%s (%s)", binding.help, binding.name)))
            m.wish = binding.run;
}

bool colorEdit(Gui& gui, const char* label, glm::dvec3& value, const char* help, bool bright) {
    const double greatest = std::max({value.x, value.y, value.z});
    double strength = bright && greatest > 1 ? greatest : 1;
    glm::vec3 srgb;
    for (int i = 0; i < 3; ++i)
        srgb[i] = static_cast<float>(srgbFromLinear(std::clamp(value[i] / strength, 0.0, 1.0)));
    const glm::vec3 before = srgb;
    ImGui::ColorEdit3(label, &srgb.x,
                      ImGuiColorEditFlags_DisplayHex | ImGuiColorEditFlags_NoOptions |
                          ImGuiColorEditFlags_NoTooltip | ImGuiColorEditFlags_NoDragDrop);
    tip(gui, label, help);
    gui.noteControl(label, 0.02f);  // the swatch
    gui.noteControl(std::string(label) + " hex");
    for (int i = 0; i < 3; ++i)
        if (srgb[i] != before[i]) value[i] = strength * linearFromSrgb(static_cast<double>(srgb[i]));
    bool changed = srgb != before;
    if (bright) {
        ImGui::PushID(label);
        if (slider(gui, "strength", strength, 0.01, std::max(10.0, 2 * strength), "x %.3g",
                   "the greatest component", true)) {
            value *= strength / std::max(greatest, 1e-9);
            changed = true;
        }
        ImGui::PopID();
    }
    return changed;
}

bool group(Gui& gui, const char* name, bool open, const char* help) {
    const bool shown = ImGui::CollapsingHeader(name, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
    tip(gui, name, help);
    return shown;
}

bool resetButton(Gui& gui, const char* name, bool differs) {
    if (!differs) return false;
    const std::string label = std::string("reset ") + name;
    const bool pressed = ImGui::SmallButton(label.c_str());
    tip(gui, label, "as the scene's file has it");
    return pressed;
}

namespace {

// Part that is done, and words on it.
std::pair<double, std::string> progressOf(const Model& m) {
    const Session& session = *m.session;
    const double error = m.settings.until.error;
    if (m.moving()) {
        const FrameFacts& facts = session.facts();
        return {0, format("moving: %d x %d, depth %d", facts.width, facts.height, facts.depth)};
    }
    if (error > 0) {
        const GoalFacts facts = session.goal();
        const double estimate = facts.state.estimate;
        // Samples grow with about the -5/3rd power of the error.
        const double part = estimate > error ? std::pow(error / estimate, 5.0 / 3) : 0.99;
        return {facts.stop ? 1 : facts.state.rounds == 0 ? 0 : part, inWords(facts, error)};
    }
    const int samples = session.samples(), all = m.settings.sampleLimit;
    if (session.finished()) return {1, "done: " + counted(static_cast<uint64_t>(samples), "sample")};
    return {(samples + session.progress()) / std::max(all, 1), format("sample %d of %d", samples + 1, all)};
}

constexpr float kPanelLines = 16.5f;  // the panel's width in heights of a line

// Beside the image; or over it, at most so high, movable, and closed by its heading's triangle.
bool beginPanel(bool docked, float width, float height) {
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const float line = ImGui::GetFontSize();
    const ImGuiCond when = docked ? ImGuiCond_Always : ImGuiCond_FirstUseEver;
    ImGui::SetNextWindowPos(ImVec2(0, 0), when);
    ImGui::SetNextWindowSize(ImVec2(width, docked ? std::max(height, 1.0f) : 0), when);
    ImGui::SetNextWindowBgAlpha(docked ? 1.0f : 0.85f);
    if (docked)
        return ImGui::Begin("glint - F1: keys, H: hide##docked", nullptr,
                            kFixedWindow | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse);
    ImGui::SetNextWindowSizeConstraints(ImVec2(std::min(12 * line, screen.x), 0),
                                        ImVec2(screen.x, std::max(height, 2 * line)));
    const bool open =
        ImGui::Begin("glint - F1: keys, H: hide", nullptr,
                     (kFixedWindow & ~ImGuiWindowFlags_NoResize) | ImGuiWindowFlags_AlwaysAutoResize);
    if (open) ImGui::Dummy(ImVec2(width - 2 * ImGui::GetStyle().WindowPadding.x, 0));
    return open;
}

void drawMain(Gui& gui, Model& m) {
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const float line = ImGui::GetFontSize();
    const bool docked = m.docked && m.left > 0;
    const float width = docked ? static_cast<float>(m.left) : std::min(kPanelLines * line, screen.x);
    m.timelineHeight = drawTimeline(gui, m, width);
    if (beginPanel(docked, width, screen.y - m.timelineHeight)) {
        ImGui::PushItemWidth(width - 8 * line - (docked ? ImGui::GetStyle().ScrollbarSize : 0));
        const auto [part, words] = progressOf(m);
        ImGui::ProgressBar(static_cast<float>(std::clamp(part, 0.0, 1.0)), ImVec2(-1, 0), words.c_str());
        drawGroups(gui, m);
        ImGui::PopItemWidth();
    }
    ImGui::End();
}

}  // namespace

int dockWidth(const Gui& gui, int window) {
    const float wanted = (kPanelLines + 1) * gui.line();  // and a scroll bar
    return std::min(static_cast<int>(wanted), window / 2);
}

void drawPanel(Gui& gui, Model& model) {
    if (!model.panelVisible) model.timelineHeight = 0;
    if (model.helpVisible) {  // without windows over the image
        if (model.panelVisible && model.left > 0) drawMain(gui, model);
        drawHelp();
    } else {
        drawMarks(model);
        if (model.panelVisible) drawMain(gui, model);
        drawDialogs(gui, model);
        drawReadings(gui, model);
    }
    drawProgress(model);
}

}  // namespace glint::view
