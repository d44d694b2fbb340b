// The panel and what else lies over the image: list of keys, pick, inspector, messages.
#pragma once

#include <imgui.h>

#include <initializer_list>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

#include "view/commands.h"
#include "view/gui.h"

namespace glint::view {

inline constexpr ImGuiWindowFlags kFixedWindow = ImGuiWindowFlags_NoResize |
                                                 ImGuiWindowFlags_NoSavedSettings |
                                                 ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav;
inline const ImVec4 kRed(1.0f, 0.45f, 0.4f, 1.0f), kGreen(0.5f, 0.95f, 0.55f, 1.0f),
    kYellow(1.0f, 0.85f, 0.4f, 1.0f), kDim(0.68f, 0.68f, 0.72f, 1.0f);

// Width in pixels of a docked panel in a window of this width: half of it at most.
int dockWidth(const Gui& gui, int window);

// Draws all of it, between Gui::begin and Gui::end. Changes the model; Model::wish holds the action of a
// button.
void drawPanel(Model& model);

// ---- parts of it, for panel*.cpp ----

void text(const std::string& line);
void wrapped(const std::string& line, const ImVec4& color);
// The tooltip of the control before, and its place under its label.
void tip(const std::string& label, const std::string& help);

// Controls, each with its label to the right, a tooltip, and a place under its label (Gui::controlAt). True
// if the value has changed, which never leaves lo..hi.
template <typename T>
bool slider(const char* label, T& value, std::type_identity_t<T> lo, std::type_identity_t<T> hi,
            const char* format, const char* help, bool logarithmic = false) {
    constexpr ImGuiDataType kType = std::is_same_v<T, int> ? ImGuiDataType_S32 : ImGuiDataType_Double;
    static_assert(std::is_same_v<T, int> || std::is_same_v<T, double>);
    const ImGuiSliderFlags flags =
        ImGuiSliderFlags_AlwaysClamp | (logarithmic ? ImGuiSliderFlags_Logarithmic : 0);
    const bool changed = ImGui::SliderScalar(label, kType, &value, &lo, &hi, format, flags);
    tip(label, help);
    return changed;
}
bool checkbox(const char* label, bool& value, const char* help);
bool button(const char* label, const std::string& help);
// A row of buttons, by label and key (KeyBinding::name), for the commands of these keys.
void commandButtons(Model& m, std::initializer_list<std::pair<const char*, std::string_view>> row);

// A list of an enumeration's names, each with its own tooltip.
template <NamedEnum E>
bool choice(const char* label, E& value, const char* help) {
    bool changed = false;
    const bool open = ImGui::BeginCombo(label, nameOf(value).data());
    if (!open) tip(label, help);
    if (!open) return false;
    for (const EnumEntry<E>& entry : kEnumEntries<E>) {
        if (ImGui::Selectable(entry.name.data(), entry.value == value)) {
            changed = value != entry.value;
            value = entry.value;
        }
        Gui::noteControl(std::string(entry.name));
        if (!entry.help.empty() && ImGui::IsItemHovered()) ImGui::SetTooltip("%s", entry.help.data());
    }
    ImGui::EndCombo();
    return changed;
}

// A linear color: its swatch, which opens a picker, and its hex code, both as the screen shows it (sRGB). A
// `bright` color may be above 1: swatch and code are of color / strength, its greatest component.
bool colorEdit(const char* label, glm::dvec3& value, const char* help, bool bright = false);

// A heading that opens and closes the controls below it.
bool group(const char* name, bool open, const char* help);
// "reset GROUP" if something `differs`; true if it was pressed.
bool resetButton(const char* group, bool differs);
// Resets settings to those of the file.
template <typename Settings>
void resetButton(const char* group, Settings& mine, const Settings& file) {
    if (resetButton(group, !(mine == file))) mine = file;
}

// panel_groups.cpp: the panel's groups of controls; the dialogs that are visible.
void drawGroups(Model& m);
void drawDialogs(Model& m);
// At the bottom of the panel's column, so wide. Returns its height; 0 without animation.
float drawTimeline(Model& m, float width);

}  // namespace glint::view
