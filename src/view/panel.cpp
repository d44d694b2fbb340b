#include "view/panel.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "core/quantize.h"

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
    double number = value;
    const bool changed = slider(gui, label, number, lo, hi, "%.0f", help, logarithmic);
    if (changed) value = static_cast<int>(std::lround(number));
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

namespace {

bool hexEdit(glm::vec3& srgb) {
    char typed[8];
    const auto byte = [](float c) {
        return static_cast<unsigned>(std::lround(255 * std::clamp(c, 0.0f, 1.0f)));
    };
    std::snprintf(typed, sizeof(typed), "#%02x%02x%02x", byte(srgb.x), byte(srgb.y), byte(srgb.z));
    ImGui::SetNextItemWidth(5 * ImGui::GetFontSize());
    ImGui::InputText("##hex", typed, sizeof(typed), ImGuiInputTextFlags_CharsNoBlank);
    unsigned r = 0, g = 0, b = 0;
    if (!ImGui::IsItemEdited() || std::sscanf(typed, "#%2x%2x%2x", &r, &g, &b) != 3 || typed[6] == 0)
        return false;
    srgb = glm::vec3(r, g, b) / 255.0f;
    return true;
}

}  // namespace

bool colorEdit(Gui& gui, const char* label, glm::dvec3& value, const char* help, bool bright) {
    const double greatest = std::max({value.x, value.y, value.z});
    double strength = bright && greatest > 1 ? greatest : 1;
    glm::vec3 srgb;
    for (int i = 0; i < 3; ++i)
        srgb[i] = static_cast<float>(srgbFromLinear(std::clamp(value[i] / strength, 0.0, 1.0)));
    const glm::vec3 before = srgb;
    ImGui::PushID(label);
    if (ImGui::ColorButton("##swatch", ImVec4(srgb.x, srgb.y, srgb.z, 1), ImGuiColorEditFlags_NoTooltip))
        ImGui::OpenPopup("picker");
    tip(gui, label, help);
    ImGui::SameLine();
    bool changed = hexEdit(srgb);
    gui.noteControl((std::string(label) + " hex").c_str());
    ImGui::SameLine();
    text(label);
    if (ImGui::BeginPopup("picker")) {
        changed = ImGui::ColorPicker3("##picker", &srgb.x, ImGuiColorEditFlags_NoSidePreview) || changed;
        ImGui::Text("linear %.4g %.4g %.4g", value.x, value.y, value.z);
        if (bright && slider(gui, "strength", strength, 0.01, std::max(10.0, 2 * strength), "x %.3g",
                             "the greatest component", true)) {
            for (int i = 0; i < 3; ++i) value[i] *= strength / std::max(greatest, 1e-9);
            changed = true;
        }
        gui.noteControl("picker");
        ImGui::EndPopup();
    }
    ImGui::PopID();
    for (int i = 0; i < 3; ++i)
        if (srgb[i] != before[i]) value[i] = strength * linearFromSrgb(static_cast<double>(srgb[i]));
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
    tip(gui, label.c_str(), "as the scene's file has it");
    return pressed;
}

void drawCorner(const Corner& c, const std::function<void()>& content) {
    const auto x = static_cast<float>(c.left);
    const ImVec2 screen = ImGui::GetIO().DisplaySize, size(screen.x - x, screen.y);
    const float width = std::min(c.width, size.x);
    ImGui::SetNextWindowPos(ImVec2(x + size.x * c.pivot.x, size.y * c.pivot.y - c.free), ImGuiCond_Always,
                            c.pivot);
    ImGui::SetNextWindowSizeConstraints(ImVec2(width, 0), ImVec2(width, c.part * size.y));
    ImGui::SetNextWindowBgAlpha(0.85f);
    constexpr ImGuiWindowFlags kFlags =
        kFixedWindow | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove;
    if (ImGui::Begin(c.title, c.open, kFlags | c.more)) content();
    ImGui::End();
}

