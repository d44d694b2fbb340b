// Windows over the image: keys, pick, inspector, messages, legend, marks.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "view/panel.h"

namespace glint::view {

namespace {

constexpr ImU32 kEyeRay = IM_COL32(255, 255, 255, 220), kReflectedRay = IM_COL32(255, 170, 60, 220),
                kTransmittedRay = IM_COL32(90, 200, 255, 220), kOutline = IM_COL32(0, 0, 0, 160);

struct HelpLine {
    const char* name;
    const char* help;
};

// Two pairs of columns where they fit, else one.
void drawHelpTable(const char* id, const std::vector<HelpLine>& lines, bool wide) {
    if (!ImGui::BeginTable(id, wide ? 4 : 2, ImGuiTableFlags_SizingFixedFit)) return;
    for (int pair = 0; pair < (wide ? 2 : 1); ++pair) {
        ImGui::TableSetupColumn("key", ImGuiTableColumnFlags_WidthFixed);
        ImGui::TableSetupColumn("help", ImGuiTableColumnFlags_WidthStretch);
    }
    const size_t rows = wide ? (lines.size() + 1) / 2 : lines.size();
    for (size_t row = 0; row < rows; ++row) {
        ImGui::TableNextRow();
        for (size_t i = row; i < lines.size(); i += rows) {
            ImGui::TableNextColumn();
            ImGui::TextColored(kGreen, "%s", lines[i].name);
            ImGui::TableNextColumn();
            ImGui::TextWrapped("%s", lines[i].help);
        }
    }
    ImGui::EndTable();
}

ImU32 colorOf(reference::RayClass kind) {
    if (kind == reference::RayClass::Mirrored) return kReflectedRay;
    return kind == reference::RayClass::Refracted ? kTransmittedRay : kEyeRay;
}

void drawHit(const PixelData& d, const std::string& object, const std::string& material) {
    text(object);
    ImGui::Text("object %u, face %u, material %u %s", d.object, d.primitive, d.material, material.c_str());
    ImGui::Text("depth %.7g", d.depth);
    ImGui::Text("position %.6g %.6g %.6g", d.position.x, d.position.y, d.position.z);
    ImGui::Text("normal %.4f %.4f %.4f", static_cast<double>(d.normal.x), static_cast<double>(d.normal.y),
                static_cast<double>(d.normal.z));
    ImGui::Text("uv %.5f %.5f", static_cast<double>(d.u), static_cast<double>(d.v));
}

void drawPickFacts(const Pick& pick) {
    if (!pick.hit()) {
        ImGui::Text("pixel %d, %d: nothing", pick.x, pick.y);
        return;
    }
    ImGui::Text("pixel %d, %d", pick.x, pick.y);
    drawHit(pick.data, pick.object, pick.material);
}

void drawRayTree(const Pick& pick) {
    const float step = ImGui::GetFontSize();
    for (const PickRay& ray : pick.rays) {
        const float indent = step * static_cast<float>(std::min(ray.depth, 12u));
        ImGui::Indent(indent + 0.01f);
        ImGui::PushStyleColor(ImGuiCol_Text, colorOf(ray.kind));
        ImGui::PushTextWrapPos(0);
        ImGui::Text("%5.1f %% %s", 100 * ray.share, ray.text.c_str());
        ImGui::PopTextWrapPos();
        ImGui::PopStyleColor();
        ImGui::Unindent(indent + 0.01f);
    }
}

// The pixels about the mouse, each as a square of one color.
void drawMagnifier(const Model& m, const PixelFacts& pixel) {
    const int across = m.zoom | 1;
    const float side = std::floor(11 * ImGui::GetFontSize() / static_cast<float>(across));
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImDrawList& list = *ImGui::GetWindowDrawList();
    for (int dy = 0; dy < across; ++dy) {
        for (int dx = 0; dx < across; ++dx) {
            const int x = pixel.x + dx - across / 2, y = pixel.y + dy - across / 2;
            if (x < 0 || y < 0 || x >= m.picture.width || y >= m.picture.height) continue;
            const ImVec2 corner(at.x + side * static_cast<float>(dx), at.y + side * static_cast<float>(dy));
            list.AddRectFilled(corner, ImVec2(corner.x + side, corner.y + side), m.picture.row(y)[x]);
        }
    }
    const float middle = side * static_cast<float>(across / 2);
    list.AddRect(ImVec2(at.x + middle, at.y + middle), ImVec2(at.x + middle + side, at.y + middle + side),
                 IM_COL32(255, 255, 255, 255));
    const float whole = side * static_cast<float>(across);
    ImGui::Dummy(ImVec2(whole, whole));
}

void drawLayers(const PixelFacts& p) {
    if (!p.hasData) {
        wrapped("layers: being traced", kDim);
        return;
    }
    const PixelData& d = p.data;
    if (d.object == PixelData::kNoIndex) {
        text("nothing is hit");
        ImGui::Text("cost %u", d.cost);
        return;
    }
    drawHit(d, p.object, p.material);
    ImGui::Text("bounces %u, cost %u", d.bounces, d.cost);
}

// The pick's window is above where the picked pixel, or the inspector, is below.
bool picksAbove(const Model& m) {
    return m.pick.has_value() && (m.inspects || 2 * (*m.pick).y > (*m.pick).height);
}

// Numbers of a range, as the legend's ends.
std::string numberOf(double value) {
    char buffer[32];
    std::snprintf(buffer, sizeof(buffer), "%.4g", value);
    return buffer;
}

}  // namespace

void drawHelp(Gui& gui, Model& m) {
    struct Group {
        const char* heading;
        std::vector<HelpLine> lines;
    };
    std::vector<Group> groups = {{"mouse", {}}};
    for (const MouseHelp& line : mouseHelp()) groups[0].lines.push_back({line.gesture, line.help});
    for (const KeyBinding& b : keyBindings()) {
        if (b.heading != nullptr) groups.push_back({b.heading, {}});
        groups.back().lines.push_back({b.name, b.help});
    }
    const float width = 62 * ImGui::GetFontSize();
    const bool wide = ImGui::GetIO().DisplaySize.x >= width;
    corner(gui, 0, "keys and mouse (F1 or Esc closes; the wheel scrolls)", ImVec2(0.5f, 0.5f), width, [&] {
        for (const Group& group : groups) {
            ImGui::Separator();
            text(group.heading);
            drawHelpTable(group.heading, group.lines, wide);
        }
        m.helpScroll = static_cast<double>(ImGui::GetScrollY());
    });
}

void drawPickWindow(Gui& gui, Model& m) {
    const Pick& pick = *m.pick;
    corner(
        gui, m.left, "picked (F frames it, Esc closes)", ImVec2(1, picksAbove(m) ? 0.0f : 1.0f),
        25 * ImGui::GetFontSize(),
        [&] {
            if (m.pickIsOld) wrapped("from an earlier view", kDim);
            drawPickFacts(pick);
            checkbox(gui, "keep while moving", m.pinsPick,
                     "the pick and its rays stay when the camera moves");
            ImGui::SameLine();
            checkbox(gui, "draw rays", m.drawsRays, "white from the eye, orange reflected, blue transmitted");
            if (m.control.camera().projection == Projection::Perspective && pick.hit() && !m.pickIsOld &&
                button(gui, "focus here", "of the lens"))
                m.wish = Action::FocusPicked;
            ImGui::Separator();
            drawRayTree(pick);
        },
        0, 0.6f);
}

void drawInspector(Gui& gui, Model& m) {
    const float line = ImGui::GetFontSize();
    corner(gui, m.left, "inspector (I closes)", ImVec2(1, 1), 18 * line, [&] {
        if (!m.pixel) {
            wrapped("Move the mouse over the image.", kDim);
        } else {
            const PixelFacts& p = *m.pixel;
            drawMagnifier(m, p);
            const uint32_t shown = m.picture.row(p.y)[p.x];
            ImGui::Text("pixel %d, %d", p.x, p.y);
            if (p.hasColor)
                ImGui::Text("linear %.5g %.5g %.5g", static_cast<double>(p.linear.x),
                            static_cast<double>(p.linear.y), static_cast<double>(p.linear.z));
            ImGui::Text("shown  %u %u %u", shown & 255u, shown >> 8 & 255u, shown >> 16 & 255u);
            drawLayers(p);
        }
        ImGui::PushItemWidth(8 * line);
        slider(gui, "zoom", m.zoom, 5, 31, "pixels across");
        ImGui::PopItemWidth();
    });
}

void drawMessages(Gui& gui, const Model& m) {
    const std::string waiting = m.waitingComparison();
    if (m.toasts.shown().empty() && m.verdict.empty() && m.sceneError.empty() && m.warnings.empty() &&
        waiting.empty())
        return;
    const float width = 26 * ImGui::GetFontSize();
    const bool both = m.inspects && m.pick.has_value();
    const ImVec2 place(both ? 0.5f : 1.0f, picksAbove(m) ? 1.0f : 0.0f);
    corner(
        gui, m.left, "##toasts", place, width,
        [&] {
            if (!m.sceneError.empty()) {
                wrapped(m.sceneError, kRed);
                wrapped("The image shows the scene as it was before.", kDim);
            }
            constexpr size_t kWarnings = 5;
            for (size_t i = 0; i < std::min(kWarnings, m.warnings.size()); ++i)
                wrapped("warning: " + m.warnings[i], kYellow);
            if (m.warnings.size() > kWarnings)
                wrapped(std::to_string(m.warnings.size() - kWarnings) + " more warnings on standard error",
                        kYellow);
            if (!m.warnings.empty()) wrapped("Esc closes.", kDim);
            if (!m.verdict.empty()) wrapped("verify " + m.verdict, m.verdictPassed ? kGreen : kRed);
            if (m.difference)
                wrapped("Shown: |difference| x 64; red unexplained, yellow edge, green rounding. Esc closes.",
                        kDim);
            if (!waiting.empty()) wrapped(waiting, kYellow);
            for (const Toast& toast : m.toasts.shown())
                wrapped(toast.text, toast.kind == ToastKind::Error ? kRed : kGreen);
        },
        kUnderMouse);
}

// In the corner that neither the panel nor a pick uses.
void drawHints(Gui& gui, Model& m) {
    const float line = ImGui::GetFontSize();
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const auto left = static_cast<float>(m.left);
    const float width = std::min(28 * line, screen.x - left);
    ImGui::SetNextWindowPos(ImVec2(left, screen.y - (m.left > 0 ? 0 : m.timelineHeight)), ImGuiCond_Always,
                            ImVec2(0, 1));
    ImGui::SetNextWindowSize(ImVec2(width, 0), ImGuiCond_Always);
    ImGui::SetNextWindowBgAlpha(0.85f);
    bool open = true;
    if (ImGui::Begin("first steps", &open,
                     kFixedWindow | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse)) {
        for (const EnumEntry<Hint>& entry : kEnumEntries<Hint>)
            if (m.hints.wanted(entry.value)) wrapped(std::string(entry.help), kGreen);
        wrapped("F1: every key. A control explains itself under the mouse.", kDim);
    }
    if (!open) m.hints.close();
    gui.noteWindow();
    ImGui::End();
}

// Also while the panel is hidden.
void drawProgress(Gui& gui, const Model& m) {
    struct Task {
        const char* name;
        double progress;
    };
    const Task tasks[] = {{m.isClosing ? "saving, then closing" : "saving", m.saveProgress},
                          {"verifying", m.verifyProgress},
                          {"tracing the reference", m.referenceProgress},
                          {"loading the scene", m.isLoading ? 0.0 : -1.0}};
    if (std::all_of(std::begin(tasks), std::end(tasks), [](const Task& t) { return t.progress < 0; })) return;
    corner(
        gui, m.left, "##progress", ImVec2(0.5f, 1), 16 * ImGui::GetFontSize(),
        [&] {
            for (const Task& task : tasks) {
                if (task.progress < 0) continue;
                char label[64];
                std::snprintf(label, sizeof(label), "%s: %.0f %%", task.name, 100 * task.progress);
                ImGui::ProgressBar(static_cast<float>(task.progress), ImVec2(-1, 0), label);
            }
        },
        kUnderMouse);
}

void drawLegend(Gui& gui, const Model& m) {
    const ViewLayer layer = m.settings.layer;
    if (!hasLegend(layer, m.display)) return;
    const bool colors = layer == ViewLayer::Color;
    const bool grey = layer == ViewLayer::Depth && m.display.toneMap != ToneMap::False;
    const float line = ImGui::GetFontSize();
    const LayerRange range = m.session->range();
    corner(
        gui, m.left, "##legend", ImVec2(0.5f, 0), 14 * line,
        [&] {
            const ImVec2 at = ImGui::GetCursorScreenPos();
            const float width = ImGui::GetContentRegionAvail().x;
            constexpr int kSteps = 64;
            for (int i = 0; i < kSteps; ++i) {
                const double x = (i + 0.5) / kSteps;
                const glm::dvec3 c = grey ? glm::dvec3(1 - 0.85 * x) : heatOf(x);
                const ImU32 color = ImGui::ColorConvertFloat4ToU32(
                    ImVec4(static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z), 1));
                const float left = std::floor(width * static_cast<float>(i) / kSteps);
                const float right = std::floor(width * static_cast<float>(i + 1) / kSteps);
                ImGui::GetWindowDrawList()->AddRectFilled(ImVec2(at.x + left, at.y),
                                                          ImVec2(at.x + right, at.y + line), color);
            }
            ImGui::Dummy(ImVec2(width, line));
            const std::string lo = colors ? numberOf(-kFalseStops) + " stops" : numberOf(range.lo);
            const std::string hi = colors ? "+" + numberOf(kFalseStops) : numberOf(range.hi);
            text(lo);
            ImGui::SameLine(0.5f * (width - ImGui::CalcTextSize(nameOf(layer).data()).x));
            text(colors ? "luminance" : std::string(nameOf(layer)));
            ImGui::SameLine(width - ImGui::CalcTextSize(hi.c_str()).x);
            text(hi);
        },
        kUnderMouse);
}

