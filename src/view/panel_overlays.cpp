// Windows over the image: keys, pick, inspector, messages, legend, marks.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <span>
#include <utility>

#include "view/commands.h"
#include "view/panel.h"

namespace glint::view {

namespace {

constexpr ImU32 kEyeRay = IM_COL32(255, 255, 255, 220), kReflectedRay = IM_COL32(255, 170, 60, 220),
                kTransmittedRay = IM_COL32(90, 200, 255, 220), kOutline = IM_COL32(0, 0, 0, 160);

// Two pairs of columns where they fit, else one.
void drawHelpTable(std::span<const KeyBinding> lines, bool wide) {
    ImGui::Separator();
    text(lines[0].heading);
    if (!ImGui::BeginTable(lines[0].heading, wide ? 4 : 2, ImGuiTableFlags_SizingFixedFit)) return;
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

void drawHit(const Model& m, const PixelData& d) {
    text(objectName(m.scene->scene, d.object));
    ImGui::Text("object %u, face %u, material %u %s", d.object, d.primitive, d.material,
                materialName(m.scene->scene, d.material).c_str());
    ImGui::Text("depth %.7g", d.depth);
    ImGui::Text("position %.6g %.6g %.6g", d.position.x, d.position.y, d.position.z);
    ImGui::Text("normal %.4f %.4f %.4f", static_cast<double>(d.normal.x), static_cast<double>(d.normal.y),
                static_cast<double>(d.normal.z));
    ImGui::Text("uv %.5f %.5f", static_cast<double>(d.u), static_cast<double>(d.v));
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
void drawMagnifier(const Model& m, const glm::ivec2& pixel) {
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

void drawLayers(const Model& m, const PixelData& d) {
    if (d.object == PixelData::kNoIndex) {
        text("nothing is hit");
        ImGui::Text("cost %u", d.cost);
        return;
    }
    drawHit(m, d);
    ImGui::Text("bounces %u, cost %u", d.bounces, d.cost);
}

void drawPixel(const Model& m, const glm::ivec2& pixel) {
    drawMagnifier(m, pixel);
    const Session& session = *m.session;
    ImGui::Text("pixel %d, %d", pixel.x, pixel.y);
    if (session.samples() > 0) {
        const auto linear = [&](int c) {
            return static_cast<double>(session.picture().color.at(pixel.x, pixel.y, c));
        };
        ImGui::Text("linear %.5g %.5g %.5g", linear(0), linear(1), linear(2));
    }
    const uint32_t shown = m.picture.row(pixel.y)[pixel.x];
    ImGui::Text("shown  %u %u %u", shown & 255u, shown >> 8 & 255u, shown >> 16 & 255u);
    session.hasData() ? drawLayers(m, session.picture().at(pixel.x, pixel.y))
                      : wrapped("layers: being traced", kDim);
}

// The pick's window is above where the picked pixel, or the inspector, is below.
bool picksAbove(const Model& m) {
    return m.pick.has_value() && (m.inspects || 2 * m.pick->y > m.session->height());
}

// Numbers of a range, as the legend's ends.
std::string numberOf(double value) {
    char buffer[32];
    std::snprintf(buffer, sizeof(buffer), "%.4g", value);
    return buffer;
}

}  // namespace

void drawHelp(Model& m) {
    const float width = 62 * ImGui::GetFontSize();
    const bool wide = ImGui::GetIO().DisplaySize.x >= width;
    drawCorner({"keys and mouse (F1 or Esc closes; the wheel scrolls)", 0, {0.5f, 0.5f}, width}, [&] {
        for (auto lines = keyBindings(); !lines.empty();) {
            size_t count = 1;
            while (count < lines.size() && lines[count].heading == nullptr) ++count;
            drawHelpTable(lines.first(count), wide);
            lines = lines.subspan(count);
        }
        m.helpScroll = static_cast<double>(ImGui::GetScrollY());
    });
}

void drawPickWindow(Gui& gui, Model& m) {
    const Pick& pick = *m.pick;
    const Corner corner = {"picked (F frames it, Esc closes)", m.left, {1, picksAbove(m) ? 0.0f : 1.0f},
                           25 * ImGui::GetFontSize(),          0,      0.6f};
    drawCorner(corner, [&] {
        if (m.pickIsOld) wrapped("from an earlier view", kDim);
        ImGui::Text(pick.hit() ? "pixel %d, %d" : "pixel %d, %d: nothing", pick.x, pick.y);
        if (pick.hit()) drawHit(m, pick.data);
        checkbox(gui, "keep while moving", m.pinsPick, "the pick and its rays stay when the camera moves");
        ImGui::SameLine();
        checkbox(gui, "draw rays", m.drawsRays, "white from the eye, orange reflected, blue transmitted");
        const bool perspective = m.control.camera().projection == Projection::Perspective;
        if (perspective && pick.hit() && !m.pickIsOld && button(gui, "focus here", "of the lens"))
            m.wish = [](Model& model, Commands& c) {
                if (model.pick) c.focusAt(model.pick->x, model.pick->y);
            };
        ImGui::Separator();
        drawRayTree(pick);
    });
}

void drawInspector(Gui& gui, Model& m) {
    const float line = ImGui::GetFontSize();
    drawCorner({"inspector (I closes)", m.left, {1, 1}, 18 * line}, [&] {
        m.pixel ? drawPixel(m, *m.pixel) : wrapped("Move the mouse over the image.", kDim);
        ImGui::PushItemWidth(8 * line);
        slider(gui, "zoom", m.zoom, 5, 31, "pixels across");
        ImGui::PopItemWidth();
    });
}

void drawMessages(const Model& m) {
    const std::string waiting = m.waitingComparison();
    if (m.toasts.shown().empty() && m.verdict.empty() && m.sceneError.empty() && m.warnings.empty() &&
        waiting.empty())
        return;
    const float width = 26 * ImGui::GetFontSize();
    const bool both = m.inspects && m.pick.has_value();
    const ImVec2 place(both ? 0.5f : 1.0f, picksAbove(m) ? 1.0f : 0.0f);
    drawCorner({"##toasts", m.left, place, width, kUnderMouse}, [&] {
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
    });
}

// In the corner that neither the panel nor a pick uses.
void drawHints(Model& m) {
    bool open = true;
    drawCorner({"first steps",
                m.left,
                {0, 1},
                28 * ImGui::GetFontSize(),
                ImGuiWindowFlags_NoCollapse,
                1,
                m.left > 0 ? 0 : m.timelineHeight,
                &open},
               [&] {
                   for (const EnumEntry<Hint>& entry : kEnumEntries<Hint>)
                       if (m.hints.wanted(entry.value)) wrapped(std::string(entry.help), kGreen);
                   wrapped("F1: every key. A control explains itself under the mouse.", kDim);
               });
    if (!open) m.hints.close();
}

// Also while the panel is hidden.
void drawProgress(const Model& m) {
    const std::pair<const char*, const Job*> tasks[] = {
        {m.isClosing ? "saving, then closing" : "saving", &m.saving},
        {"verifying", &m.verifying},
        {"tracing the reference", &m.referring},
        {"loading the scene", &m.loading}};
    if (std::none_of(std::begin(tasks), std::end(tasks), [](const auto& t) { return t.second->running(); }))
        return;
    drawCorner({"##progress", m.left, {0.5f, 1}, 16 * ImGui::GetFontSize(), kUnderMouse}, [&] {
        for (const auto& [name, job] : tasks) {
            if (!job->running()) continue;
            char label[64];
            std::snprintf(label, sizeof(label), "%s: %.0f %%", name, 100 * job->progress());
            ImGui::ProgressBar(static_cast<float>(job->progress()), ImVec2(-1, 0), label);
        }
    });
}

void drawLegend(const Model& m) {
    const ViewLayer layer = m.settings.layer;
    if (!hasLegend(layer, m.display)) return;
    const bool colors = layer == ViewLayer::Color;
    const bool grey = layer == ViewLayer::Depth && m.display.toneMap != ToneMap::False;
    const float line = ImGui::GetFontSize();
    const LayerRange range = m.session->range();
    drawCorner({"##legend", m.left, {0.5f, 0}, 14 * line, kUnderMouse}, [&] {
        const ImVec2 at = ImGui::GetCursorScreenPos();
        const float width = ImGui::GetContentRegionAvail().x;
        const auto colorAt = [&](double x) {
            const glm::vec3 c(grey ? glm::dvec3(1 - 0.85 * x) : heatOf(x));
            return ImGui::ColorConvertFloat4ToU32(ImVec4(c.x, c.y, c.z, 1));
        };
        constexpr int kParts = 4;  // within each, the colors change evenly
        for (int i = 0; i < kParts; ++i) {
            const ImU32 from = colorAt(1.0 * i / kParts), to = colorAt((i + 1.0) / kParts);
            const float step = width / kParts, left = at.x + step * static_cast<float>(i);
            ImGui::GetWindowDrawList()->AddRectFilledMultiColor(
                ImVec2(left, at.y), ImVec2(left + step, at.y + line), from, to, to, from);
        }
        ImGui::Dummy(ImVec2(width, line));
        const std::string lo = colors ? numberOf(-kFalseStops) + " stops" : numberOf(range.lo);
        const std::string hi = colors ? "+" + numberOf(kFalseStops) : numberOf(range.hi);
        text(lo);
        ImGui::SameLine(0.5f * (width - ImGui::CalcTextSize(nameOf(layer).data()).x));
        text(colors ? "luminance" : std::string(nameOf(layer)));
        ImGui::SameLine(width - ImGui::CalcTextSize(hi.c_str()).x);
        text(hi);
    });
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