namespace {

// How the bound has fallen, both axes in powers: from the first look to what was asked for.
void drawFall(const GoalFacts& facts, double error) {
    std::vector<float> bounds;
    for (const double bound : facts.bounds)
        if (std::isfinite(bound)) bounds.push_back(static_cast<float>(std::log(bound)));
    if (bounds.size() < 2) return;
    const auto wanted = static_cast<float>(std::log(error));
    const float most = *std::max_element(bounds.begin(), bounds.end());
    ImGui::PlotLines("##fall", bounds.data(), static_cast<int>(bounds.size()), 0, nullptr,
                     std::min(wanted, bounds.back()), std::max(most, wanted + 0.1f),
                     ImVec2(ImGui::GetContentRegionAvail().x, 2 * ImGui::GetFontSize()));
}

void drawGoal(const GoalFacts& facts, double error) {
    // Samples grow with about the -5/3rd power of the error.
    const double part = facts.bounds.empty()           ? 0
                        : facts.stop                   ? 1
                        : facts.state.estimate > error ? std::pow(error / facts.state.estimate, 5.0 / 3)
                                                       : 0.99;
    ImGui::ProgressBar(static_cast<float>(part), ImVec2(-1, 0), inWords(facts, error).c_str());
    drawFall(facts, error);
}

void drawStatus(const Model& m) {
    const Session& session = *m.session;
    const double error = m.settings.until.error;
    if (!m.moving() && error > 0) return drawGoal(session.goal(), error);
    char line[96];
    double part = 0;
    if (m.moving()) {
        const FrameFacts& facts = session.facts();
        std::snprintf(line, sizeof(line), "moving: %d x %d, depth %d", facts.width, facts.height,
                      facts.depth);
    } else if (session.finished()) {
        std::snprintf(line, sizeof(line), "done: %d sample%s", session.samples(),
                      session.samples() == 1 ? "" : "s");
        part = 1;
    } else {
        std::snprintf(line, sizeof(line), "sample %d of %d", session.samples() + 1, m.settings.sampleLimit);
        part = (session.samples() + session.progress()) / std::max(m.settings.sampleLimit, 1);
    }
    ImGui::ProgressBar(static_cast<float>(std::clamp(part, 0.0, 1.0)), ImVec2(-1, 0), line);
}

constexpr float kPanelLines = 16.5f;  // the panel's width in heights of a line

// Over the image, at most so high: movable, and closed by its heading's triangle.
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

// Beside the image.
bool beginDocked(float width, float height) {
    ImGui::SetNextWindowPos(ImVec2(0, 0), ImGuiCond_Always);
    ImGui::SetNextWindowSize(ImVec2(width, std::max(height, 1.0f)), ImGuiCond_Always);
    ImGui::SetNextWindowBgAlpha(1);
    constexpr ImGuiWindowFlags kFlags = kFixedWindow | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse;
    return ImGui::Begin("glint - F1: keys, H: hide##docked", nullptr, kFlags);
}

void drawMain(Gui& gui, Model& m) {
    const float line = ImGui::GetFontSize();
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const bool docked = m.docked && m.left > 0;
    const float width = docked ? static_cast<float>(m.left) : std::min(kPanelLines * line, screen.x);
    m.timelineHeight = drawTimeline(gui, m, width);
    const float height = screen.y - m.timelineHeight;
    if (docked ? beginDocked(width, height) : beginOverlay(width, height)) {
        ImGui::PushItemWidth(width - 8 * line - (docked ? ImGui::GetStyle().ScrollbarSize : 0));
        drawStatus(m);
        drawView(gui, m);
        drawLights(gui, m);
        drawMaterials(gui, m);
        if (m.hasJsonFile() && m.edited() &&
            button(gui, "save scene", "lights and materials, into a scene file"))
            m.saveSceneVisible = true;
        drawFiles(gui, m);
        drawCompare(gui, m);
        drawCameras(gui, m);
        drawTracing(gui, m);
        drawSampling(gui, m);
        drawSpeed(gui, m);
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
    if (model.helpVisible) {  // without what lies over the image
        if (model.left > 0) drawMain(gui, model);
        drawHelp(model);
        drawProgress(model);
        return;
    }
    drawMarks(model);
    drawLegend(model);
    if (model.hints.any()) drawHints(model);
    if (!model.panelVisible) model.timelineHeight = 0;
    if (model.panelVisible) drawMain(gui, model);
    if (model.saveAsVisible) drawSaveAs(gui, model);
    if (model.saveSceneVisible) drawSaveScene(gui, model);
    if (model.openVisible) drawOpen(gui, model);
    if (model.inspects) drawInspector(gui, model);
    if (model.pick.has_value()) drawPickWindow(gui, model);
    drawMessages(model);
    drawProgress(model);
}

}  // namespace glint::view
