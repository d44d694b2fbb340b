#include "view/panel.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/format.h"
#include "core/quantize.h"
#include "core/text_file.h"

namespace glint::view {

void text(const std::string& line) {
    ImGui::TextUnformatted(line.c_str());
}

void wrapped(const std::string& line, const ImVec4& color) {
    ImGui::PushStyleColor(ImGuiCol_Text, color);
    ImGui::TextWrapped("%s", line.c_str());
    ImGui::PopStyleColor();
}

void tip(const std::string& label, const std::string& help) {
    Gui::noteControl(label);
    if (help.empty() || !ImGui::IsItemHovered() || ImGui::IsItemActive()) return;
    Gui::noteTip(help);
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(22 * ImGui::GetFontSize());
    text(help);
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
}

bool checkbox(const char* label, bool& value, const char* help) {
    const bool changed = ImGui::Checkbox(label, &value);
    tip(label, help);
    return changed;
}

bool button(const char* label, const std::string& help) {
    const bool pressed = ImGui::Button(label);
    tip(label, help);
    return pressed;
}

void commandButtons(Model& m, std::initializer_list<std::pair<const char*, std::string_view>> row) {
    for (const auto& [label, key] : row) {
        if (label != row.begin()->first) ImGui::SameLine();
        for (const KeyBinding& binding : keyBindings())
            if (binding.name == key && button(label, format("%s (%s)", binding.help, binding.name)))
                m.wish = binding.run;
    }
}

bool colorEdit(const char* label, glm::dvec3& value, const char* help, bool bright) {
    const double greatest = std::max({value.x, value.y, value.z});
    double strength = bright && greatest > 1 ? greatest : 1;
    glm::vec3 srgb;
    for (int i = 0; i < 3; ++i)
        srgb[i] = static_cast<float>(srgbFromLinear(std::clamp(value[i] / strength, 0.0, 1.0)));
    const glm::vec3 before = srgb;
    ImGui::ColorEdit3(label, &srgb.x,
                      ImGuiColorEditFlags_DisplayHex | ImGuiColorEditFlags_NoOptions |
                          ImGuiColorEditFlags_NoTooltip | ImGuiColorEditFlags_NoDragDrop);
    tip(label, help);
    Gui::noteControl(label, 0.02f);  // the swatch
    Gui::noteControl(std::string(label) + " hex");
    for (int i = 0; i < 3; ++i)
        if (srgb[i] != before[i]) value[i] = strength * linearFromSrgb(static_cast<double>(srgb[i]));
    bool changed = srgb != before;
    if (bright) {
        ImGui::PushID(label);
        if (slider("strength", strength, 0.01, std::max(10.0, 2 * strength), "x %.3g",
                   "the greatest component", true)) {
            value *= strength / std::max(greatest, 1e-9);
            changed = true;
        }
        ImGui::PopID();
    }
    return changed;
}

bool group(const char* name, bool open, const char* help) {
    const bool shown = ImGui::CollapsingHeader(name, open ? ImGuiTreeNodeFlags_DefaultOpen : 0);
    tip(name, help);
    return shown;
}

bool resetButton(const char* name, bool differs) {
    if (!differs) return false;
    const std::string label = std::string("reset ") + name;
    const bool pressed = ImGui::SmallButton(label.c_str());
    tip(label, "as the scene's file has it");
    return pressed;
}

namespace {

constexpr ImU32 kEyeRay = IM_COL32(255, 255, 255, 220), kReflectedRay = IM_COL32(255, 170, 60, 220),
                kTransmittedRay = IM_COL32(90, 200, 255, 220), kOutline = IM_COL32(0, 0, 0, 160);

// A window at a corner of the image, as large as its content, at most `part` of the image's height; then it
// scrolls.
struct Corner {
    const char* title;
    int left;      // where the image begins
    ImVec2 pivot;  // the corner, 0..1
    float lines;   // its width in heights of a line
    ImGuiWindowFlags more = 0;
    float part = 1;
    float free = 0;        // pixels below the window
    bool* open = nullptr;  // false once it was closed by its button
};

// For corners without controls: the mouse works on the image beneath.
constexpr ImGuiWindowFlags kUnderMouse = ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_NoInputs;

template <typename Content>
void drawCorner(const Corner& c, const Content& content) {
    const auto x = static_cast<float>(c.left);
    const ImVec2 screen = ImGui::GetIO().DisplaySize, size(screen.x - x, screen.y);
    const float width = std::min(c.lines * ImGui::GetFontSize(), size.x);
    ImGui::SetNextWindowPos(ImVec2(x + size.x * c.pivot.x, size.y * c.pivot.y - c.free), ImGuiCond_Always,
                            c.pivot);
    ImGui::SetNextWindowSizeConstraints(ImVec2(width, 0), ImVec2(width, c.part * size.y));
    ImGui::SetNextWindowBgAlpha(0.85f);
    constexpr ImGuiWindowFlags kFlags =
        kFixedWindow | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove;
    if (ImGui::Begin(c.title, c.open, kFlags | c.more)) content();
    ImGui::End();
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

// ---- the pick ----

// The picked pixel and its tree of rays, in the image itself.
void drawRays(const Model& m, const Pick& pick) {
    ImDrawList& list = *ImGui::GetBackgroundDrawList();
    const auto left = static_cast<float>(m.left);
    list.PushClipRect(ImVec2(left, 0), ImGui::GetIO().DisplaySize);
    const shared::Camera camera = cameraOf(m.scene->packed, m.session->request());
    const glm::dvec3& origin = m.scene->packed.origin;
    const auto place = [&](const glm::dvec2& pixel) {
        return ImVec2(left + static_cast<float>(pixel.x), static_cast<float>(pixel.y));
    };
    for (size_t i = 0; m.drawsRays && i < pick.rays.size(); ++i) {
        const PickRay& ray = pick.rays[i];
        const std::optional<Segment> line = projected(camera, ray.from - origin, ray.to - origin);
        if (!line) continue;
        list.AddLine(place(line->from), place(line->to), kOutline, 3);
        list.AddLine(place(line->from), place(line->to), colorOf(ray.kind), 1.5f);
    }
    if (!m.pickIsOld) {
        const ImVec2 at = place(glm::dvec2(pick.x, pick.y) + 0.5);
        const float radius = 0.5f * ImGui::GetFontSize();
        list.AddCircle(at, radius, kOutline, 24, 3);
        list.AddCircle(at, radius, kEyeRay, 24, 1.5f);
    }
    list.PopClipRect();
}

void drawRayTree(const Pick& pick) {
    const float step = ImGui::GetFontSize();
    for (const PickRay& ray : pick.rays) {
        const float indent = step * static_cast<float>(std::min(ray.depth, 12u)) + 0.01f;
        ImGui::Indent(indent);
        wrapped(format("%5.1f %% ", 100 * ray.share) + ray.text,
                ImGui::ColorConvertU32ToFloat4(colorOf(ray.kind)));
        ImGui::Unindent(indent);
    }
}

// The pick's window is above where the picked pixel, or the inspector, is below.
bool picksAbove(const Model& m) {
    return m.pick.has_value() && (m.inspects || 2 * m.pick->y > m.session->height());
}

void drawPickWindow(Model& m, const Pick& pick) {
    const ImVec2 corner(1, picksAbove(m) ? 0.0f : 1.0f);
    drawCorner({"picked (F frames it, Esc closes)", m.left, corner, 25, 0, 0.6f}, [&] {
        if (m.pickIsOld) wrapped("from an earlier view", kDim);
        ImGui::Text(pick.hit() ? "pixel %d, %d" : "pixel %d, %d: nothing", pick.x, pick.y);
        if (pick.hit()) drawHit(m, pick.data);
        checkbox("keep while moving", m.pinsPick, "the pick and its rays stay when the camera moves");
        ImGui::SameLine();
        checkbox("draw rays", m.drawsRays, "white from the eye, orange reflected, blue transmitted");
        ImGui::Separator();
        drawRayTree(pick);
    });
}

// ---- the inspector ----

// The pixels about the mouse, each as a square of one color.
void drawMagnifier(const Model& m, const glm::ivec2& pixel) {
    constexpr int kAcross = 9;
    const float side = std::floor(11 * ImGui::GetFontSize() / kAcross);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    const auto corner = [&](int dx, int dy) {
        return ImVec2(at.x + side * static_cast<float>(dx), at.y + side * static_cast<float>(dy));
    };
    ImDrawList& list = *ImGui::GetWindowDrawList();
    for (int dy = 0; dy < kAcross; ++dy) {
        for (int dx = 0; dx < kAcross; ++dx) {
            const int x = pixel.x + dx - kAcross / 2, y = pixel.y + dy - kAcross / 2;
            if (m.session->contains(x, y))
                list.AddRectFilled(corner(dx, dy), corner(dx + 1, dy + 1), m.picture.row(y)[x]);
        }
    }
    list.AddRect(corner(kAcross / 2, kAcross / 2), corner(kAcross / 2 + 1, kAcross / 2 + 1),
                 IM_COL32(255, 255, 255, 255));
    ImGui::Dummy(ImVec2(side * kAcross, side * kAcross));
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
    if (!session.hasData()) return wrapped("layers: being traced", kDim);
    const PixelData& data = session.picture().at(pixel.x, pixel.y);
    data.object == PixelData::kNoIndex ? text("nothing is hit") : drawHit(m, data);
    ImGui::Text("bounces %u, cost %u", data.bounces, data.cost);
}

// ---- messages, legend, first steps ----

void drawMessages(const Model& m) {
    const std::string waiting = m.waitingComparison();
    if (m.toasts.shown().empty() && m.verdict.empty() && m.sceneError.empty() && m.warnings.empty() &&
        waiting.empty())
        return;
    const bool both = m.inspects && m.pick.has_value();
    const ImVec2 place(both ? 0.5f : 1.0f, picksAbove(m) ? 1.0f : 0.0f);
    drawCorner({"##toasts", m.left, place, 26, kUnderMouse}, [&] {
        if (!m.sceneError.empty()) {
            wrapped(m.sceneError, kRed);
            wrapped("The image shows the scene as it was before.", kDim);
        }
        constexpr size_t kWarnings = 5;
        for (size_t i = 0; i < std::min(kWarnings, m.warnings.size()); ++i)
            wrapped("warning: " + m.warnings[i], kYellow);
        if (m.warnings.size() > kWarnings)
            wrapped(format("%zu more warnings on standard error", m.warnings.size() - kWarnings), kYellow);
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

// Draws the legend of a layer whose colors stand for numbers of a range.
void drawLegend(const Model& m) {
    const ViewLayer layer = m.settings.layer;
    const bool colors = layer == ViewLayer::Color && m.display.toneMap == ToneMap::False;
    if (!colors && layer != ViewLayer::Bounces && layer != ViewLayer::Cost && layer != ViewLayer::Depth)
        return;
    const LayerRange range = m.session->range();
    drawCorner({"##legend", m.left, {0.5f, 0}, 14, kUnderMouse}, [&] {
        const ImVec2 at = ImGui::GetCursorScreenPos();
        const float line = ImGui::GetFontSize(), width = ImGui::GetContentRegionAvail().x;
        const auto colorAt = [&](double x) {
            const glm::vec3 c(rangeColor(layer, m.display.toneMap, x));
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
        text(colors ? format("%g stops", -kFalseStops) : format("%.4g", range.lo));
        const std::string name = colors ? "luminance" : std::string(nameOf(layer));
        const std::string hi = colors ? format("+%g", kFalseStops) : format("%.4g", range.hi);
        ImGui::SameLine(0.5f * (width - ImGui::CalcTextSize(name.c_str()).x));
        text(name);
        ImGui::SameLine(width - ImGui::CalcTextSize(hi.c_str()).x);
        text(hi);
    });
}

// In the corner that is free of the panel and of picks.
void drawHints(Model& m) {
    bool open = true;
    const float below = m.left > 0 ? 0 : m.timelineHeight;
    drawCorner({"first steps", m.left, {0, 1}, 28, ImGuiWindowFlags_NoCollapse, 1, below, &open}, [&] {
        for (const EnumEntry<Hint>& entry : kEnumEntries<Hint>)
            if (m.hints.wanted(entry.value)) wrapped(std::string(entry.help), kGreen);
        wrapped("F1: every key. A control explains itself under the mouse.", kDim);
    });
    if (!open) m.hints.close();
}

// Two pairs of columns where they fit, else one.
void drawHelpTable(std::span<const KeyBinding> lines, bool wide) {
    ImGui::Separator();
    text(lines[0].heading);
    if (!ImGui::BeginTable(lines[0].heading, wide ? 4 : 2, ImGuiTableFlags_SizingFixedFit)) return;
    for (int pair = 0; pair < (wide ? 2 : 1); ++pair) {
        ImGui::TableSetupColumn("key", ImGuiTableColumnFlags_WidthFixed);
        ImGui::TableSetupColumn("help", ImGuiTableColumnFlags_WidthStretch);
    }
    for (const KeyBinding& binding : lines) {
        ImGui::TableNextColumn();
        ImGui::TextColored(kGreen, "%s", binding.name);
        ImGui::TableNextColumn();
        ImGui::TextWrapped("%s", binding.help);
    }
    ImGui::EndTable();
}

void drawHelp() {
    constexpr float kLines = 62;
    const bool wide = ImGui::GetIO().DisplaySize.x >= kLines * ImGui::GetFontSize();
    drawCorner({"keys and mouse (F1 or Esc closes; the wheel scrolls)", 0, {0.5f, 0.5f}, kLines}, [&] {
        for (auto lines = keyBindings(); !lines.empty();) {
            size_t count = 1;
            while (count < lines.size() && lines[count].heading == nullptr) ++count;
            drawHelpTable(lines.first(count), wide);
            lines = lines.subspan(count);
        }
    });
}

void drawMarks(Model& m) {
    if (m.pick) drawRays(m, *m.pick);
    drawLegend(m);
    if (m.hints.any()) drawHints(m);
}

void drawReadings(Model& m) {
    if (m.inspects)
        drawCorner({"inspector (I closes)", m.left, {1, 1}, 18}, [&] {
            m.pixel ? drawPixel(m, *m.pixel) : wrapped("Move the mouse over the image.", kDim);
        });
    if (m.pick) drawPickWindow(m, *m.pick);
    drawMessages(m);
}

// Also while the panel is hidden.
void drawProgress(const Model& m) {
    const auto shown = [](const Job* job) { return job->running() && *job->name() != 0; };
    if (std::none_of(m.jobs.begin(), m.jobs.end(), shown)) return;
    drawCorner({"##progress", m.left, {0.5f, 1}, 16, kUnderMouse}, [&] {
        for (const Job* job : m.jobs) {
            if (!shown(job)) continue;
            const char* const name = m.isClosing && job == &m.saving ? "saving, then closing" : job->name();
            ImGui::ProgressBar(static_cast<float>(job->progress()), ImVec2(-1, 0),
                               format("%s: %.0f %%", name, 100 * job->progress()).c_str());
        }
    });
}

// ---- the panel ----

// Part that is done, and words on it.
std::pair<double, std::string> progressOf(const Model& m) {
    const Session& session = *m.session;
    const double error = m.settings.until.error;
    if (m.moving()) {
        const FrameFacts& facts = session.facts();
        return {0, format("moving: %d x %d, depth %d", facts.width, facts.height, facts.depth)};
    }
    if (error > 0) {
        const converge::State state = session.goal();
        // Samples grow with about the -5/3rd power of the error.
        const double part = state.estimate > error ? std::pow(error / state.estimate, 5.0 / 3) : 0.99;
        return {state.stop ? 1 : state.rounds == 0 ? 0 : part, inWords(state, error)};
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

void drawMain(Model& m) {
    const ImVec2 screen = ImGui::GetIO().DisplaySize;
    const float line = ImGui::GetFontSize();
    const bool docked = m.docked && m.left > 0;
    const float width = docked ? static_cast<float>(m.left) : std::min(kPanelLines * line, screen.x);
    m.timelineHeight = drawTimeline(m, width);
    if (beginPanel(docked, width, screen.y - m.timelineHeight)) {
        ImGui::PushItemWidth(width - 8 * line - (docked ? ImGui::GetStyle().ScrollbarSize : 0));
        const auto [part, words] = progressOf(m);
        ImGui::ProgressBar(static_cast<float>(std::clamp(part, 0.0, 1.0)), ImVec2(-1, 0), words.c_str());
        drawGroups(m);
        ImGui::PopItemWidth();
    }
    ImGui::End();
}

}  // namespace

int dockWidth(const Gui& gui, int window) {
    const float wanted = (kPanelLines + 1) * gui.line();  // and a scroll bar
    return std::min(static_cast<int>(wanted), window / 2);
}

void drawPanel(Model& model) {
    if (!model.panelVisible) model.timelineHeight = 0;
    if (model.helpVisible) {  // without windows over the image
        if (model.panelVisible && model.left > 0) drawMain(model);
        drawHelp();
    } else {
        drawMarks(model);
        if (model.panelVisible) drawMain(model);
        drawDialogs(model);
        drawReadings(model);
    }
    drawProgress(model);
}

}  // namespace glint::view
