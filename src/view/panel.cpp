#include "view/panel.h"

#include <imgui.h>

#include <algorithm>
#include <cstdio>

#include "view/keys.h"

namespace glint::view {

namespace {

constexpr ImGuiWindowFlags kFixed = ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoSavedSettings |
                                    ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav;
const ImVec4 kRed(1.0f, 0.45f, 0.4f, 1.0f), kGreen(0.5f, 0.95f, 0.55f, 1.0f), kDim(0.65f, 0.65f, 0.68f, 1.0f);

double milliseconds(double seconds) {
    return seconds * 1e3;
}

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

void drawFacts(const PanelModel& m) {
    wrapped(m.device->name, kDim);
    if (m.moving) {
        ImGui::Text("moving: %d x %d, depth %d", m.facts.width, m.facts.height, m.facts.depth);
    } else if (m.finished) {
        ImGui::Text("at rest: %d x %d, samples %d, done", m.facts.width, m.facts.height, m.samples);
    } else {
        ImGui::Text("at rest: %d x %d, sample %d: %.0f %%", m.facts.width, m.facts.height, m.samples + 1,
                    100 * m.progress);
    }
    ImGui::Text("frame %.1f ms, %.3g Mrays/s", milliseconds(m.frameSeconds), m.facts.raysPerSecond * 1e-6);
    if (m.frameTimes->size() > 1) {
        const float most = *std::max_element(m.frameTimes->begin(), m.frameTimes->end());
        char label[48];
        std::snprintf(label, sizeof(label), "frame times, 0 to %.0f ms", static_cast<double>(most));
        ImGui::PlotLines("##times", m.frameTimes->data(), static_cast<int>(m.frameTimes->size()), 0, label, 0,
                         most, ImVec2(ImGui::GetContentRegionAvail().x, 3.2f * ImGui::GetFontSize()));
    }
    const render::StageTimes& t = m.facts.times;
    ImGui::Text("trace %.1f  readback %.1f ms", milliseconds(t.trace), milliseconds(t.readback));
    ImGui::Text("draw %.1f  present %.1f ms", milliseconds(m.drawSeconds), milliseconds(m.presentSeconds));
    if (m.loading) text("loading the scene...");
    if (m.saveProgress >= 0) ImGui::Text("saving: %.0f %%", 100 * m.saveProgress);
    if (m.verifyProgress >= 0) ImGui::Text("verifying: %.0f %%", 100 * m.verifyProgress);
}

void drawView(PanelModel& m) {
    const auto name = [](ViewLayer layer) { return std::string(nameOf(layer)); };
    if (ImGui::BeginCombo("layer", name(m.settings.layer).c_str())) {
        for (int i = 0; i < kViewLayers; ++i) {
            const auto layer = static_cast<ViewLayer>(i);
            if (ImGui::Selectable(name(layer).c_str(), layer == m.settings.layer)) m.settings.layer = layer;
        }
        ImGui::EndCombo();
    }
    wrapped(std::string(helpOf(m.settings.layer)), kDim);
    auto exposure = static_cast<float>(m.exposure);
    if (ImGui::SliderFloat("exposure", &exposure, -8, 8, "%+.1f stops"))
        m.exposure = static_cast<double>(exposure);
    auto fov = static_cast<float>(m.fovY);
    if (m.hasFov && ImGui::SliderFloat("fov", &fov, 1, 170, "%.1f deg")) m.fovY = static_cast<double>(fov);
    ImGui::Checkbox("fly (Tab)", &m.flying);
}

void drawTracing(PanelModel& m) {
    PictureSettings& s = m.settings;
    ImGui::SliderInt("depth", &s.maxDepth, 0, std::max(16, m.scene->maxDepth), "%d",
                     ImGuiSliderFlags_AlwaysClamp);
    ImGui::Checkbox("shadows", &s.shadows);
    ImGui::SameLine();
    ImGui::Checkbox("reflections", &s.reflections);
    ImGui::SliderInt("samples", &s.sampleLimit, 1, 1024, "%d",
                     ImGuiSliderFlags_Logarithmic | ImGuiSliderFlags_AlwaysClamp);
    ImGui::ColorEdit3("background", &s.background.x,
                      ImGuiColorEditFlags_Float | ImGuiColorEditFlags_HDR | ImGuiColorEditFlags_NoInputs);
    auto target = static_cast<float>(milliseconds(m.targetSeconds));
    if (ImGui::SliderFloat("aim", &target, 8, 200, "%.0f ms a frame"))
        m.targetSeconds = static_cast<double>(target) * 1e-3;
    if (m.modes.size() > 1 &&
        ImGui::BeginCombo("present", nameOf(m.mode).data())) {  // literals: they end in 0
        for (const gpu::PresentMode mode : m.modes) {
            if (ImGui::Selectable(nameOf(mode).data(), mode == m.mode)) m.mode = mode;
        }
        ImGui::EndCombo();
    }
}

void drawLights(PanelModel& m) {
    if (m.settings.lights.empty() || !ImGui::CollapsingHeader("lights", ImGuiTreeNodeFlags_DefaultOpen))
        return;
    for (size_t i = 0; i < m.settings.lights.size(); ++i) {
        LightSetting& light = m.settings.lights[i];
        ImGui::PushID(static_cast<int>(i));
        ImGui::Checkbox("##on", &light.on);
        ImGui::SameLine();
        const Light& kind = m.scene->lights[i];
        const char* name = std::holds_alternative<PointLight>(kind)  ? "point"
                           : std::holds_alternative<SpotLight>(kind) ? "spot"
                                                                     : "sun";
        char label[32];
        std::snprintf(label, sizeof(label), "%zu %s", i, name);
        ImGui::SliderFloat(label, &light.dim, 0, 4, "x %.2f");
        ImGui::PopID();
    }
}

void drawPick(const Pick& pick) {
    if (!pick.hit()) {
        ImGui::Text("pixel %d, %d: nothing", pick.x, pick.y);
        return;
    }
    const PixelData& d = pick.data;
    ImGui::Text("pixel %d, %d: %s", pick.x, pick.y, pick.object.c_str());
    ImGui::Text("object %u, face %u", d.object, d.primitive);
    ImGui::Text("material %s", pick.material.c_str());
    ImGui::Text("t %.7g", d.depth);
    ImGui::Text("point  %.6g %.6g %.6g", d.position.x, d.position.y, d.position.z);
    ImGui::Text("normal %.4f %.4f %.4f", static_cast<double>(d.normal.x), static_cast<double>(d.normal.y),
                static_cast<double>(d.normal.z));
    ImGui::Text("u %.5f  v %.5f", static_cast<double>(d.u), static_cast<double>(d.v));
}

void drawPickPath(const Pick& pick) {
    ImGui::PushTextWrapPos(0);
    for (const std::string& line : pick.path) text(line);
    ImGui::PopTextWrapPos();
}

void drawMain(Gui& gui, PanelModel& m) {
    const float line = ImGui::GetFontSize();
    ImGui::SetNextWindowPos(ImVec2(0, 0));
    ImGui::SetNextWindowSize(ImVec2(std::min(22 * line, ImGui::GetIO().DisplaySize.x), 0));
    ImGui::SetNextWindowSizeConstraints(ImVec2(0, 0), ImVec2(22 * line, ImGui::GetIO().DisplaySize.y));
    ImGui::SetNextWindowBgAlpha(0.8f);
    if (ImGui::Begin("glint: H hides, F1 lists every key", nullptr, kFixed | ImGuiWindowFlags_NoMove)) {
        ImGui::PushItemWidth(-6.5f * line);
        drawFacts(m);
        ImGui::Separator();
        drawView(m);
        ImGui::Separator();
        drawTracing(m);
        drawLights(m);
        ImGui::PopItemWidth();
    }
    gui.noteWindow();
    ImGui::End();
}

// A window in a corner of the picture, as large as what is in it. `pivot`: that corner, 0..1.
bool beginCorner(const char* title, const ImVec2& pivot, float width) {
    const ImVec2 size = ImGui::GetIO().DisplaySize;
    ImGui::SetNextWindowPos(ImVec2(size.x * pivot.x, size.y * pivot.y), ImGuiCond_Always, pivot);
    ImGui::SetNextWindowSizeConstraints(ImVec2(std::min(width, size.x), 0),
                                        ImVec2(std::min(width, size.x), size.y));
    ImGui::SetNextWindowBgAlpha(0.85f);
    return ImGui::Begin(title, nullptr, kFixed | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove);
}

struct HelpLine {
    const char* name;
    const char* help;
};

// In two columns, the first one filled first: a list of every key fits into a small window.
void drawHelpTable(const char* id, const std::vector<HelpLine>& lines) {
    if (!ImGui::BeginTable(id, 4, ImGuiTableFlags_SizingFixedFit)) return;
    const size_t rows = (lines.size() + 1) / 2;
    for (size_t row = 0; row < rows; ++row) {
        ImGui::TableNextRow();
        for (size_t i = row; i < lines.size(); i += rows) {
            ImGui::TableNextColumn();
            ImGui::TextColored(kGreen, "%s", lines[i].name);
            ImGui::TableNextColumn();
            ImGui::TextUnformatted(lines[i].help);
        }
    }
    ImGui::EndTable();
}

void drawHelp(Gui& gui) {
    std::vector<HelpLine> mouse, keys;
    for (const MouseHelp& m : mouseHelp()) mouse.push_back({m.gesture, m.help});
    for (const KeyBinding& b : keyBindings()) keys.push_back({b.name, b.help});
    if (beginCorner("keys and mouse (F1 or Esc closes)", ImVec2(0.5f, 0.5f), 62 * ImGui::GetFontSize())) {
        drawHelpTable("mouse", mouse);
        ImGui::Separator();
        drawHelpTable("keys", keys);
    }
    gui.noteWindow();
    ImGui::End();
}

void drawPickWindow(Gui& gui, const Pick& pick) {
    if (beginCorner("picked (F frames it, Esc closes)", ImVec2(1, 1), 27 * ImGui::GetFontSize())) {
        drawPick(pick);
        ImGui::Separator();
        drawPickPath(pick);
    }
    gui.noteWindow();
    ImGui::End();
}

void drawNotices(Gui& gui, const PanelModel& m) {
    if (m.message.empty() && m.verdict.empty() && m.sceneError.empty()) return;
    if (beginCorner("Esc closes", ImVec2(1, 0), 34 * ImGui::GetFontSize())) {
        if (!m.sceneError.empty()) {
            wrapped(m.sceneError, kRed);
            wrapped("The picture is of the scene as it was before.", kDim);
        }
        if (!m.verdict.empty()) {
            wrapped("verify " + m.verdict, m.verdictPassed ? kGreen : kRed);
            wrapped("Shown: |difference| x 64; red unexplained, yellow edge, blue tie.", kDim);
        }
        if (!m.message.empty()) wrapped(m.message, kGreen);
    }
    gui.noteWindow();
    ImGui::End();
}

}  // namespace

void drawPanel(Gui& gui, PanelModel& model) {
    if (model.helpVisible) {  // alone: it takes the whole window
        drawHelp(gui);
        return;
    }
    if (model.panelVisible) drawMain(gui, model);
    if (model.pick->has_value()) drawPickWindow(gui, **model.pick);
    drawNotices(gui, model);
}

}  // namespace glint::view
