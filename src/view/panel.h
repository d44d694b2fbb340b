// The panel and what else lies over the image: list of keys, pick, inspector, messages.
#pragma once

#include <imgui.h>

#include <functional>
#include <string>

#include "view/gui.h"
#include "view/model.h"

namespace glint::view {

inline constexpr ImGuiWindowFlags kFixedWindow = ImGuiWindowFlags_NoResize |
                                                 ImGuiWindowFlags_NoSavedSettings |
                                                 ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav;
// With a text field that takes the keyboard when the window appears: since ImGui 1.89 NoNav prevents that.
inline constexpr ImGuiWindowFlags kDialog =
    ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoSavedSettings | ImGuiWindowFlags_NoCollapse;
inline const ImVec4 kRed(1.0f, 0.45f, 0.4f, 1.0f), kGreen(0.5f, 0.95f, 0.55f, 1.0f),
    kYellow(1.0f, 0.85f, 0.4f, 1.0f), kDim(0.68f, 0.68f, 0.72f, 1.0f);

// Width in pixels of a docked panel in a window of this width: half of it at most.
int dockWidth(const Gui& gui, int window);

// Draws all of it, between Gui::begin and Gui::end. Changes the model; Model::wish holds what a button asks
// for.
void drawPanel(Gui& gui, Model& model);

// ---- parts of it, for panel*.cpp ----

void text(const std::string& line);
void wrapped(const std::string& line, const ImVec4& color);

// Controls, each with its label to the right, a tooltip, and a place under its label (Gui::controlAt). True
// if the value has changed, which never leaves lo..hi.
bool slider(Gui& gui, const char* label, double& value, double lo, double hi, const char* format,
            const char* help, bool logarithmic = false);
bool slider(Gui& gui, const char* label, int& value, int lo, int hi, const char* help,
            bool logarithmic = false);
bool checkbox(Gui& gui, const char* label, bool& value, const char* help);
bool button(Gui& gui, const char* label, const char* help);
void tip(Gui& gui, const char* label, const char* help);

// A list of an enumeration's names, each with its own tooltip.
template <NamedEnum E>
bool choice(Gui& gui, const char* label, E& value, const char* help) {
    bool changed = false;
    const bool open = ImGui::BeginCombo(label, std::string(nameOf(value)).c_str());
    if (!open) tip(gui, label, help);
    if (!open) return false;
    for (const EnumEntry<E>& entry : kEnumEntries<E>) {
        if (ImGui::Selectable(std::string(entry.name).c_str(), entry.value == value)) {
            changed = value != entry.value;
            value = entry.value;
        }
        gui.noteControl(std::string(entry.name).c_str());
        if (!entry.help.empty() && ImGui::IsItemHovered())
            ImGui::SetTooltip("%s", std::string(entry.help).c_str());
    }
    ImGui::EndCombo();
    return changed;
}

// A linear color: its swatch and hex code as the screen shows it (sRGB); a click opens a picker. Of a
// `bright` color above 1 the swatch shows color / strength, its greatest component.
bool colorEdit(Gui& gui, const char* label, glm::dvec3& value, const char* help, bool bright = false);

// A heading that opens and closes what follows.
bool group(Gui& gui, const char* name, bool open, const char* help);
// "reset GROUP" if something `differs`; true if it was pressed.
bool resetButton(Gui& gui, const char* group, bool differs);
// Resets settings to those of the file.
template <typename Settings>
void resetButton(Gui& gui, const char* group, Settings& mine, const Settings& file) {
    if (resetButton(gui, group, !(mine == file))) mine = file;
}

// A window at a corner of the image, as large as its content, at most `part` of the image's height; then it
// scrolls.
struct Corner {
    const char* title;
    int left;      // where the image begins
    ImVec2 pivot;  // the corner, 0..1
    float width;
    ImGuiWindowFlags more = 0;
    float part = 1;
    float free = 0;        // pixels below the window
    bool* open = nullptr;  // false once it was closed by its button
};
void drawCorner(const Corner& corner, const std::function<void()>& content);
// For corners without controls: the mouse works on the image beneath.
inline constexpr ImGuiWindowFlags kUnderMouse = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoInputs;

// panel_settings.cpp
void drawView(Gui& gui, Model& m);
void drawLens(Gui& gui, Model& m);
void drawTracing(Gui& gui, Model& m);
void drawSampling(Gui& gui, Model& m);
void drawLights(Gui& gui, Model& m);
void drawMaterials(Gui& gui, Model& m);
// panel_tools.cpp
void drawFiles(Gui& gui, Model& m);
void drawCameras(Gui& gui, Model& m);
void drawCompare(Gui& gui, Model& m);
void drawSpeed(Gui& gui, Model& m);
void drawSaveAs(Gui& gui, Model& m);
void drawSaveScene(Gui& gui, Model& m);
void drawOpen(Gui& gui, Model& m);
// At the bottom of the panel's column, so wide. Returns its height; 0 without animation.
float drawTimeline(Gui& gui, Model& m, float width);
// panel_overlays.cpp
void drawHelp(Model& m);
void drawPickWindow(Gui& gui, Model& m);
void drawInspector(Gui& gui, Model& m);
void drawMessages(const Model& m);
void drawHints(Model& m);
void drawProgress(const Model& m);
void drawLegend(const Model& m);
void drawMarks(const Model& m);

}  // namespace glint::view