// The picked pixel and its tree of rays, in the image itself.
void drawMarks(const Model& m) {
    if (!m.pick.has_value()) return;
    const Pick& pick = *m.pick;
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const auto left = static_cast<float>(m.left);
    list.PushClipRect(ImVec2(left, 0), ImGui::GetIO().DisplaySize);
    const shared::Camera camera = m.session->packedCamera();
    const glm::dvec3& origin = m.scene->packed.origin;
    for (size_t i = 0; m.drawsRays && i < pick.rays.size(); ++i) {
        const PickRay& ray = pick.rays[i];
        const std::optional<Segment> line = projected(camera, ray.from - origin, ray.to - origin);
        if (!line) continue;
        const Segment& s = *line;
        const ImVec2 from(left + static_cast<float>(s.from.x), static_cast<float>(s.from.y));
        const ImVec2 to(left + static_cast<float>(s.to.x), static_cast<float>(s.to.y));
        list.AddLine(from, to, kOutline, 3);
        list.AddLine(from, to, colorOf(ray.kind), 1.5f);
    }
    if (!m.pickIsOld) {
        const ImVec2 at(left + static_cast<float>(pick.x) + 0.5f, static_cast<float>(pick.y) + 0.5f);
        const float radius = 0.5f * ImGui::GetFontSize();
        list.AddCircle(at, radius, kOutline, 24, 3);
        list.AddCircle(at, radius, kEyeRay, 24, 1.5f);
    }
    list.PopClipRect();
}

}  // namespace glint::view
