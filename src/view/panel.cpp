#include "view/panel.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "view/panel_parts.h"

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

void tip(Gui& gui, const char* label, const char* help) {
    gui.noteControl(label);
    if (*help == 0 || !ImGui::IsItemHovered() || ImGui::IsItemActive()) return;
    gui.noteTip(help);
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(22 * ImGui::GetFontSize());
    ImGui::TextUnformatted(help);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

bool slider(Gui& gui, const char* label, double& value, double lo, double hi, const char* format,
            const char* help, bool logarithmic) {
    auto number = static_cast<float>(value);
    const ImGuiSliderFlags flags =
        ImGuiSliderFlags_AlwaysClamp | (logarithmic ? ImGuiSliderFlags_Logarithmic : 0);
    const bool changed =
        ImGui::SliderFloat(label, &number, static_cast<float>(lo), static_cast<float>(hi), format, flags);
    tip(gui, label, help);
    if (changed) value = std::clamp(static_cast<double>(number), lo, hi);
    return changed;
}

bool slider(Gui& gui, const char* label, int& value, int lo, int hi, const char* help, bool logarithmic) {
    const ImGuiSliderFlags flags =
        ImGuiSliderFlags_AlwaysClamp | (logarithmic ? ImGuiSliderFlags_Logarithmic : 0);
    const bool changed = ImGui::SliderInt(label, &value, lo, hi, "%d", flags);
    tip(gui, label, help);
    return changed;
}

bool checkbox(Gui& gui, const char* label, bool& value, const char* help) {
    const bool changed = ImGui::Checkbox(label, &value);
    tip(gui, label, help);
    return changed;
}

bool button(Gui& gui, const char* label, const char* help) {
    const bool pressed = ImGui::Button(label);
    tip(gui, label, help);
    return pressed;
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
    tip(gui, label.c_str(), "as the scene's file has it");
    return pressed;
}

bool beginCorner(int left, const char* title, const ImVec2& pivot, float width, ImGuiWindowFlags more,
                 float part) {
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const auto x = static_cast<float>(left);
    const ImVec2 size(screen.x - x, screen.y);
    ImGui::SetNextWindowPos(ImVec2(x + size.x * pivot.x, size.y * pivot.y), ImGuiCond_Always, pivot);
    ImGui::SetNextWindowSizeConstraints(ImVec2(std::min(width, size.x), 0),
                                        ImVec2(std::min(width, size.x), part * size.y));
    ImGui::SetNextWindowBgAlpha(0.85f);
    return ImGui::Begin(title, nullptr,
                        kFixedWindow | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove | more);
}

namespace {

// How the bound has fallen, both axes in powers: from the first look to what was asked for.
void drawFall(const PanelModel& m) {
    if (m.goal == nullptr || m.goal->looks.size() < 2) return;
    std::vector<float> bounds;
    for (const GoalFacts::Look& look : m.goal->looks)
        if (std::isfinite(look.bound)) bounds.push_back(static_cast<float>(std::log(look.bound)));
    if (bounds.size() < 2) return;
    const auto wanted = static_cast<float>(std::log(m.settings.until.error));
    const float most = *std::max_element(bounds.begin(), bounds.end());
    ImGui::PlotLines("##fall", bounds.data(), static_cast<int>(bounds.size()), 0, nullptr,
                     std::min(wanted, bounds.back()), std::max(most, wanted + 0.1f),
                     ImVec2(ImGui::GetContentRegionAvail().x, 2 * ImGui::GetFontSize()));
}

void drawGoal(const PanelModel& m) {
    const ErrorSetting& until = m.settings.until;
    const std::string line = m.goal ? inWords(*m.goal, until) : inWords(GoalFacts(), until);
    // Samples grow with about the -5/3rd power of the error.
    const double error = m.goal ? m.goal->state.estimate : 0;
    const double part = m.goal && m.goal->stop ? 1
                        : error > until.error  ? std::pow(until.error / error, 5.0 / 3)
                                               : 0.99;
    ImGui::ProgressBar(static_cast<float>(m.goal && !m.goal->looks.empty() ? part : 0.0), ImVec2(-1, 0),
                       line.c_str());
    drawFall(m);
}

void drawStatus(const PanelModel& m) {
    if (!m.moving && m.settings.until.error > 0) return drawGoal(m);
    char line[96];
    if (m.moving) {
        std::snprintf(line, sizeof(line), "moving: %d x %d, depth %d", m.facts.width, m.facts.height,
                      m.facts.depth);
    } else if (m.finished) {
        std::snprintf(line, sizeof(line), "done: %d sample%s", m.samples, m.samples == 1 ? "" : "s");
    } else {
        std::snprintf(line, sizeof(line), "sample %d of %d", m.samples + 1, m.settings.sampleLimit);
    }
    const double all = std::max(m.settings.sampleLimit, 1);
    const double part = m.moving ? 0 : m.finished ? 1 : (m.samples + m.progress) / all;
    ImGui::ProgressBar(static_cast<float>(std::clamp(part, 0.0, 1.0)), ImVec2(-1, 0), line);
}

constexpr float kPanelLines = 16.5f;  // the panel's width in heights of a line

// Over the picture, at most so high: movable, and closed by its heading's triangle.
bool beginOverlay(float width, float height) {
    const float line = ImGui::GetFontSize();
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(0, 0), ImGuiCond_FirstUseEver);
    ImGui::SetNextWindowSizeConstraints(ImVec2(std::min(12 * line, screen.x), 0),
                                        ImVec2(screen.x, std::max(height, 2 * line)));
    ImGui::SetNextWindowSize(ImVec2(width, 0), ImGuiCond_FirstUseEver);
    ImGui::SetNextWindowBgAlpha(0.85f);
    constexpr ImGuiWindowFlags kFlags = ImGuiWindowFlags_NoSavedSettings |
                                        ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav |
                                        ImGuiWindowFlags_AlwaysAutoResize;
    const bool open = ImGui::Begin("glint - F1: keys, H: hide", nullptr, kFlags);
    if (open) ImGui::Dummy(ImVec2(width - 2 * ImGui::GetStyle().WindowPadding.x, 0));
    return open;
}

// Beside the picture.
bool beginDocked(float width, float height) {
    ImGui::SetNextWindowPos(ImVec2(0, 0), ImGuiCond_Always);
    ImGui::SetNextWindowSize(ImVec2(width, std::max(height, 1.0f)), ImGuiCond_Always);
    ImGui::SetNextWindowBgAlpha(1);
    constexpr ImGuiWindowFlags kFlags = kFixedWindow | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse;
    return ImGui::Begin("glint - F1: keys, H: hide##docked", nullptr, kFlags);
}

// Its groups are closed at first in a small window, so that the picture is seen.
void drawMain(Gui& gui, PanelModel& m) {
    const float line = ImGui::GetFontSize();
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const bool docked = m.docked && m.left > 0;
    const float width = docked ? static_cast<float>(m.left) : std::min(kPanelLines * line, screen.x);
    const bool large = screen.y >= 50 * line;
    m.timelineHeight = drawTimeline(gui, m, width);
    const float height = screen.y - m.timelineHeight;
    if (docked ? beginDocked(width, height) : beginOverlay(width, height)) {
        ImGui::PushItemWidth(width - 8 * line - (docked ? ImGui::GetStyle().ScrollbarSize : 0));
        drawStatus(m);
        drawView(gui, m);
        drawFiles(gui, m);
        drawCompare(gui, m);
        drawCameras(gui, m);
        drawLights(gui, m);
        drawMaterials(gui, m);
        if (group(gui, "tracing", large, "what rays do, and how fast frames must come")) drawTracing(gui, m);
        drawSampling(gui, m);
        drawSpeed(gui, m);
        ImGui::PopItemWidth();
    }
    gui.noteWindow();
    ImGui::End();
}

}  // namespace

int dockWidth(const Gui& gui, int window) {
    const float wanted = (kPanelLines + 1) * gui.line();  // and a scroll bar
    return std::min(static_cast<int>(wanted), window / 2);
}

void drawPanel(Gui& gui, PanelModel& model) {
    if (model.helpVisible) {  // alone: it takes the whole window
        drawHelp(gui, model);
        drawProgress(gui, model);
        return;
    }
    drawMarks(model);
    drawLegend(gui, model);
    if (model.hints != nullptr) drawHints(gui, model);
    if (!model.panelVisible) model.timelineHeight = 0;
    if (model.panelVisible) drawMain(gui, model);
    if (model.saveAsVisible) drawSaveAs(gui, model);
    if (model.openVisible) drawOpen(gui, model);
    if (model.inspects) drawInspector(gui, model);
    if (model.pick->has_value()) drawPickWindow(gui, model);
    drawToasts(gui, model);
    drawProgress(gui, model);
}

}  // namespace glint::view
